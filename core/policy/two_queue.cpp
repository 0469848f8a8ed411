// 2Q, full version (Johnson, Shasha: 2Q: A Low Overhead High Performance Buffer Management
// Replacement Algorithm, VLDB 1994): newcomers pass a FIFO of a quarter of the budget and are then
// remembered, half a budget of them; who comes back from there is kept by LRU.
#include "core/policy/item_table.h"
#include "core/policy/make_policy.h"

namespace linetree {
namespace {

constexpr double kInShare = 0.25;
constexpr double kOutShare = 0.5;

class TwoQueue : public EvictionPolicy {
 public:
  void Insert(const PolicyItem& item) override {
    const ItemSlot out = items_.Find(item.id);
    if (out != kNoItem) out_.Forget(out);
    (out == kNoItem ? in_ : main_).Push(items_.Add(item));
  }
  void Change(const PolicyItem& item) override {
    QueueOf(item.id).Change(items_.At(item.id), item);
  }
  void Access(uint64_t id) override {
    const ItemSlot slot = items_.At(id);
    if (main_.Holds(slot)) main_.MakeNewest(slot);
  }
  void Spare(uint64_t id) override { QueueOf(id).MakeNewest(items_.At(id)); }
  void Remove(uint64_t id) override { QueueOf(id).Forget(items_.At(id)); }
  void Evict(uint64_t id) override {
    const ItemSlot slot = items_.At(id);
    if (main_.Holds(slot)) return main_.Forget(slot);
    in_.Take(slot);
    out_.Push(slot);
    out_.Shrink(ShareOfBudget(kOutShare));
  }
  uint64_t PickVictim() override {
    const bool from_in = in_.bytes() > ShareOfBudget(kInShare) || main_.IsEmpty();
    return items_[(from_in ? in_ : main_).oldest()].item.id;
  }
  uint64_t ByteSize() const override { return items_.ByteSize(); }

 private:
  ItemQueue& QueueOf(uint64_t id) { return main_.Holds(items_.At(id)) ? main_ : in_; }

  ItemTable items_;
  ItemQueue in_{items_, 1}, main_{items_, 2}, out_{items_, 3};
};

}  // namespace

std::unique_ptr<EvictionPolicy> MakeTwoQueue() { return std::make_unique<TwoQueue>(); }

}  // namespace linetree
