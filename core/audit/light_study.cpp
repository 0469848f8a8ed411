#include "core/audit/light_study.h"

#include <algorithm>
#include <cmath>

#include "core/audit/clock.h"
#include "core/cache/surface_cache.h"
#include "core/trace/shade.h"

namespace linetree {
namespace {

// Enough for trees to grow as deep as they will.
constexpr int kWarmFrames = 12;
constexpr uint64_t kMemoryBytes = uint64_t{1} << 30;

const ParallelLoop kInTurn = [](size_t count, const std::function<void(size_t)>& body) {
  for (size_t i = 0; i < count; ++i) body(i);
};

// How many candidates of a list are answered by their functions at a hit.
uint64_t CountAnswered(const KnownLights& known, const LightList& list) {
  if (known.shadows == nullptr) return 0;
  const auto first = list.candidates.data() - known.shadows->objects;
  uint64_t answered = 0;
  for (size_t i = 0; i < list.candidates.size(); ++i) {
    const ShadowFunction& function = known.shadows->functions[static_cast<size_t>(first) + i];
    const Shadowing shadowing =
        ShadowingAt(function, known.shadows->coefficients, known.s, known.t);
    answered += shadowing != Shadowing::kUnknown ? 1 : 0;
  }
  return answered;
}

Unsummed ReasonOf(const Scene& scene, const Hit& hit) {
  const Shape& shape = scene.objects[static_cast<size_t>(hit.object)].shape;
  if (IsBlack(scene.MaterialOf(hit.object).diffuse)) return Unsummed::kBlack;
  if (std::holds_alternative<TriangleShape>(shape)) return Unsummed::kVertexNormals;
  const bool is_lateral = std::holds_alternative<FrustumShape>(shape) && hit.face == 0;
  if (is_lateral || std::holds_alternative<SphereShape>(shape)) return Unsummed::kCurved;
  return Unsummed::kNear;
}

// Adds the lights that a hit's surface faces; returns how many the trees leave to be tested.
int AddLights(const Scene& scene, const Hit& hit, const KnownLights& known, LightStudyRow& row) {
  int undecided = 0;
  for (size_t i = 0; i < scene.lights.size(); ++i) {
    if (!(Dot(hit.normal, ViewOf(scene.lights[i], hit.point).to_light) > 0)) continue;
    const LightList list = known.lists == nullptr ? LightList{} : known.lists[i];
    if (list.knowledge == LightKnowledge::kOn || list.knowledge == LightKnowledge::kOff) {
      ++row.decided;
      const bool is_unsummed = list.knowledge == LightKnowledge::kOn && !list.summed;
      if (is_unsummed) ++row.unsummed[static_cast<size_t>(ReasonOf(scene, hit))];
      continue;
    }
    ++undecided;
    row.candidates += list.candidates.size();
    row.answered += CountAnswered(known, list);
  }
  row.undecided += static_cast<uint64_t>(undecided);
  return undecided;
}

}  // namespace

std::shared_ptr<const Scene> WithLights(const Scene& scene, size_t count) {
  auto lit = std::make_shared<Scene>(scene);
  if (count <= scene.lights.size()) return lit;
  Rgb total;
  for (const Light& light : scene.lights) total += light.irradiance;
  const Box3 bounds = scene.WorldBounds();
  const Vec3d extent = bounds.Extent();
  const auto columns = static_cast<size_t>(
      std::max(1.0, std::round(std::sqrt(static_cast<double>(count) * extent.x / extent.z))));
  const size_t rows = (count + columns - 1) / columns;
  lit->lights.clear();
  for (size_t i = 0; i < count; ++i) {
    const auto place = [](size_t k, size_t of) {
      return (static_cast<double>(k) + 0.5) / static_cast<double>(of);
    };
    Light light;
    light.irradiance = Scaled(total, 1 / static_cast<double>(count));
    light.position = {bounds.min.x + extent.x * (0.1 + 0.8 * place(i % columns, columns)),
                      bounds.max.y - 0.05 * extent.y,
                      bounds.min.z + extent.z * (0.1 + 0.8 * place(i / columns, rows))};
    lit->lights.push_back(light);
  }
  return lit;
}

LightStudyRow StudyLights(const Scene& scene, const Camera& camera, int side, double min_footprint,
                          bool functions, WorkerPool& pool) {
  const Tracer tracer(scene);
  SurfaceCache cache(tracer, kMemoryBytes, min_footprint, functions);
  const EyeRays rays(camera, side, side);
  const auto width = static_cast<size_t>(side);
  std::vector<Hit> hits(width * width);
  pool.ParallelFor(width, [&](size_t y) {
    for (size_t x = 0; x < width; ++x) {
      const Ray ray = rays.ThroughPixel(static_cast<int>(x), static_cast<int>(y));
      hits[y * width + x] = tracer.Intersect(ray.origin, ray.direction, RayStart{});
    }
  });
  LightStudyRow row;
  row.lights = scene.lights.size();
  row.functions = functions;
  double spent_us = 0;
  for (int frame = 0; frame < kWarmFrames; ++frame) {
    {
      const SurfaceCache::Reader reader(cache);
      for (const Hit& hit : hits) {
        if (hit.IsHit()) reader.Find(hit);
      }
    }
    const double begin = ThreadUs();
    row.cells += cache.Refine(1, kInTurn);
    spent_us += ThreadUs() - begin;
  }
  row.cell_us = spent_us / std::max<double>(1, static_cast<double>(row.cells));
  row.bytes = cache.ByteSize();
  const SurfaceCache::Reader reader(cache);
  for (const Hit& hit : hits) {
    if (!hit.IsHit()) continue;
    ++row.covered;
    if (!UsesLights(scene.MaterialOf(hit.object))) {
      ++row.nearly_decided;
      continue;
    }
    const int undecided = AddLights(scene, hit, reader.Find(hit), row);
    row.nearly_decided += undecided <= 1 ? 1 : 0;
  }
  return row;
}

}  // namespace linetree
