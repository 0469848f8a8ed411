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

// Lights that a hit's surface faces and that the trees leave to be tested.
int CountUndecided(const Scene& scene, const Hit& hit, const LightList* known) {
  int undecided = 0;
  for (size_t i = 0; i < scene.lights.size(); ++i) {
    if (!(Dot(hit.normal, ViewOf(scene.lights[i], hit.point).to_light) > 0)) continue;
    const LightKnowledge knowledge =
        known == nullptr ? LightKnowledge::kUnknown : known[i].knowledge;
    if (knowledge == LightKnowledge::kUnknown || knowledge == LightKnowledge::kListed) ++undecided;
  }
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
                          WorkerPool& pool) {
  const Tracer tracer(scene);
  SurfaceCache cache(tracer, kMemoryBytes, min_footprint);
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
  double spent_us = 0;
  for (int frame = 0; frame < kWarmFrames; ++frame) {
    {
      const SurfaceCache::Reader reader(cache);
      for (const Hit& hit : hits) {
        if (hit.IsHit()) reader.Find(hit);
      }
    }
    const double begin = NowUs();
    row.cells += cache.Refine(1, kInTurn);
    spent_us += NowUs() - begin;
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
    const int undecided = CountUndecided(scene, hit, reader.Find(hit).lists);
    row.undecided += static_cast<uint64_t>(undecided);
    row.nearly_decided += undecided <= 1 ? 1 : 0;
  }
  return row;
}

}  // namespace linetree
