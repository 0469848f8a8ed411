#include "server/view_forecast.h"

#include <algorithm>
#include <utility>

namespace linetree {
namespace {

bool GoesOn(const Vec3d& before, const Vec3d& now) {
  const double a = Length(before), b = Length(now);
  return std::max(a, b) <= kMaxStretch * std::min(a, b) &&
         Length(now - before) <= kMaxTurn * std::max(a, b);
}

}  // namespace

std::optional<Camera> ViewForecast::After(const Camera& current) {
  const auto former = std::exchange(former_, current);
  if (!former) return std::nullopt;
  const Vec3d eye_step = current.eye - former->eye;
  const Vec3d aim_step = current.look_at - former->look_at;
  const Vec3d step = eye_step == Vec3d{} ? aim_step : eye_step;
  const auto before = std::exchange(step_, step);
  if (step == Vec3d{}) return std::nullopt;
  // Two steps at least say where it goes.
  if (!before || !GoesOn(*before, step)) return std::nullopt;
  Camera next = current;
  next.eye = current.eye + eye_step;
  next.look_at = current.look_at + aim_step;
  if (!ValidateCamera(next).ok()) return std::nullopt;
  return next;
}

}  // namespace linetree
