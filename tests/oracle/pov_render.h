// Runs POV-Ray and reads what it wrote.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/math/rgb.h"

namespace linetree {

// Linear values in steps of 1/65535, clipped at 1; rows from the top.
struct PovPicture {
  int width = 0, height = 0;
  std::vector<Rgb> pixels;
};

// Renders the text of a POV-Ray file. `name` distinguishes files of tests that run at once.
absl::StatusOr<PovPicture> RenderWithPov(const std::string& pov_text, const std::string& name,
                                         int width, int height);

// Binary PPM of 16 bits per channel, with comments in its header.
absl::StatusOr<PovPicture> ParsePpm16(const std::string& bytes);

}  // namespace linetree
