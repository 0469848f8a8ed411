// A queue of a fixed number of places for several producers and one consumer, none of whom ever
// waits for another: a producer is never held up by a consumer that has lost the processor.
//
// Each place carries a ticket (Vyukov's bounded queue): place p is free for the push number n with
// n % places == p when its ticket is n, and holds an entry when its ticket is n + 1.
// Thread safety: TryPush from any thread, TryPop from one.
#pragma once

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace linetree {

template <class T>
class BoundedQueue {
 public:
  // Room for `places` entries at least: the next power of two, and two or more. With a single place
  // "holds an entry" and "free for the next push" would be the same ticket.
  explicit BoundedQueue(size_t places) : places_(std::bit_ceil(std::max<size_t>(places, 2))) {
    for (size_t i = 0; i < places_.size(); ++i) places_[i].ticket = i;
  }

  // False when it is full; then the entry is left as it was.
  bool TryPush(T& entry) {
    uint64_t number = pushed_.load(std::memory_order_relaxed);
    for (;;) {
      Place& place = PlaceOf(number);
      const uint64_t ticket = place.ticket.load(std::memory_order_acquire);
      if (ticket == number) {
        if (!pushed_.compare_exchange_weak(number, number + 1, std::memory_order_relaxed)) continue;
        place.entry = std::move(entry);
        place.ticket.store(number + 1, std::memory_order_release);
        return true;
      }
      if (ticket < number) return false;  // still holds the entry of the last round
      number = pushed_.load(std::memory_order_relaxed);
    }
  }

  // Nothing when it is empty, or when its oldest entry is still being written.
  std::optional<T> TryPop() {
    Place& place = PlaceOf(popped_);
    if (place.ticket.load(std::memory_order_acquire) != popped_ + 1) return std::nullopt;
    std::optional<T> entry = std::exchange(place.entry, std::nullopt);
    place.ticket.store(popped_ + places_.size(), std::memory_order_release);
    ++popped_;
    return entry;
  }

 private:
  struct Place {
    std::atomic<uint64_t> ticket{0};
    std::optional<T> entry;
  };

  Place& PlaceOf(uint64_t number) { return places_[number & (places_.size() - 1)]; }

  std::vector<Place> places_;
  std::atomic<uint64_t> pushed_{0};
  uint64_t popped_ = 0;  // the consumer's
};

}  // namespace linetree
