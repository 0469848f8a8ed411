// Pinhole camera.
//
// Frames: F = direction of view, R = normalize(F x up), U = R x F. The eye ray through the pixel in
// column i of W, row j of H (row 0 on top) has the direction
//   normalize(F + (2 (i + 1/2)/W - 1) tan(fov/2) R + (1 - 2 (j + 1/2)/H) tan(fov/2) (H/W) U),
// which is POV-Ray's convention; fov is the horizontal angle.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "core/math/vec3.h"

namespace linetree {

struct Ray {
  Vec3d origin;
  Vec3d direction;  // unit length
};

struct Camera {
  std::string name;
  Vec3d eye{0, 0, 5};
  Vec3d look_at{0, 0, 0};
  Vec3d up{0, 1, 0};
  double fov_deg = 45;
  bool operator==(const Camera&) const = default;
};

// The three axes of a valid camera, all of unit length.
struct CameraFrame {
  Vec3d forward, right, up;
};

// OK, or INVALID_ARGUMENT naming the field and what was expected: everything finite, eye !=
// look_at, up not parallel to the view direction, fov_deg in (0, 180).
absl::Status ValidateCamera(const Camera& camera);

// Requires ValidateCamera(camera).ok().
CameraFrame FrameOf(const Camera& camera);

// Rounding of EyeRays::Through: its direction is within
//   kEyeRayRounding * (1 + tan(fov/2)) / sin(angle between view and up)
// of the formula above. 30 roundings of 2^-53 lie between the camera and a pixel's direction: 6 of
// F, 5 of up, 7 to R (whose length before it is scaled is that sine), 3 to U, 4 of the tangent,
// which wide angles magnify, 5 of the sum and its length. Rounded up to 32.
inline constexpr double kEyeRayRounding = 0x1p-48;

// Eye rays of a picture of width x height pixels; pixel coordinates are continuous, the centre of
// the top left pixel is (0.5, 0.5).
class EyeRays {
 public:
  EyeRays(const Camera& camera, int width, int height);
  Ray Through(double x, double y) const;
  Ray ThroughPixel(int column, int row) const { return Through(column + 0.5, row + 0.5); }

  // The same view, each pixel of it divided into `across` x `down`.
  EyeRays Divided(int across, int down) const {
    EyeRays divided = *this;
    divided.width_ *= across;
    divided.height_ *= down;
    return divided;
  }

  // What Through adds up: the direction of (x, y), before it is scaled to unit length, is
  // forward + right (2 x / width - 1) + up (1 - 2 y / height).
  const Vec3d& eye() const { return eye_; }
  const Vec3d& forward() const { return forward_; }
  const Vec3d& right() const { return right_; }
  const Vec3d& up() const { return up_; }
  double width() const { return width_; }
  double height() const { return height_; }

 private:
  Vec3d eye_;
  Vec3d forward_, right_, up_;  // right_ and up_ scaled by the half angle's tangents
  double width_, height_;
};

}  // namespace linetree
