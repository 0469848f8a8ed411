// Frames as OpenEXR files, on disk or in memory: 32-bit float, ZIP, one part, scanlines from the
// top.
//
// Channels
//   R G B    float  linear radiance
//   object   uint   index of the object seen, kExrBackgroundObject for the background
//   source   uint   Source
//   verdict  uint   Verdict
//   Z        float  distance from the eye, infinity for the background
// A frame without layers has R G B only.
//
// Attributes
//   camera (string: its name), eye, look_at, up (v3d), fov_deg, max_relative_error, white (double),
//   scene_version (string), statistics (string: JSON as in stats_json.h).
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/render/frame.h"

namespace linetree {

inline constexpr uint32_t kExrBackgroundObject = 0xFFFFFFFF;

// Largest picture that is read: a header may claim any size.
inline constexpr int64_t kMaxExrPixels = int64_t{1} << 28;

// The bytes of the file. Layers are written when they are all there.
std::string EncodeExr(const Frame& frame);

// Writes the whole file or nothing (atomic_file.h).
absl::Status WriteExr(const Frame& frame, const std::string& path);

// As ReadExr, of the bytes of a file as EncodeExr makes them, of at most so many pixels: what takes
// more memory than that is refused before it does.
absl::StatusOr<Frame> DecodeExr(const std::string& bytes, int64_t max_pixels = kMaxExrPixels);

// Reads any EXR file that has R, G and B; layers and attributes are taken where they are present
// (layers need all five channels), stats stay at their defaults but for the number of pixels.
// NOT_FOUND, or INVALID_ARGUMENT naming the file and what is wrong with it.
absl::StatusOr<Frame> ReadExr(const std::string& path);

}  // namespace linetree
