// Which answers of a request an audit looks at.
#pragma once

#include <cstdint>
#include <limits>

namespace linetree {

// Picks every index with probability `share`, by hashing; the cost grows with what is picked, not
// with what is skipped. The same request number picks the same indices.
class SampledIndices {
 public:
  SampledIndices(double share, uint64_t request);

  // The next index, in rising order; kNone after the last one that fits 64 bits.
  uint64_t Next();
  static constexpr uint64_t kNone = std::numeric_limits<uint64_t>::max();

 private:
  const double share_;
  uint64_t state_;
  uint64_t next_ = 0;  // the first index that may still be picked
};

}  // namespace linetree
