// Camera paths: keyframes that a client flies along, from Protobuf text.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/scene/camera.h"
#include "linetree/v1/camera_path.pb.h"

namespace linetree {

struct Keyframe {
  double time_s = 0;
  Camera camera;
};

enum class PathInterpolation { kLinear, kCatmullRom };

struct CameraPath {
  std::string name;
  std::string description;
  PathInterpolation interpolation = PathInterpolation::kLinear;
  int frames = 30;                  // of a flight along the whole path, unless the caller says
  std::vector<Keyframe> keyframes;  // at least one; times strictly increasing
};

// Bounds on what a path file may ask for.
inline constexpr uint64_t kMaxPathFileBytes = uint64_t{64} << 20;
inline constexpr int kMaxPathFrames = 1'000'000;

// Errors: NOT_FOUND, RESOURCE_EXHAUSTED, or INVALID_ARGUMENT
// "file:line:column: field path: what was expected" for what does not parse, no keyframe, times
// that do not increase, invalid cameras.
absl::StatusOr<CameraPath> LoadCameraPath(const std::string& path);
absl::StatusOr<CameraPath> ParseCameraPath(const std::string& text, const std::string& file_name);
// The same of a message from the wire; errors name `field` in place of the file.
absl::StatusOr<CameraPath> CameraPathFromMessage(const v1::CameraPath& message,
                                                 const std::string& field);

// The camera at time_s; before the first keyframe and after the last one, that keyframe's. Eye,
// look_at, up and fov are interpolated each on its own: straight, or by a cubic whose slope at a
// keyframe is that of the parabola through it and its neighbours (Catmull-Rom for equal steps of
// time), at the ends that of the chord. The name is that of the path. May be invalid even though
// the keyframes are not (the eye may run through the point that it looks at).
Camera CameraAt(const CameraPath& path, double time_s);

// `frames` >= 1 cameras at equal steps of time from the first to the last keyframe; one frame shows
// the first. INVALID_ARGUMENT naming the frame and its time when the camera there is invalid.
absl::StatusOr<std::vector<Camera>> SampleCameraPath(const CameraPath& path, int frames);

}  // namespace linetree
