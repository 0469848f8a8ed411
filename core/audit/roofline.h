// What a cache of light can reach at best: a frame whose lights cost nothing still has to find what
// its rays meet, and to be written.
#pragma once

#include <memory>

#include "absl/status/statusor.h"
#include "core/audit/frame_speed.h"

namespace linetree {

// Of a classical frame by packets, nanoseconds per pixel, medians. A stage that costs nothing may
// come out negative, by noise.
struct Roofline {
  double eye = 0;       // eye rays, what they meet, ambient light, the picture itself
  double branches = 0;  // reflected and refracted rays, and what they meet
  double lights = 0;    // all lights, at what rays of all depths meet
  double classical = 0;

  // classical / cached of a cache that spares everything about lights, costs nothing, and spares
  // nothing else. Where a face is known to be all that a square of pixels sees, sheets compute no
  // hit either (core/frame/sheet-inl.h), and may do better.
  double Best() const { return classical / (eye + branches); }
};

// The scene's first camera. Frames with all stages and without some take turns.
absl::StatusOr<Roofline> StudyRoofline(std::shared_ptr<const Scene> scene,
                                       const FrameSpeedOptions& options, WorkerPool& pool);

}  // namespace linetree
