// Items by a key that says who goes first.
#pragma once

#include <utility>
#include <vector>

#include "core/policy/item_table.h"

namespace linetree {

// A binary heap that knows where each item is. Of equal keys the one that was set first goes first.
class VictimHeap {
 public:
  bool IsEmpty() const { return heap_.empty(); }
  ItemSlot first() const { return heap_.front().slot; }
  double first_key() const { return heap_.front().key; }

  // Puts an item in, or gives it another key.
  void Set(ItemSlot slot, double key) {
    if (slot >= place_.size()) place_.resize(slot + size_t{1}, kNowhere);
    if (place_[slot] >= kHidden) {
      place_[slot] = heap_.size();
      heap_.push_back({});
    }
    heap_[place_[slot]] = {key, ++clock_, slot};
    Settle(place_[slot]);
  }
  void Take(ItemSlot slot) {
    const size_t at = std::exchange(place_[slot], kNowhere);
    if (at == kHidden) return;
    const Place last = heap_.back();
    heap_.pop_back();
    if (last.slot == slot) return;
    heap_[at] = last;
    place_[last.slot] = at;
    Settle(at);
  }
  // Takes an item out until Restore, as if it were in.
  void Hide(ItemSlot slot) {
    const double key = heap_[place_[slot]].key;
    Take(slot);
    place_[slot] = kHidden;
    hidden_.emplace_back(slot, key);
  }
  void Restore() {
    // Who was hidden twice, having been another item meanwhile, has the later key.
    for (; !hidden_.empty(); hidden_.pop_back()) {
      const auto [slot, key] = hidden_.back();
      if (place_[slot] == kHidden) Set(slot, key);
    }
  }
  uint64_t ByteSize() const {
    return heap_.capacity() * sizeof(Place) + place_.capacity() * sizeof(size_t) +
           hidden_.capacity() * sizeof(hidden_[0]);
  }

 private:
  struct Place {
    double key = 0;
    uint64_t when = 0;
    ItemSlot slot = kNoItem;
    bool operator<(const Place& o) const { return key < o.key || (key == o.key && when < o.when); }
  };
  static constexpr size_t kNowhere = ~size_t{0}, kHidden = kNowhere - 1;

  void Swap(size_t a, size_t b) {
    std::swap(heap_[a], heap_[b]);
    place_[heap_[a].slot] = a;
    place_[heap_[b].slot] = b;
  }
  // Up or down, where it belongs.
  void Settle(size_t at) {
    for (; at > 0 && heap_[at] < heap_[(at - 1) / 2]; at = (at - 1) / 2) Swap(at, (at - 1) / 2);
    while (true) {
      size_t least = at;
      for (size_t child = 2 * at + 1; child <= 2 * at + 2 && child < heap_.size(); ++child) {
        if (heap_[child] < heap_[least]) least = child;
      }
      if (least == at) return;
      Swap(at, least);
      at = least;
    }
  }

  std::vector<Place> heap_;
  std::vector<size_t> place_;  // by slot
  std::vector<std::pair<ItemSlot, double>> hidden_;
  uint64_t clock_ = 0;
};

}  // namespace linetree
