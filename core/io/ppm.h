// Binary PPM pictures of 16 bits per channel, which other ray tracers write.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/math/rgb.h"

namespace linetree {

// Values in steps of 1/65535, in [0, 1]; rows from the top.
struct PpmPicture {
  int width = 0, height = 0;
  std::vector<Rgb> pixels;
};

// The header may hold comments. INVALID_ARGUMENT says what was expected.
absl::StatusOr<PpmPicture> ParsePpm16(absl::string_view bytes);

}  // namespace linetree
