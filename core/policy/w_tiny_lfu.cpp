// W-TinyLFU (Einziger, Friedman, Manes: TinyLFU: A Highly Efficient Cache Admission Policy, ACM
// Transactions on Storage, 2017): newcomers pass a window with LRU; who leaves it gets into the
// main part, a segmented LRU with four fifths protected, only in the place of one that was seen
// less often of late.
//
// The window is a hundredth of the budget as published, but at least what a frame uses, up to half
// the budget: a frame's items come all at once, and a smaller window would hold none of them until
// the next frame.
#include <algorithm>

#include "core/policy/frequency_sketch.h"
#include "core/policy/item_table.h"
#include "core/policy/make_policy.h"

namespace linetree {
namespace {

constexpr double kLeastWindow = 0.01;
constexpr double kMostWindow = 0.5;
constexpr double kProtectedShare = 0.8;

class WTinyLfu : public EvictionPolicy {
 public:
  void Expect(const PolicyItem& item) override { expected_bytes_ = item.bytes; }
  void Insert(const PolicyItem& item) override {
    expected_bytes_ = 0;
    const ItemSlot slot = items_.Add(item);
    window_.Push(slot);
    sketch_.MakeRoom(items_.size());
    See(slot);
  }
  void Change(const PolicyItem& item) override {
    const ItemSlot slot = items_.At(item.id);
    QueueOf(slot).Change(slot, item);
  }
  void Access(uint64_t id) override {
    const ItemSlot slot = items_.At(id);
    See(slot);
    if (!probation_.Holds(slot)) return QueueOf(slot).MakeNewest(slot);
    probation_.Take(slot);
    protected_.Push(slot);
    const double most = kProtectedShare * static_cast<double>(budget_bytes() - WindowBytes());
    while (static_cast<double>(protected_.bytes()) > most) {
      const ItemSlot oldest = protected_.oldest();
      protected_.Take(oldest);
      probation_.Push(oldest);
    }
  }
  void Remove(uint64_t id) override {
    const ItemSlot slot = items_.At(id);
    QueueOf(slot).Forget(slot);
  }
  void Evict(uint64_t id) override { Remove(id); }
  uint64_t PickVictim() override {
    const uint64_t window_bytes = WindowBytes();
    const uint64_t main_bytes = budget_bytes() - window_bytes;
    while (window_.bytes() + expected_bytes_ > window_bytes && !window_.IsEmpty()) {
      const ItemSlot candidate = window_.oldest();
      const uint64_t needed = items_[candidate].item.bytes;
      if (probation_.bytes() + protected_.bytes() + needed > main_bytes) {
        const ItemSlot victim = OldestOfMain();
        const bool admit = victim != kNoItem && Seen(candidate) > Seen(victim);
        return items_[admit ? victim : candidate].item.id;
      }
      window_.Take(candidate);
      probation_.Push(candidate);
    }
    const ItemSlot victim = OldestOfMain();
    return items_[victim == kNoItem ? window_.oldest() : victim].item.id;
  }
  void NextFrame() override { last_frame_bytes_ = std::exchange(frame_bytes_, 0); }
  uint64_t ByteSize() const override { return items_.ByteSize() + sketch_.ByteSize(); }

 private:
  ItemQueue& QueueOf(ItemSlot slot) {
    return window_.Holds(slot) ? window_ : probation_.Holds(slot) ? probation_ : protected_;
  }
  void See(ItemSlot slot) {
    sketch_.Add(items_[slot].item.id);
    frame_bytes_ += items_[slot].item.bytes;
  }
  int Seen(ItemSlot slot) const { return sketch_.Count(items_[slot].item.id); }
  ItemSlot OldestOfMain() const {
    return probation_.IsEmpty() ? protected_.oldest() : probation_.oldest();
  }
  uint64_t WindowBytes() const {
    return std::clamp(last_frame_bytes_, ShareOfBudget(kLeastWindow), ShareOfBudget(kMostWindow));
  }

  ItemTable items_;
  ItemQueue window_{items_, 1}, probation_{items_, 2}, protected_{items_, 3};
  FrequencySketch sketch_;
  uint64_t expected_bytes_ = 0;
  uint64_t frame_bytes_ = 0, last_frame_bytes_ = 0;  // used in this and in the last one
};

}  // namespace

std::unique_ptr<EvictionPolicy> MakeWTinyLfu() { return std::make_unique<WTinyLfu>(); }

}  // namespace linetree
