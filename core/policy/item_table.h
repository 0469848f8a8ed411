// Items by id, and queues of them: what policies are made of.
#pragma once

#include <vector>

#include "absl/container/flat_hash_map.h"
#include "core/math/check.h"
#include "core/policy/eviction_policy.h"

namespace linetree {

using ItemSlot = uint32_t;
inline constexpr ItemSlot kNoItem = ~ItemSlot{0};

// Held items and, where a policy remembers them, evicted ones. Slots are used again.
class ItemTable {
 public:
  struct Entry {
    PolicyItem item;
    uint32_t mark = 0;   // the policy's affair
    uint32_t queue = 0;  // number of the queue that it is in; 0: none
    ItemSlot newer = kNoItem, older = kNoItem;
  };

  // kNoItem where there is none.
  ItemSlot Find(uint64_t id) const {
    const auto found = slots_.find(id);
    return found == slots_.end() ? kNoItem : found->second;
  }
  ItemSlot At(uint64_t id) const {
    const ItemSlot slot = Find(id);
    LT_CHECK(slot != kNoItem);
    return slot;
  }
  ItemSlot Add(const PolicyItem& item) {
    ItemSlot slot = static_cast<ItemSlot>(entries_.size());
    if (free_.empty()) {
      entries_.emplace_back();
    } else {
      slot = free_.back();
      free_.pop_back();
      entries_[slot] = {};
    }
    entries_[slot].item = item;
    LT_CHECK(slots_.emplace(item.id, slot).second);
    return slot;
  }
  void Erase(ItemSlot slot) {
    slots_.erase(entries_[slot].item.id);
    free_.push_back(slot);
  }
  Entry& operator[](ItemSlot slot) { return entries_[slot]; }
  const Entry& operator[](ItemSlot slot) const { return entries_[slot]; }
  size_t size() const { return slots_.size(); }
  uint64_t ByteSize() const {
    return entries_.capacity() * sizeof(Entry) + free_.capacity() * sizeof(ItemSlot) +
           slots_.capacity() * (sizeof(std::pair<uint64_t, ItemSlot>) + 1);
  }
  // visit(ItemSlot), for those that are in a queue.
  template <class Fn>
  void ForEach(Fn&& visit) const {
    for (ItemSlot slot = 0; slot < entries_.size(); ++slot) {
      if (entries_[slot].queue != 0) visit(slot);
    }
  }

 private:
  std::vector<Entry> entries_;
  std::vector<ItemSlot> free_;
  absl::flat_hash_map<uint64_t, ItemSlot> slots_;
};

// Some of a table's items in a line, from the newest to the oldest. An item is in one queue at a
// time.
class ItemQueue {
 public:
  // `number`, from 1 on, tells the queues of a table apart.
  ItemQueue(ItemTable& table, uint32_t number) : table_(table), number_(number) {}

  void Push(ItemSlot slot) {
    ItemTable::Entry& entry = table_[slot];
    entry.queue = number_;
    entry.newer = kNoItem;
    entry.older = newest_;
    (newest_ == kNoItem ? oldest_ : table_[newest_].newer) = slot;
    newest_ = slot;
    bytes_ += entry.item.bytes;
  }
  void Take(ItemSlot slot) {
    ItemTable::Entry& entry = table_[slot];
    LT_CHECK(entry.queue == number_);
    (entry.newer == kNoItem ? newest_ : table_[entry.newer].older) = entry.older;
    (entry.older == kNoItem ? oldest_ : table_[entry.older].newer) = entry.newer;
    entry.queue = 0;
    bytes_ -= entry.item.bytes;
  }
  void MakeNewest(ItemSlot slot) {
    Take(slot);
    Push(slot);
  }
  void Change(ItemSlot slot, const PolicyItem& item) {
    bytes_ += item.bytes - table_[slot].item.bytes;
    table_[slot].item = item;
  }
  // Forgets the oldest items until at most so many bytes are left.
  void Shrink(uint64_t bytes) {
    while (bytes_ > bytes) Forget(oldest_);
  }
  void Forget(ItemSlot slot) {
    Take(slot);
    table_.Erase(slot);
  }

  bool Holds(ItemSlot slot) const { return slot != kNoItem && table_[slot].queue == number_; }
  bool IsEmpty() const { return oldest_ == kNoItem; }
  ItemSlot oldest() const { return oldest_; }
  uint64_t bytes() const { return bytes_; }

 private:
  ItemTable& table_;
  const uint32_t number_;
  ItemSlot newest_ = kNoItem, oldest_ = kNoItem;
  uint64_t bytes_ = 0;
};

}  // namespace linetree
