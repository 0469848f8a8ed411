// A pool of equal-sized records with 32-bit handles. Records never move; freed ones are used again
// before new memory is taken, so the memory held is the largest that was ever in use at once,
// rounded up to a slab.
//
// Thread safety: none; operator[] may run at the same time as itself.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/math/check.h"

namespace linetree {

template <class T>
class SlabPool {
 public:
  static constexpr uint32_t kSlabRecords = 1024;

  // Handle of a value-initialised record; never 0.
  uint32_t Allocate() {
    ++in_use_;
    if (!free_.empty()) {
      const uint32_t handle = free_.back();
      free_.pop_back();
      (*this)[handle] = T{};
      return handle;
    }
    if (next_ % kSlabRecords == 0) slabs_.push_back(std::make_unique<T[]>(kSlabRecords));
    return ++next_;
  }
  void Free(uint32_t handle) {
    LT_CHECK(handle != 0 && handle <= next_);
    free_.push_back(handle);
    --in_use_;
  }
  T& operator[](uint32_t handle) const {
    return slabs_[(handle - 1) / kSlabRecords][(handle - 1) % kSlabRecords];
  }
  uint64_t in_use() const { return in_use_; }

 private:
  std::vector<std::unique_ptr<T[]>> slabs_;
  std::vector<uint32_t> free_;
  uint32_t next_ = 0;
  uint64_t in_use_ = 0;
};

}  // namespace linetree
