// What a pixel of several samples shows.
#pragma once

#include "core/math/rgb.h"
#include "core/scene/pixel_samples.h"

namespace linetree {

// The mean is rounded to float once more than its samples were: relative.
inline constexpr double kMeanRounding = 0x1p-24;

// The samples' sum down each column of the pixel's cells, in double, then the sum of these from the
// left to the right, times 1 / N. at(column, row) is a sample's radiance.
template <class At>
Rgb MeanOfSamples(const PixelSamples& samples, const At& at) {
  Rgb sum;
  for (int column = 0; column < samples.across(); ++column) {
    Rgb line = at(column, 0);
    for (int row = 1; row < samples.down(); ++row) line += at(column, row);
    sum += line;
  }
  return Scaled(sum, 1.0 / samples.count());
}

// The sample whose object, source, verdict and depth are shown: in the column and row in the
// middle, of two the later one.
struct ShownSample {
  int column, row;
  explicit ShownSample(const PixelSamples& samples)
      : column(samples.across() / 2), row(samples.down() / 2) {}
};

}  // namespace linetree
