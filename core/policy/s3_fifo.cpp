// S3-FIFO (Yang, Zhang, Qiu, Yue, Rashmi: FIFO Queues are All You Need for Cache Eviction, SOSP
// 2023, algorithm 1): newcomers wait in a small FIFO of a tenth of the budget; who is used at least
// twice there goes on to the main one, the others are remembered as ghosts, as many as the main
// queue holds, and go straight to it when they come back. The main queue gives what was used, up
// to three times, another round.
#include <algorithm>

#include "core/policy/item_table.h"
#include "core/policy/make_policy.h"

namespace linetree {
namespace {

constexpr double kSmallShare = 0.1;
constexpr uint32_t kMaxUses = 3;
constexpr uint32_t kUsesToStay = 2;

class S3Fifo : public EvictionPolicy {
 public:
  void Insert(const PolicyItem& item) override {
    const ItemSlot ghost = items_.Find(item.id);
    if (ghost != kNoItem) ghosts_.Forget(ghost);
    (ghost == kNoItem ? small_ : main_).Push(items_.Add(item));
  }
  void Change(const PolicyItem& item) override {
    const ItemSlot slot = items_.At(item.id);
    (small_.Holds(slot) ? small_ : main_).Change(slot, item);
  }
  void Access(uint64_t id) override {
    uint32_t& uses = items_[items_.At(id)].mark;
    uses = std::min(uses + 1, kMaxUses);
  }
  void Remove(uint64_t id) override {
    const ItemSlot slot = items_.At(id);
    (small_.Holds(slot) ? small_ : main_).Forget(slot);
  }
  void Evict(uint64_t id) override {
    const ItemSlot slot = items_.At(id);
    if (main_.Holds(slot)) return main_.Forget(slot);
    small_.Take(slot);
    ghosts_.Push(slot);
    ghosts_.Shrink(budget_bytes() - ShareOfBudget(kSmallShare));
  }
  uint64_t PickVictim() override {
    const uint64_t main_bytes = budget_bytes() - ShareOfBudget(kSmallShare);
    while (main_.bytes() <= main_bytes && !small_.IsEmpty()) {
      const ItemSlot slot = small_.oldest();
      if (items_[slot].mark < kUsesToStay) return items_[slot].item.id;
      items_[slot].mark = 0;
      small_.Take(slot);
      main_.Push(slot);
    }
    return VictimOfMain();
  }
  uint64_t ByteSize() const override { return items_.ByteSize(); }

 private:
  uint64_t VictimOfMain() {
    while (items_[main_.oldest()].mark != 0) {
      --items_[main_.oldest()].mark;
      main_.MakeNewest(main_.oldest());
    }
    return items_[main_.oldest()].item.id;
  }

  ItemTable items_;
  ItemQueue small_{items_, 1}, main_{items_, 2}, ghosts_{items_, 3};
};

}  // namespace

std::unique_ptr<EvictionPolicy> MakeS3Fifo() { return std::make_unique<S3Fifo>(); }

}  // namespace linetree
