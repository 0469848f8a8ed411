// A policy of one queue, whose victim is the oldest item: the common part of FIFO, LRU and CLOCK.
#pragma once

#include "core/policy/item_table.h"

namespace linetree {

class QueuePolicy : public EvictionPolicy {
 public:
  void Insert(const PolicyItem& item) override { queue_.Push(items_.Add(item)); }
  void Change(const PolicyItem& item) override { queue_.Change(items_.At(item.id), item); }
  void Remove(uint64_t id) override { queue_.Forget(items_.At(id)); }
  void Evict(uint64_t id) override { Remove(id); }
  uint64_t PickVictim() override { return items_[queue_.oldest()].item.id; }
  uint64_t ByteSize() const override { return items_.ByteSize(); }

 protected:
  ItemTable items_;
  ItemQueue queue_{items_, 1};
};

}  // namespace linetree
