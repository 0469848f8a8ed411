// The forms in which a frame's radiance is sent.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "core/render/frame.h"

namespace linetree {

enum class FrameCodec {
  kFloat,  // tiles of the frame as it is
  kHalf,   // tiles, rounded to 16 bits
  kExr,    // files
  kPng,
  kJpeg,
};

struct FrameFormat {
  bool all_layers = false;
  FrameCodec codec = FrameCodec::kFloat;
  int jpeg_quality = 90;  // in [1, 100]
};

inline bool IsFile(FrameCodec codec) { return codec >= FrameCodec::kExr; }
// EXR files hold all layers, pictures the radiance.
inline bool HoldsLayers(FrameCodec codec) { return codec <= FrameCodec::kExr; }

// Of memory for each pixel, at most, while a frame becomes a file and then is sent: what is encoded
// and what is packed for that. 0 for tiles, which are made one at a time.
uint64_t FileBytesPerPixel(FrameCodec codec);

// The bytes of the file; the codec must be one of files. Of other layers those go along that the
// frame has and the codec can hold.
absl::StatusOr<std::string> EncodeFile(const Frame& frame, const FrameFormat& format);

}  // namespace linetree
