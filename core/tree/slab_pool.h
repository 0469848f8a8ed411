// A pool of equal-sized records with 32-bit handles. Records never move; freed ones are used again
// before new memory is taken, so the memory held is the largest that was ever in use at once,
// rounded up to a slab.
//
// Thread safety: everything may run at any time. operator[], for handles that are in use, waits for
// nobody; a lock guards the lists of records for as long as one is taken from them or put back.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "core/math/check.h"

namespace linetree {

template <class T>
class SlabPool {
 public:
  static constexpr uint32_t kSlabRecords = 1024;

  // Handle of a value-initialised record; never 0.
  uint32_t Allocate() {
    const std::lock_guard lock(mutex_);
    ++in_use_;
    if (!free_.empty()) {
      const uint32_t handle = free_.back();
      free_.pop_back();
      (*this)[handle] = T{};
      return handle;
    }
    if (next_ % kSlabRecords == 0) AddSlab();
    return ++next_;
  }
  void Free(uint32_t handle) {
    const std::lock_guard lock(mutex_);
    LT_CHECK(handle != 0 && handle <= next_);
    free_.push_back(handle);
    --in_use_;
  }
  T& operator[](uint32_t handle) const {
    T** slabs = index_.load(std::memory_order_acquire);
    return slabs[(handle - 1) / kSlabRecords][(handle - 1) % kSlabRecords];
  }
  uint64_t in_use() const { return in_use_; }

 private:
  // Who reads may still look at a former index, which therefore stays; each is twice as long as the
  // one before.
  void AddSlab() {
    slabs_.push_back(std::make_unique<T[]>(kSlabRecords));
    if (indices_.empty() || slabs_.size() > index_slots_) {
      index_slots_ = std::max<size_t>(16, 2 * index_slots_);
      indices_.push_back(std::make_unique<T*[]>(index_slots_));
      for (size_t i = 0; i + 1 < slabs_.size(); ++i) indices_.back()[i] = slabs_[i].get();
    }
    indices_.back()[slabs_.size() - 1] = slabs_.back().get();
    index_.store(indices_.back().get(), std::memory_order_release);
  }

  std::mutex mutex_;
  // Guarded by mutex_:
  std::vector<std::unique_ptr<T[]>> slabs_;
  std::vector<std::unique_ptr<T*[]>> indices_;
  size_t index_slots_ = 0;
  std::vector<uint32_t> free_;
  uint32_t next_ = 0;
  // Changed with it only:
  std::atomic<T**> index_{nullptr};  // the last of indices_
  std::atomic<uint64_t> in_use_{0};
};

}  // namespace linetree
