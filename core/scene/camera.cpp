#include "core/scene/camera.h"

#include <numbers>

#include "absl/strings/str_cat.h"

namespace linetree {
namespace {

// sin of the smallest angle between view direction and up that is accepted. A thousandth of a
// degree: below it the picture's roll is decided by rounding.
constexpr double kMinUpSine = 1.7e-5;

absl::Status FiniteField(const char* field, const Vec3d& v) {
  if (IsFinite(v)) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(
      "camera.", field, ": expected finite coordinates, got (", v.x, ", ", v.y, ", ", v.z, ")"));
}

}  // namespace

absl::Status ValidateCamera(const Camera& camera) {
  if (auto s = FiniteField("eye", camera.eye); !s.ok()) return s;
  if (auto s = FiniteField("look_at", camera.look_at); !s.ok()) return s;
  if (auto s = FiniteField("up", camera.up); !s.ok()) return s;
  const Vec3d view = camera.look_at - camera.eye;
  const double view_length = Length(view);
  if (!(view_length > 0) || !std::isfinite(view_length)) {
    return absl::InvalidArgumentError(
        "camera.look_at: expected a point other than camera.eye, at a finite distance");
  }
  const double up_length = Length(camera.up);
  if (!(up_length > 0) || !std::isfinite(up_length)) {
    return absl::InvalidArgumentError("camera.up: expected a vector of finite, non-zero length");
  }
  const double sine = Length(Cross(view * (1 / view_length), camera.up * (1 / up_length)));
  if (!(sine > kMinUpSine)) {
    return absl::InvalidArgumentError(
        "camera.up: expected a vector that is not parallel to the view direction");
  }
  if (!(camera.fov_deg > 0 && camera.fov_deg < 180)) {
    return absl::InvalidArgumentError(
        absl::StrCat("camera.fov_deg: expected an angle in (0, 180), got ", camera.fov_deg));
  }
  return absl::OkStatus();
}

CameraFrame FrameOf(const Camera& camera) {
  CameraFrame frame;
  frame.forward = Normalized(camera.look_at - camera.eye);
  frame.right = Normalized(Cross(frame.forward, Normalized(camera.up)));
  frame.up = Cross(frame.right, frame.forward);
  return frame;
}

EyeRays::EyeRays(const Camera& camera, int width, int height)
    : eye_(camera.eye), width_(width), height_(height) {
  const CameraFrame frame = FrameOf(camera);
  const double tangent = std::tan(camera.fov_deg * std::numbers::pi / 360);
  forward_ = frame.forward;
  right_ = frame.right * tangent;
  up_ = frame.up * (tangent * height / width);
}

Ray EyeRays::Through(double x, double y) const {
  const Vec3d direction = forward_ + right_ * (2 * x / width_ - 1) + up_ * (1 - 2 * y / height_);
  return {eye_, Normalized(direction)};
}

}  // namespace linetree
