// ARC (Megiddo, Modha: ARC: A Self-Tuning, Low Overhead Replacement Cache, FAST 2003, figure 4), in
// bytes: LRU for what was used once and for what was used more often; what is evicted from either
// is remembered, and a miss on it moves the border between them.
#include <algorithm>

#include "core/policy/item_table.h"
#include "core/policy/make_policy.h"

namespace linetree {
namespace {

class Arc : public EvictionPolicy {
 public:
  void SetBudget(uint64_t bytes) override {
    EvictionPolicy::SetBudget(bytes);
    once_target_ = std::min(once_target_, static_cast<double>(bytes));
  }
  void Expect(const PolicyItem& item) override {
    const ItemSlot ghost = items_.Find(item.id);
    if (ghost == kNoItem) return;
    const bool was_once = once_ghosts_.Holds(ghost);
    const auto once = static_cast<double>(once_ghosts_.bytes());
    const auto often = static_cast<double>(often_ghosts_.bytes());
    const double step =
        std::max(1.0, was_once ? often / once : once / often) * static_cast<double>(item.bytes);
    once_target_ = std::clamp(once_target_ + (was_once ? step : -step), 0.0,
                              static_cast<double>(budget_bytes()));
    comes_from_often_ = !was_once;
    (was_once ? once_ghosts_ : often_ghosts_).Forget(ghost);
    expected_ = item.id;
    is_expecting_ = true;
  }
  void Insert(const PolicyItem& item) override {
    if (!is_expecting_ || expected_ != item.id) Expect(item);
    const bool known = is_expecting_ && expected_ == item.id;
    is_expecting_ = comes_from_often_ = false;
    (known ? often_ : once_).Push(items_.Add(item));
    // The first pair of lists holds a budget at most, all four two of them.
    const uint64_t budget = budget_bytes();
    once_ghosts_.Shrink(budget > once_.bytes() ? budget - once_.bytes() : 0);
    const uint64_t rest = once_.bytes() + once_ghosts_.bytes() + often_.bytes();
    often_ghosts_.Shrink(2 * budget > rest ? 2 * budget - rest : 0);
  }
  void Change(const PolicyItem& item) override {
    const ItemSlot slot = items_.At(item.id);
    QueueOf(slot).Change(slot, item);
  }
  void Access(uint64_t id) override {
    const ItemSlot slot = items_.At(id);
    QueueOf(slot).Take(slot);
    often_.Push(slot);
  }
  void Remove(uint64_t id) override {
    const ItemSlot slot = items_.At(id);
    QueueOf(slot).Forget(slot);
  }
  void Evict(uint64_t id) override {
    const ItemSlot slot = items_.At(id);
    const bool was_once = once_.Holds(slot);
    QueueOf(slot).Take(slot);
    (was_once ? once_ghosts_ : often_ghosts_).Push(slot);
  }
  uint64_t PickVictim() override {
    const auto bytes = static_cast<double>(once_.bytes());
    const bool from_once = bytes > once_target_ || (comes_from_often_ && bytes >= once_target_);
    const bool takes_once = !once_.IsEmpty() && (from_once || often_.IsEmpty());
    return items_[(takes_once ? once_ : often_).oldest()].item.id;
  }
  uint64_t ByteSize() const override { return items_.ByteSize(); }

 private:
  ItemQueue& QueueOf(ItemSlot slot) { return once_.Holds(slot) ? once_ : often_; }

  ItemTable items_;
  ItemQueue once_{items_, 1}, often_{items_, 2}, once_ghosts_{items_, 3}, often_ghosts_{items_, 4};
  double once_target_ = 0;  // bytes of once_
  // A ghost that is about to come in, and whether it was one of often_.
  uint64_t expected_ = 0;
  bool is_expecting_ = false, comes_from_often_ = false;
};

}  // namespace

std::unique_ptr<EvictionPolicy> MakeArc() { return std::make_unique<Arc>(); }

}  // namespace linetree
