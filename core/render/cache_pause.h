// When a cache is too small to pay: frames then do without it, and try it again now and then.
//
// What is certified has to be kept until somebody uses it. A cache that has room for little of what
// its frames ask for, and knows little of what they see, costs each of them what building and
// looking up take, for nothing: a cache without memory is the better one.
//
// Thread safety: every method may be called from any thread.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>

namespace linetree {

// A request that has been answered with the cache.
struct CacheYield {
  uint64_t rays = 0;
  uint64_t known = 0;   // of which the cache knew something
  uint64_t tried = 0;   // cells that were certified or asked for,
  uint64_t unkept = 0;  // and those of them that found no room
};

class CachePause {
 public:
  // Caches of fewer bytes are left alone: they would hold some dozens of cells.
  static constexpr uint64_t kLeastBytes = uint64_t{64} << 10;
  // So few rays say nothing about others.
  static constexpr uint64_t kLeastRays = 1024;
  // A look-up costs about a sixteenth of what a ray does, and what is known of a ray saves half of
  // that at least: from this share of the rays on the cache pays.
  static constexpr double kLeastKnown = 1.0 / 8;
  // Of the cells, so many find no room where a cache is too small.
  static constexpr double kMostUnkept = 1.0 / 2;
  // Requests without the cache: at first, and at most, when it is tried again and again in vain.
  // That costs up to a third of a request each time.
  static constexpr uint32_t kFirstPause = 15, kLongestPause = 255;

  // Whether the next request is to do without the cache.
  bool Take() {
    if (is_tiny_) return true;
    uint32_t left = left_;
    while (left > 0 && !left_.compare_exchange_weak(left, left - 1)) {
    }
    return left > 0;
  }
  void Note(const CacheYield& yield) {
    if (yield.rays < kLeastRays) return;
    const bool has_room =
        static_cast<double>(yield.unkept) <= kMostUnkept * static_cast<double>(yield.tried);
    const bool pays =
        static_cast<double>(yield.known) >= kLeastKnown * static_cast<double>(yield.rays);
    if (has_room || pays) {
      next_ = kFirstPause;
      return;
    }
    const uint32_t pause = next_;
    left_ = pause;
    next_ = std::min(2 * pause + 1, kLongestPause);
  }
  // The cache has become another one, of so many bytes.
  void Reset(uint64_t memory_bytes) {
    is_tiny_ = memory_bytes < kLeastBytes;
    left_ = 0;
    next_ = kFirstPause;
  }

 private:
  std::atomic<bool> is_tiny_{false};
  std::atomic<uint32_t> left_{0}, next_{kFirstPause};
};

}  // namespace linetree
