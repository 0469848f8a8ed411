// 8-bit sRGB pictures as JPEG files in memory.
#pragma once

#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "core/io/layer_colors.h"

namespace linetree {

// The bytes of the file; `quality` in [1, 100]. Colour at the full resolution of the picture.
absl::StatusOr<std::string> EncodeJpeg(const Picture8& picture, int quality);

// INVALID_ARGUMENT for what is no JPEG file.
absl::StatusOr<Picture8> DecodeJpeg(std::string_view bytes);

}  // namespace linetree
