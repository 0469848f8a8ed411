// SIEVE (Zhang, Yang, Yue, Vigfusson, Rashmi: SIEVE is Simpler than LRU, NSDI 2024, algorithm 1): a
// hand goes from the oldest item to the newest and evicts the first that was not used since it last
// came by; items stay where they are. On streams of whole frames, nearly all of which was used, it
// evicts what has just come.
#include "core/policy/item_table.h"
#include "core/policy/make_policy.h"

namespace linetree {
namespace {

class Sieve : public EvictionPolicy {
 public:
  void Insert(const PolicyItem& item) override { queue_.Push(items_.Add(item)); }
  void Change(const PolicyItem& item) override { queue_.Change(items_.At(item.id), item); }
  void Access(uint64_t id) override { items_[items_.At(id)].mark = 1; }
  void Remove(uint64_t id) override {
    const ItemSlot slot = items_.At(id);
    if (slot == hand_) hand_ = items_[slot].newer;
    queue_.Forget(slot);
  }
  void Evict(uint64_t id) override { Remove(id); }
  uint64_t PickVictim() override {
    if (hand_ == kNoItem) hand_ = queue_.oldest();
    while (items_[hand_].mark != 0) {
      items_[hand_].mark = 0;
      hand_ = items_[hand_].newer;
      if (hand_ == kNoItem) hand_ = queue_.oldest();
    }
    return items_[hand_].item.id;
  }
  uint64_t ByteSize() const override { return items_.ByteSize(); }

 private:
  ItemTable items_;
  ItemQueue queue_{items_, 1};
  ItemSlot hand_ = kNoItem;  // the next to be looked at; none: the oldest
};

}  // namespace

std::unique_ptr<EvictionPolicy> MakeSieve() { return std::make_unique<Sieve>(); }

}  // namespace linetree
