#include "tests/stress/promise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "absl/strings/str_format.h"
#include "core/scene/affine_map.h"

namespace linetree::stress {
namespace {

std::string Text(const Vec3d& v) { return absl::StrFormat("(%a, %a, %a)", v.x, v.y, v.z); }
std::string Text(const Rgb& c) { return absl::StrFormat("(%.17g, %.17g, %.17g)", c.r, c.g, c.b); }

bool IsRadiance(const Rgb& c) {
  return std::isfinite(c.r) && std::isfinite(c.g) && std::isfinite(c.b) && c.r >= 0 && c.g >= 0 &&
         c.b >= 0;
}

}  // namespace

std::vector<double> Bounds() { return {0, std::numeric_limits<double>::denorm_min(), 0.05, 1}; }

std::vector<Rgb> Classical(const Scene& scene, const std::vector<Ray>& rays,
                           const PathLimits& limits) {
  const Tracer tracer(scene);
  std::vector<Rgb> radiances;
  radiances.reserve(rays.size());
  RayCounts counts;
  for (const Ray& ray : rays) {
    radiances.push_back(tracer.Radiance(ray.origin, Unit(ray.direction), limits, counts));
  }
  return radiances;
}

double ErrorOverBound(const Rgb& answer, const Rgb& classical, double bound, double floor) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  if (!IsRadiance(answer) || !IsRadiance(classical)) return kInf;
  double worst = 0;
  for (int i = 0; i < 3; ++i) {
    if (answer[i] == classical[i]) continue;
    const double allowed = bound * std::max(classical[i], floor);
    const double error = std::abs(answer[i] - classical[i]);
    worst = std::max(worst, allowed > 0 ? error / allowed : kInf);
  }
  return worst;
}

std::vector<RayAnswer> Certified(SceneHost& host, const std::vector<Ray>& rays, double bound,
                                 const PathLimits& limits, WorkerPool& pool) {
  RenderOptions request;
  request.judge = JudgeKind::kCertified;
  request.max_relative_error = bound;
  request.limits = limits;
  const auto batch = host.TraceRays(rays, request, pool);
  EXPECT_TRUE(batch.ok()) << batch.status();
  return batch.ok() ? batch->answers : std::vector<RayAnswer>(rays.size());
}

uint64_t ExpectPromise(const ScenePtr& scene, const std::vector<Ray>& rays, Largest& largest,
                       const PromiseOptions& options) {
  const std::vector<Rgb> classical = Classical(*scene, rays, options.limits);
  const double floor = RadianceFloor(*scene);
  WorkerPool pool(options.threads);
  uint64_t cells = 0;
  for (const double bound : options.bounds) {
    CacheOptions cache;
    cache.memory_bytes = options.memory_bytes;
    cache.always_ask = true;  // small caches would pause
    SceneHost host(scene, cache);
    for (int round = 0; round < options.rounds; ++round) {
      const auto answers = Certified(host, rays, bound, options.limits, pool);
      for (size_t i = 0; i < rays.size(); ++i) {
        if (largest.Add(ErrorOverBound(answers[i].radiance, classical[i], bound, floor))) continue;
        ADD_FAILURE() << "seed " << Seed() << ", ray " << i << " from " << Text(rays[i].origin)
                      << " to " << Text(rays[i].direction) << ", bound " << bound << ", round "
                      << round << ": " << Text(answers[i].radiance) << " instead of "
                      << Text(classical[i]) << ", object " << answers[i].object;
        return cells;
      }
    }
    cells += host.surfaces().CellCount();
    EXPECT_LE(host.CacheBytes(), options.memory_bytes);
  }
  return cells;
}

}  // namespace linetree::stress
