// GreedyDual-Size-Frequency (Cherkasova: Improving WWW Proxies Performance with
// Greedy-Dual-Size-Frequency Caching Policy, HP Labs, 1998): an item's key is frequency x cost /
// bytes above the key of the last victim when it was used, so that what is no longer used ages.
#include "core/policy/make_policy.h"
#include "core/policy/victim_heap.h"

namespace linetree {
namespace {

class Gdsf : public EvictionPolicy {
 public:
  void Insert(const PolicyItem& item) override { Use(items_.Add(item)); }
  void Change(const PolicyItem& item) override { items_[items_.At(item.id)].item = item; }
  void Access(uint64_t id) override { Use(items_.At(id)); }
  void Remove(uint64_t id) override {
    const ItemSlot slot = items_.At(id);
    heap_.Take(slot);
    items_.Erase(slot);
  }
  void Evict(uint64_t id) override {
    if (!heap_.IsEmpty() && items_.At(id) == heap_.first()) age_ = heap_.first_key();
    Remove(id);
  }
  uint64_t PickVictim() override {
    if (heap_.IsEmpty()) heap_.Restore();
    return items_[heap_.first()].item.id;
  }
  // Whose key is far below all others would be the victim again and again.
  void Spare(uint64_t id) override { heap_.Hide(items_.At(id)); }
  void NextFrame() override { heap_.Restore(); }
  uint64_t ByteSize() const override { return items_.ByteSize() + heap_.ByteSize(); }

 private:
  void Use(ItemSlot slot) {
    ItemTable::Entry& entry = items_[slot];
    const double worth = entry.item.rebuild_ns / static_cast<double>(entry.item.bytes);
    heap_.Set(slot, age_ + ++entry.mark * worth);
  }

  ItemTable items_;
  VictimHeap heap_;
  double age_ = 0;
};

}  // namespace

std::unique_ptr<EvictionPolicy> MakeGdsf() { return std::make_unique<Gdsf>(); }

}  // namespace linetree
