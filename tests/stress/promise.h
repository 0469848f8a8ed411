// The promise of cached answers, checked from outside: through SceneHost with the certified judge,
// against the classical tracer. |answer - classical| <= e * max(classical, RadianceFloor(scene)),
// per channel; for e = 0 the bits are equal.
#pragma once

#include <memory>
#include <vector>

#include "core/render/scene_host.h"
#include "tests/stress/stress.h"

namespace linetree::stress {

using ScenePtr = std::shared_ptr<const Scene>;

// All of the smallest, an ordinary and the largest bound that a request may name.
std::vector<double> Bounds();

struct PromiseOptions {
  std::vector<double> bounds = Bounds();
  int rounds = 3;  // of the same rays; the first one finds the cache empty
  uint64_t memory_bytes = uint64_t{64} << 20;
  int threads = 2;
  PathLimits limits;
};

// What the classical tracer says of these rays, whose directions may have any length.
std::vector<Rgb> Classical(const Scene& scene, const std::vector<Ray>& rays,
                           const PathLimits& limits);

// Error over bound of one answer: at most 1 where the promise holds, infinite where bits differ at
// e = 0 or something is not a number. 0 for equal bits.
double ErrorOverBound(const Rgb& answer, const Rgb& classical, double bound, double floor);

// The certified answers to the rays. Fails the current test when the request is refused.
std::vector<RayAnswer> Certified(SceneHost& host, const std::vector<Ray>& rays, double bound,
                                 const PathLimits& limits, WorkerPool& pool);

// Asks for the rays again and again, at every bound with a cache of its own, and fails the current
// test, naming the ray, where the promise is broken. Returns the number of cells certified.
uint64_t ExpectPromise(const ScenePtr& scene, const std::vector<Ray>& rays, Largest& largest,
                       const PromiseOptions& options = {});

}  // namespace linetree::stress
