// A plain Whitted tracer on Embree, one ray at a time: what somebody would write who takes a well
// kept library for finding hits. A peer for benchmarks only.
//
// Embree finds the hits, in float; everything else is the classical tracer's arithmetic: its
// shading formulas (core/trace/shade.h), its limits, its rules for media and shadows. Opaque round
// spheres are Embree's sphere points; opaque boxes, polygons and triangles are Embree's triangles;
// all else is user geometry that calls the classical tracer's own shape code. What lets light
// through is user geometry too: a shadow ray must count each of its surfaces once, which Embree
// does not promise where triangles share an edge.
//
// Thread safety: all methods are const and may be called from any number of threads.
#pragma once

#include <memory>
#include <string>

#include "core/scene/camera.h"
#include "core/scene/scene.h"
#include "core/trace/tracer.h"

namespace linetree {

class EmbreeScene;

// Rays that leave an opaque surface start at this distance, relative to the largest coordinate of
// the scene: some hundred times the rounding of Embree's floats, 2^-24, which else would find the
// surface that the ray leaves. What lies nearer to it is missed.
inline constexpr double kEmbreeStart = 0x1p-17;

class EmbreeTracer {
 public:
  // Keeps a reference to the scene, which must outlive the tracer.
  explicit EmbreeTracer(const Scene& scene);
  ~EmbreeTracer();
  EmbreeTracer(const EmbreeTracer&) = delete;
  EmbreeTracer& operator=(const EmbreeTracer&) = delete;

  // Embree's, as "3.13.5".
  std::string Version() const;

  // Radiance along an eye ray. The same as Tracer::Radiance but for rays that pass an edge (of an
  // object, a shadow, a branch) within float's rounding, or a contact within kEmbreeStart.
  Rgb Radiance(const Ray& ray, const PathLimits& limits) const;

 private:
  const std::unique_ptr<const EmbreeScene> scene_;
};

}  // namespace linetree
