// Least frequently used since it came in; of equals the one that was used longest ago.
#include "core/policy/make_policy.h"
#include "core/policy/victim_heap.h"

namespace linetree {
namespace {

class Lfu : public EvictionPolicy {
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

 private:
  void Use(ItemSlot slot) { heap_.Set(slot, ++items_[slot].mark); }

  ItemTable items_;
  VictimHeap heap_;
};

}  // namespace

std::unique_ptr<EvictionPolicy> MakeLfu() { return std::make_unique<Lfu>(); }

}  // namespace linetree
