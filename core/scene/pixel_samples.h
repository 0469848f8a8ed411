// Where the eye rays of a pixel go through it, if it has several: its samples.
//
// The pixel is divided into as many cells as it has samples, `across` columns by `down` rows, and
// sample r * across + c lies in the cell in column c and row r (row 0 on top):
//   N = k k   k x k cells. Regular samples lie in the cells' centres, jittered ones anywhere in
//             them.
//   other N   N columns of one cell. Sample i lies at the height (g i mod N + 1/2) / N, g the whole
//             number coprime to N that is nearest to N by the golden ratio: a lattice of rank 1. A
//             jittered one lies anywhere in [i, i + 1) x [g i mod N, g i mod N + 1), in Nths.
// All pixels have the same regular samples. Jittered ones depend on seed, pixel and sample, and on
// nothing else.
//
// Cells are pixels of a finer image of the same view (EyeRays::Divided), in which they are counted.
#pragma once

#include <array>
#include <cstdint>

#include "absl/status/status.h"
#include "core/scene/camera.h"

namespace linetree {

inline constexpr int kMaxPixelSamples = 64;

enum class SamplePattern { kRegular, kJittered };

struct Sampling {
  int samples = 1;  // of every pixel, in [1, kMaxPixelSamples]
  SamplePattern pattern = SamplePattern::kRegular;
  uint64_t seed = 0;  // of what is jittered

  bool operator==(const Sampling&) const = default;
  // One ray through the centre of every pixel.
  bool IsPlain() const { return samples == 1 && pattern == SamplePattern::kRegular; }
};

// OK, or INVALID_ARGUMENT naming the field (as in service.proto) and what was expected.
absl::Status ValidateSampling(const Sampling& sampling);

class PixelSamples {
 public:
  // Requires ValidateSampling(sampling).ok().
  explicit PixelSamples(const Sampling& sampling);

  int count() const { return across_ * down_; }
  int across() const { return across_; }
  int down() const { return down_; }

  // Whether every sample lies in the centre of its cell.
  bool AreCentred() const { return !jittered_ && across_ == down_; }

  // Where a cell's sample lies within it, x to the right and y down, both in [0, 1). `column` and
  // `row` count the cells of the whole image.
  struct Place {
    double x = 0.5, y = 0.5;
  };
  Place PlaceIn(int column, int row) const;

  // Of a cell's sample; `eye_rays` are those of the finer image.
  Ray RayOf(const EyeRays& eye_rays, int column, int row) const {
    const Place place = PlaceIn(column, row);
    return eye_rays.Through(column + place.x, row + place.y);
  }

  // How far the mean of a pixel's samples may lie from its centre, in either direction, as a share
  // of half its side.
  double MeanOff() const;

 private:
  bool jittered_;
  uint64_t seed_;
  int across_, down_;
  std::array<uint8_t, kMaxPixelSamples> height_{};  // of the lattice's samples, in their order
};

}  // namespace linetree
