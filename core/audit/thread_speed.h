// What a second thread gives: cached frames of one view with one thread and with two, in turn; and,
// as what the machine has to give, the same of classical frames, whose blocks need nobody.
#pragma once

#include <memory>

#include "absl/status/statusor.h"
#include "core/audit/frame_speed.h"

namespace linetree {

struct ThreadSpeed {
  double ratio = 0;  // time with one thread / with two; median of the repeats' last frames
  double classical_ratio = 0;  // the same of classical frames, one of each a repeat
  uint64_t unequal = 0;        // pixels of all frames that the two differ in
};

// The scene's first camera, `frames` times with a cache for each of the two.
absl::StatusOr<ThreadSpeed> StudyThreads(std::shared_ptr<const Scene> scene,
                                         const FrameSpeedOptions& options, int frames);

}  // namespace linetree
