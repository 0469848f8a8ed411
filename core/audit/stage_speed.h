// Where the time of a frame by packets goes.
//
// Stages are not timed from within, which would change what is measured: frames of one view are
// timed whole, in turn, with stages left out, and a stage is what the median frame takes more with
// it. So the stages of a frame add up to the frame. Learning alone is timed within (FrameStages):
// it happens between waves of packets, a few times a frame.
#pragma once

#include <memory>

#include "absl/status/statusor.h"
#include "core/audit/frame_speed.h"

namespace linetree {

// Nanoseconds per pixel, medians. A stage that costs nothing may come out negative, by noise.
struct StageSpeed {
  double eye = 0;  // what eye rays meet, ambient light, the picture itself: no lights, no branches
  struct Legs {
    double lights = 0;    // at what eye rays meet
    double branches = 0;  // reflected and refracted rays and the lights at what they meet
    double all = 0;       // eye, lights and branches
  };
  Legs classical;
  Legs warm;  // cached, the last of some frames of the view
  // Within frames with all stages: blocks that are rendered first, to count what trees would save
  // in them, and cells that are certified.
  struct Learning {
    double probe = 0, learn = 0, all = 0;  // all: the frame
  };
  Learning cold_learning, warm_learning;
};

// The scene's first camera; `warm_frames` of one view, the last of which counts as warm.
absl::StatusOr<StageSpeed> StudyStages(std::shared_ptr<const Scene> scene,
                                       const FrameSpeedOptions& options, int warm_frames,
                                       WorkerPool& pool);

}  // namespace linetree
