#include "core/io/camera_path.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "core/io/proto_text.h"
#include "core/io/read_file.h"
#include "core/io/wire.h"
#include "core/math/check.h"

namespace linetree {
namespace {

// What is interpolated, as plain numbers: eye, look_at, up, fov_deg.
using Values = std::array<double, 10>;

Values ValuesOf(const Camera& c) {
  return {c.eye.x,     c.eye.y, c.eye.z, c.look_at.x, c.look_at.y,
          c.look_at.z, c.up.x,  c.up.y,  c.up.z,      c.fov_deg};
}

Camera CameraOf(const Values& v, const std::string& name) {
  return {name, {v[0], v[1], v[2]}, {v[3], v[4], v[5]}, {v[6], v[7], v[8]}, v[9]};
}

Values Slope(const Keyframe& a, const Keyframe& b) {
  const Values from = ValuesOf(a.camera);
  Values slope = ValuesOf(b.camera);
  for (size_t i = 0; i < slope.size(); ++i) slope[i] = (slope[i] - from[i]) / (b.time_s - a.time_s);
  return slope;
}

// The derivative at keyframe k. Between two chords of slopes d and e over times g and h, the
// parabola through the three keyframes has the slope (d h + e g) / (g + h).
Values Tangent(const std::vector<Keyframe>& keys, size_t k) {
  if (k == 0) return Slope(keys[0], keys[1]);
  if (k + 1 == keys.size()) return Slope(keys[k - 1], keys[k]);
  const double g = keys[k].time_s - keys[k - 1].time_s;
  const double h = keys[k + 1].time_s - keys[k].time_s;
  const Values before = Slope(keys[k - 1], keys[k]);
  Values tangent = Slope(keys[k], keys[k + 1]);
  for (size_t i = 0; i < tangent.size(); ++i) {
    tangent[i] = (before[i] * h + tangent[i] * g) / (g + h);
  }
  return tangent;
}

// The cubic Hermite basis at s in [0, 1]; slopes are per unit of time, the step lasts `span`.
Values Hermite(const std::vector<Keyframe>& keys, size_t k, double s) {
  const Values p = ValuesOf(keys[k].camera);
  const Values q = ValuesOf(keys[k + 1].camera);
  const Values m = Tangent(keys, k);
  const Values n = Tangent(keys, k + 1);
  const double span = keys[k + 1].time_s - keys[k].time_s;
  const double s2 = s * s;
  const double s3 = s2 * s;
  Values v{};
  for (size_t i = 0; i < v.size(); ++i) {
    v[i] = (2 * s3 - 3 * s2 + 1) * p[i] + (3 * s2 - 2 * s3) * q[i] +
           span * ((s3 - 2 * s2 + s) * m[i] + (s3 - s2) * n[i]);
  }
  return v;
}

Values Straight(const std::vector<Keyframe>& keys, size_t k, double s) {
  const Values p = ValuesOf(keys[k].camera);
  const Values q = ValuesOf(keys[k + 1].camera);
  Values v{};
  for (size_t i = 0; i < v.size(); ++i) v[i] = (1 - s) * p[i] + s * q[i];
  return v;
}

// Parsed text with the means to say where a field stands.
struct PathSource {
  const std::string& text;
  const std::string& file_name;
  v1::CameraPath message;

