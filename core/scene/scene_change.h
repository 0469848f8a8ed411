// What differs between two scenes, so that what was learnt of the one may serve the other.
#pragma once

#include <cstdint>
#include <vector>

#include "core/scene/scene.h"

namespace linetree {

struct SceneChange {
  // By object of the former scene: its index now, ascending; kGone where there is none of that
  // shape any more.
  std::vector<int32_t> now;
  // By object of the former scene that is still there: whether it is made of something else.
  std::vector<bool> altered;
  // The bounds of what is gone or new, or lets other light through than before. World.
  std::vector<Box3> places;
  bool lights = false;    // any light, or the order of them
  bool radiance = false;  // what all answers depend on: lights, background, ambient light, white

  static constexpr int32_t kGone = -1;
  // Whether every object that is still there has its index, and what is gone left its own to
  // something new.
  bool keeps_indices = true;
};

// Objects are told by their shapes alone: those that keep their order among each other are the
// same, as many as possible. n log n for n objects.
SceneChange ChangeBetween(const Scene& former, const Scene& now);

}  // namespace linetree
