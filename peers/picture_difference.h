// How far a peer's picture is from the classical tracer's, in what a screen can show.
#pragma once

#include <cstdint>
#include <span>

namespace linetree {

struct PictureDifference {
  double rms = 0;                // over all channels
  double largest = 0;            // of any channel
  double share_beyond_code = 0;  // pixels with a channel that is off by more than kCodeStep
  double share_beyond_5_percent = 0;
};

// A step of an 8-bit picture.
inline constexpr double kCodeStep = 1.0 / 255;

// Both pictures hold 3 floats a pixel and have equal sizes, which is checked. Values are clipped to
// [0, 1] first, as the programs that write them as integers do; differences are absolute, of 1.
PictureDifference DifferenceOf(std::span<const float> picture, std::span<const float> reference);

}  // namespace linetree
