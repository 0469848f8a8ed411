// How far a picture is from a reference: the project's one measure of error.
//
// A channel's relative error is |a - b| / max(|b|, floor), b from the reference; a pixel's is its
// worst channel's, infinity where either picture is not finite. The floor is a quarter of a code
// value of an 8-bit picture (DESIGN: certified cells): white * kFloorOfWhite.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "absl/status/statusor.h"
#include "core/render/frame.h"

namespace linetree {

struct CompareOptions {
  double white = 1;
  double floor = white * kFloorOfWhite;
  // Pixels whose error exceeds this are counted as beyond.
  double max_relative_error = 0;
};

struct ErrorFigures {
  uint64_t pixels = 0;
  uint64_t beyond = 0;      // error > max_relative_error, or not finite
  uint64_t not_finite = 0;  // of these: NaN or infinite in either picture
  double max = 0;           // relative errors, over pixels
  double mean = 0;
  double p999 = 0;     // the smallest error that at least 99.9 % of the pixels do not exceed
  double psnr_db = 0;  // peak: white, over all channels; infinite for equal pictures
  uint64_t worst = 0;  // the first pixel of the largest error, row * width + column
};

// Pictures hold float, the promise is made in double: rounding both radiances to float and the
// reference's in the divisor moves an error of e by at most 2 (1 + e) 2^-24. Granted where e > 0;
// at e = 0 equal radiances round to equal floats.
inline constexpr double kFloatRounding = 0x1p-23;

// `a` and `reference` hold 3 floats a pixel and have equal sizes, which is checked.
ErrorFigures CompareRadiance(std::span<const float> a, std::span<const float> reference,
                             const CompareOptions& options);

// INVALID_ARGUMENT when the frames have different sizes.
absl::StatusOr<ErrorFigures> CompareFrames(const Frame& a, const Frame& reference,
                                           const CompareOptions& options);

// The figures by name, infinities as null; worst as {"x", "y"} of a picture `width` wide.
nlohmann::json ErrorJson(const ErrorFigures& figures, const CompareOptions& options, int width);

}  // namespace linetree
