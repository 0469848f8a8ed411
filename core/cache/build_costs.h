// What building cells has cost so far, by object.
#pragma once

#include <algorithm>
#include <chrono>
#include <mutex>
#include <vector>

namespace linetree {

// Nanoseconds of a scope, put into `ns` at its end.
class BuildTimer {
 public:
  explicit BuildTimer(float& ns) : ns_(ns) {}
  ~BuildTimer() {
    const std::chrono::duration<float, std::nano> took = std::chrono::steady_clock::now() - begin_;
    ns_ = took.count();
  }
  BuildTimer(const BuildTimer&) = delete;
  BuildTimer& operator=(const BuildTimer&) = delete;

 private:
  const std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  float& ns_;
};

// Thread safety: every method may be called from any thread.
class BuildCosts {
 public:
  explicit BuildCosts(size_t objects) : of_(objects) {}

  void Add(size_t object, float ns) {
    const std::lock_guard lock(mutex_);
    of_[object].Add(ns);
    all_.Add(ns);
  }
  // Of a cell, on average; of all objects' cells where the object has none.
  float NsPerCell(size_t object) const {
    const std::lock_guard lock(mutex_);
    const Mean& mean = of_[object].cells > 0 ? of_[object] : all_;
    return std::max(1.0f, mean.ns);
  }
  uint64_t ByteSize() const { return of_.capacity() * sizeof(Mean); }

 private:
  // The mean of so many cells; later ones count for more than the first.
  struct Mean {
    static constexpr float kMostCells = 256;
    float ns = 0;
    float cells = 0;
    void Add(float value) {
      cells = std::min(cells + 1, kMostCells);
      ns += (value - ns) / cells;
    }
  };

  mutable std::mutex mutex_;
  // Guarded by mutex_, but for the number of objects:
  std::vector<Mean> of_;
  Mean all_;
};

}  // namespace linetree