  absl::Status Error(const std::string& field_path, absl::string_view what) const {
    return absl::InvalidArgumentError(absl::StrCat(
        WhereInProtoText(text, file_name, message, field_path), ": ", field_path, ": ", what));
  }
};

absl::Status CheckKeyframe(const PathSource& source, int index, const Keyframe& key,
                           const Keyframe* before) {
  const std::string field = absl::StrCat("keyframes[", index, "].");
  if (!std::isfinite(key.time_s)) {
    return source.Error(field + "time_s", "expected a finite number of seconds");
  }
  if (before != nullptr && !(key.time_s > before->time_s)) {
    return source.Error(field + "time_s",
                        absl::StrCat("expected a time after that of the keyframe before (",
                                     before->time_s, "), found ", key.time_s));
  }
  const absl::Status status = ValidateCamera(key.camera);
  if (status.ok()) return status;
  const absl::string_view message = status.message();
  const size_t colon = message.find(": ");
  LT_CHECK(colon != absl::string_view::npos);
  return source.Error(absl::StrCat(field, message.substr(0, colon)), message.substr(colon + 2));
}

absl::StatusOr<CameraPath> BuildPath(const PathSource& source) {
  const v1::CameraPath& message = source.message;
  CameraPath path;
  path.name = message.name();
  path.description = message.description();
  if (message.interpolation() == v1::CameraPath::CATMULL_ROM) {
    path.interpolation = PathInterpolation::kCatmullRom;
  } else if (message.interpolation() != v1::CameraPath::LINEAR) {
    return source.Error("interpolation", "expected LINEAR or CATMULL_ROM");
  }
  if (message.frames() > kMaxPathFrames) {
    return source.Error(
        "frames", absl::StrCat("expected at most ", kMaxPathFrames, ", found ", message.frames()));
  }
  if (message.frames() != 0) path.frames = static_cast<int>(message.frames());
  for (const v1::Keyframe& key : message.keyframes()) {
    const int index = static_cast<int>(path.keyframes.size());
    path.keyframes.push_back({key.time_s(), CameraFromWire(key.camera())});
    const Keyframe* before = index == 0 ? nullptr : &path.keyframes[path.keyframes.size() - 2];
    absl::Status status = CheckKeyframe(source, index, path.keyframes.back(), before);
    if (!status.ok()) return status;
  }
  if (path.keyframes.empty()) return source.Error("keyframes", "expected at least one");
  return path;
}

}  // namespace

absl::StatusOr<CameraPath> LoadCameraPath(const std::string& path) {
  absl::StatusOr<std::string> text = ReadFileAtMost(path, kMaxPathFileBytes);
  if (!text.ok()) return text.status();
  return ParseCameraPath(*text, path);
}

absl::StatusOr<CameraPath> ParseCameraPath(const std::string& text, const std::string& file_name) {
  PathSource source{text, file_name, {}};
  absl::Status status = ParseProtoText(text, file_name, &source.message);
  if (!status.ok()) return status;
  return BuildPath(source);
}

absl::StatusOr<CameraPath> CameraPathFromMessage(const v1::CameraPath& message,
                                                 const std::string& field) {
  const std::string no_text;
  return BuildPath({no_text, field, message});
}

Camera CameraAt(const CameraPath& path, double time_s) {
  const std::vector<Keyframe>& keys = path.keyframes;
  LT_CHECK(!keys.empty());
  const auto after = std::upper_bound(keys.begin(), keys.end(), time_s,
                                      [](double t, const Keyframe& key) { return t < key.time_s; });
  if (after == keys.begin()) return CameraOf(ValuesOf(keys.front().camera), path.name);
  if (after == keys.end()) return CameraOf(ValuesOf(keys.back().camera), path.name);
  const auto k = static_cast<size_t>(after - keys.begin()) - 1;
  const double s = (time_s - keys[k].time_s) / (keys[k + 1].time_s - keys[k].time_s);
  const bool straight = path.interpolation == PathInterpolation::kLinear;
  return CameraOf(straight ? Straight(keys, k, s) : Hermite(keys, k, s), path.name);
}

absl::StatusOr<std::vector<Camera>> SampleCameraPath(const CameraPath& path, int frames) {
  LT_CHECK(frames >= 1);
  const double begin = path.keyframes.front().time_s;
  const double end = path.keyframes.back().time_s;
  std::vector<Camera> cameras;
  cameras.reserve(static_cast<size_t>(frames));
  for (int i = 0; i < frames; ++i) {
    // The last frame is the last keyframe, whatever rounding does in between.
    const double share = frames == 1 ? 0 : static_cast<double>(i) / (frames - 1);
    const double time_s = i + 1 == frames && frames > 1 ? end : begin + share * (end - begin);
    cameras.push_back(CameraAt(path, time_s));
    const absl::Status status = ValidateCamera(cameras.back());
    if (!status.ok()) {
      return absl::InvalidArgumentError(absl::StrCat("camera path '", path.name, "', frame ", i,
                                                     " (", time_s, " s): ", status.message()));
    }
  }
  return cameras;
}

}  // namespace linetree
