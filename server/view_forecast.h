// Where a flight's camera is going to be: policy only.
#pragma once

#include <optional>

#include "core/scene/camera.h"

namespace linetree {

class ViewForecast {
 public:
  // The view that is likely to follow `current`, when it goes on as it came from the one before:
  // eye and aim move on by as much as they have moved. Nothing after the first view, when the
  // camera rests, and after a jump: a step of another length or direction than the one before.
  std::optional<Camera> After(const Camera& current);

 private:
  std::optional<Camera> former_;
  std::optional<Vec3d> step_;  // of the eye and, where that rests, of the aim
};

// Of two steps that follow each other: the longer by the shorter, and the difference between them
// by the longer.
inline constexpr double kMaxStretch = 4;
inline constexpr double kMaxTurn = 1;

}  // namespace linetree
