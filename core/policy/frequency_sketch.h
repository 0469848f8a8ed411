// How often ids were seen of late, roughly, in a few bits each.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "core/math/mixed_bits.h"

namespace linetree {

// A count-min sketch of four rows whose counters stop at 15 and are halved after ten times as many
// sightings as a row has counters (Einziger, Friedman, Manes: TinyLFU, 2017). It never counts too
// little but for the halving.
class FrequencySketch {
 public:
  // `ids`: how many different ones there are about; more than it was made for start it anew.
  void MakeRoom(size_t ids) {
    if (ids <= width_) return;
    width_ = 64;
    while (width_ < ids) width_ *= 2;
    width_ *= 2;
    for (auto& row : rows_) row.assign(width_, 0);
    seen_ = 0;
  }
  void Add(uint64_t id) {
    for (size_t row = 0; row < rows_.size(); ++row) {
      uint8_t& count = rows_[row][Place(id, row)];
      count = std::min<uint8_t>(static_cast<uint8_t>(count + 1), 15);
    }
    if (++seen_ >= 10 * width_) Halve();
  }
  int Count(uint64_t id) const {
    int least = 15;
    for (size_t row = 0; row < rows_.size(); ++row) {
      least = std::min<int>(least, rows_[row][Place(id, row)]);
    }
    return least;
  }
  uint64_t ByteSize() const { return rows_.size() * width_; }

 private:
  size_t Place(uint64_t id, size_t row) const {
    return MixedBits(id ^ (row * 0xd6e8feb86659fd93u)) & (width_ - 1);
  }
  void Halve() {
    for (auto& row : rows_) {
      for (uint8_t& count : row) count = static_cast<uint8_t>(count / 2);
    }
    seen_ /= 2;
  }

  size_t width_ = 0;
  uint64_t seen_ = 0;
  std::array<std::vector<uint8_t>, 4> rows_;
};

}  // namespace linetree
