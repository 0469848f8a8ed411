// Extremal rays that have been traced, shared between neighbouring cells and generations.
//
// Thread safety: Get may run at the same time as itself; everything else needs exclusive access.
#pragma once

#include <memory>

#include "absl/container/flat_hash_map.h"
#include "core/tree/corner_sample.h"

namespace linetree {

struct SampleKey {
  uint64_t grid = 0;  // GridKey of the corner
  int32_t object = 0;
  int32_t pair = 0;
  uint32_t forest = 0;

  bool operator==(const SampleKey&) const = default;
  template <class H>
  friend H AbslHashValue(H h, const SampleKey& k) {
    return H::combine(std::move(h), k.grid, k.object, k.pair, k.forest);
  }
};

class SampleStore {
 public:
  using Sample = std::shared_ptr<const CornerSample>;

  // Holds at most `limit_bytes`: what does not fit is not kept.
  explicit SampleStore(uint64_t limit_bytes) : limit_bytes_(limit_bytes) {}

  // Null when it is not there. Marks the sample as used.
  Sample Get(const SampleKey& key) const;
  void Put(const SampleKey& key, Sample sample);
  // Ends a round of building; when little room is left, makes some by dropping the samples that
  // were used longest ago.
  void EndRound();
  void DropForest(uint32_t forest);
  // Drops what does not fit any more, as EndRound does.
  void SetLimit(uint64_t limit_bytes);
  void Clear();

  uint64_t ByteSize() const { return sample_bytes_ + TableBytes(); }
  uint64_t CountBytes() const;

 private:
  struct Entry {
    Sample sample;
    mutable uint32_t used = 0;  // round of the last use
  };
  static uint64_t BytesOf(const Entry& entry);
  uint64_t TableBytes() const;
  uint64_t GrowthBytes() const;
  template <class F>
  void DropIf(F condition);

  absl::flat_hash_map<SampleKey, Entry> entries_;
  uint64_t limit_bytes_;
  uint64_t sample_bytes_ = 0;
  uint32_t round_ = 1;
};

}  // namespace linetree
