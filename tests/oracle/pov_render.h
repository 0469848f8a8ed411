// Runs POV-Ray and reads what it wrote.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "core/io/ppm.h"

namespace linetree {

// Renders the text of a POV-Ray file: linear values, clipped at 1. `name` distinguishes files of
// tests that run at once.
absl::StatusOr<PpmPicture> RenderWithPov(const std::string& pov_text, const std::string& name,
                                         int width, int height);

}  // namespace linetree
