#include "core/io/frame_codec.h"

#include "core/io/exr.h"
#include "core/io/jpeg.h"
#include "core/io/layer_colors.h"
#include "core/io/png.h"
#include "core/math/check.h"

namespace linetree {

uint64_t FileBytesPerPixel(FrameCodec codec) {
  switch (codec) {
    case FrameCodec::kFloat:
    case FrameCodec::kHalf:
      return 0;
    case FrameCodec::kExr:
      return 7 * sizeof(float) + 3 * sizeof(uint32_t);  // seven channels; three packed
    case FrameCodec::kPng:
    case FrameCodec::kJpeg:
      return 2 * 3;  // the file; the picture
  }
  return 0;
}

absl::StatusOr<std::string> EncodeFile(const Frame& frame, const FrameFormat& format) {
  LT_CHECK(IsFile(format.codec));
  if (format.codec == FrameCodec::kExr) return EncodeExr(frame);
  const Picture8 picture = PaintLayer(frame, Layer::kBeauty);
  return format.codec == FrameCodec::kPng ? EncodePng(picture)
                                          : EncodeJpeg(picture, format.jpeg_quality);
}

}  // namespace linetree
