// Policies that give each item a key when it is used, and evict the least.
#pragma once

#include "core/policy/eviction_policy.h"
#include "core/policy/victim_heap.h"

namespace linetree {

class HeapPolicy : public EvictionPolicy {
 public:
  void Insert(const PolicyItem& item) override { Use(items_.Add(item)); }
  void Change(const PolicyItem& item) override { items_[items_.At(item.id)].item = item; }
  void Access(uint64_t id) override { Use(items_.At(id)); }
  void Remove(uint64_t id) override {
    const ItemSlot slot = items_.At(id);
    heap_.Take(slot);
    items_.Erase(slot);
  }
  void Evict(uint64_t id) override { Remove(id); }
  uint64_t PickVictim() override {
    if (heap_.IsEmpty()) heap_.Restore();
    return items_[heap_.first()].item.id;
  }
  // Whose key is far below all others would be the victim again and again.
  void Spare(uint64_t id) override { heap_.Hide(items_.At(id)); }
  void NextFrame() override { heap_.Restore(); }
  uint64_t ByteSize() const override { return items_.ByteSize() + heap_.ByteSize(); }

 protected:
  // Of an item that is being used; its mark is the policy's own.
  virtual double KeyOf(ItemTable::Entry& entry) = 0;

  const VictimHeap& heap() const { return heap_; }
  bool IsFirst(uint64_t id) const { return !heap_.IsEmpty() && items_.At(id) == heap_.first(); }

 private:
  void Use(ItemSlot slot) { heap_.Set(slot, KeyOf(items_[slot])); }

  ItemTable items_;
  VictimHeap heap_;
};

}  // namespace linetree
