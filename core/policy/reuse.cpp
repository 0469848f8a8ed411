// Our own: evicts the item with the least predicted reuse x rebuild cost / bytes.
//
// Reuse is predicted from when items were used before, in frames (reuse_times.h), and evicted items
// are remembered so that the ones that were missed count as well. What the owner expects of an item
// (ExpectUse) stands in the place of that.
#include <algorithm>
#include <bit>
#include <functional>
#include <utility>
#include <vector>

#include "core/policy/item_table.h"
#include "core/policy/make_policy.h"
#include "core/policy/reuse_times.h"

namespace linetree {
namespace {

// Evicted items that are remembered, in budgets.
constexpr uint64_t kGhostBudgets = 1;
// Victims are chosen many at a time, this share of all items, and anew after so many calls.
constexpr size_t kBatchShare = 32;
constexpr size_t kLeastBatch = 16;
// It is learnt when so many of the items, held or remembered, have been used again.
constexpr size_t kLearnShare = 2;
// An item's class: for how long it was away the last time, an octave each, and how often it has
// been used since.
constexpr size_t kAwayClasses = 10;
constexpr size_t kRunClasses = 4;
constexpr size_t kClasses = kAwayClasses * kRunClasses;

class Reuse : public EvictionPolicy {
 public:
  void Insert(const PolicyItem& item) override {
    ++calls_;
    const ItemSlot ghost = items_.Find(item.id);
    if (ghost != kNoItem) {
      Use(ghost);
      ghosts_.Take(ghost);
      items_[ghost].item = item;
      held_.Push(ghost);
      return Offer(ghost);
    }
    const ItemSlot slot = items_.Add(item);
    if (slot >= pasts_.size()) pasts_.resize(slot + size_t{1});
    pasts_[slot] = {.used = now_};
    held_.Push(slot);
    Offer(slot);
  }
  void Change(const PolicyItem& item) override { held_.Change(items_.At(item.id), item); }
  void Access(uint64_t id) override {
    ++calls_;
    const ItemSlot slot = items_.At(id);
    Use(slot);
    Offer(slot);
  }
  void Remove(uint64_t id) override { held_.Forget(items_.At(id)); }
  void Evict(uint64_t id) override {
    const ItemSlot slot = items_.At(id);
    held_.Take(slot);
    ghosts_.Push(slot);
    ghosts_.Shrink(kGhostBudgets * budget_bytes());
  }
  void Spare(uint64_t id) override {
    const ItemSlot slot = items_.At(id);
    // Once all are spared they are gone round.
    if (std::exchange(pasts_[slot].spared, now_) == now_) held_.MakeNewest(slot);
  }
  uint64_t PickVictim() override {
    if (all_spared_ == now_) return items_[held_.oldest()].item.id;
    const bool is_old = batch_frame_ != now_ && calls_ * kBatchShare > items_.size();
    if (is_old || !SkipToGood()) {
      ChooseBatch();
      if (!SkipToGood()) {
        all_spared_ = now_;
        return items_[held_.oldest()].item.id;
      }
    }
    const bool takes_recent = !recent_.empty() && recent_.front().worth < batch_[next_].worth;
    return takes_recent ? recent_.front().id : batch_[next_].id;
  }
  void NextFrame() override { ++now_; }
  void ExpectUse(uint64_t id, double frames) override {
    const ItemSlot slot = items_.At(id);
    pasts_[slot].expected = static_cast<float>(now_ + frames);
    Offer(slot);  // the batch has what it was worth before
  }
  void SetForesight(double frames) override { foresight_ = frames; }
  uint64_t ByteSize() const override {
    return items_.ByteSize() + pasts_.capacity() * sizeof(Past) +
           (batch_.capacity() + recent_.capacity()) * sizeof(Candidate) + times_.ByteSize();
  }

 private:
  struct Past {
    uint32_t used = 0;    // frame of the last use
    uint32_t spared = 0;  // frame in which it was
    uint32_t away = 0;    // its last absence in frames; 0: none yet
    uint32_t run = 0;     // uses since then
    float expected = -1;  // frame of the next use, if the owner has said so
  };
  struct Candidate {
    uint64_t id;
    ItemSlot slot;
    uint32_t used;
    float expected;
    double worth;
    bool operator<(const Candidate& o) const { return worth < o.worth; }
    bool operator>(const Candidate& o) const { return worth > o.worth; }
  };

  static size_t ClassOf(const Past& past) {
    const auto away = static_cast<size_t>(std::bit_width(past.away));
    const auto run = static_cast<size_t>(std::bit_width(past.run));
    return std::min(away, kAwayClasses - 1) * kRunClasses + std::min(run, kRunClasses - 1);
  }
  void Use(ItemSlot slot) {
    Past& past = pasts_[slot];
    const uint32_t gap = now_ - past.used;
    past.expected = -1;
    if (gap == 0) return;
    times_.Ended(ClassOf(past), gap);
    ++uses_;
    past.used = now_;
    if (gap <= 2 * times_.usual_gap()) {
      ++past.run;
    } else {
      past.away = gap;
      past.run = 0;
    }
  }
  double UsesPerFrame(const Past& past) const {
    const double now = now_;
    if (past.expected >= now) return 1.0 / std::max(1.0, static_cast<double>(past.expected) - now);
    const double usual = times_.UsesPerFrame(ClassOf(past), now_ - past.used);
    return foresight_ > 0 ? std::min(usual, 1.0 / (foresight_ + 1)) : usual;
  }
  double Worth(ItemSlot slot) const {
    const Past& past = pasts_[slot];
    const PolicyItem& item = items_[slot].item;
    return UsesPerFrame(past) * item.rebuild_ns / static_cast<double>(item.bytes);
  }
  bool IsGood(const Candidate& candidate) const {
    const ItemSlot slot = items_.Find(candidate.id);
    return slot == candidate.slot && held_.Holds(slot) && pasts_[slot].used == candidate.used &&
           pasts_[slot].expected == candidate.expected && !IsSpared(slot);
  }
  // Past candidates that have changed since they became some; false when the batch is used up.
  bool SkipToGood() {
    while (next_ < batch_.size() && !IsGood(batch_[next_])) ++next_;
    while (!recent_.empty() && !IsGood(recent_.front())) {
      std::pop_heap(recent_.begin(), recent_.end(), std::greater<>());
      recent_.pop_back();
    }
    return next_ < batch_.size();
  }
  // What has just been used may be worth less than what is in the batch.
  void Offer(ItemSlot slot) {
    if (!IsSpared(slot)) all_spared_ = 0;
    if (next_ == batch_.size()) return;
    recent_.push_back(CandidateOf(slot));
    std::push_heap(recent_.begin(), recent_.end(), std::greater<>());
    if (recent_.size() > items_.size() / 4 + kLeastBatch) DropBatch();
  }
  void DropBatch() {
    batch_.clear();
    recent_.clear();
    next_ = 0;
  }
  Candidate CandidateOf(ItemSlot slot) const {
    const Past& past = pasts_[slot];
    return {items_[slot].item.id, slot, past.used, past.expected, Worth(slot)};
  }
  bool IsSpared(ItemSlot slot) const { return pasts_[slot].spared == now_; }

  void Learn() {
    times_.Begin(items_.size());
    items_.ForEach(
        [&](ItemSlot slot) { times_.Open(ClassOf(pasts_[slot]), now_ - pasts_[slot].used); });
    times_.Learn();
    uses_ = 0;
    has_learnt_ = true;
  }
  void ChooseBatch() {
    if (!has_learnt_ || uses_ * kLearnShare >= items_.size()) Learn();
    DropBatch();
    items_.ForEach([&](ItemSlot slot) {
      if (!held_.Holds(slot) || IsSpared(slot)) return;
      batch_.push_back(CandidateOf(slot));
    });
    const size_t wanted = std::min(batch_.size(), batch_.size() / kBatchShare + kLeastBatch);
    const auto end = batch_.begin() + static_cast<std::ptrdiff_t>(wanted);
    std::partial_sort(batch_.begin(), end, batch_.end());
    batch_.erase(end, batch_.end());
    batch_frame_ = now_;
    calls_ = 0;
  }

  ItemTable items_;
  ItemQueue held_{items_, 1}, ghosts_{items_, 2};
  std::vector<Past> pasts_;  // by slot
  ReuseTimes times_{kClasses};
  uint32_t now_ = 1;
  double foresight_ = 0;
  std::vector<Candidate> batch_;  // those to go first, from next_ on
  size_t next_ = 0;
  std::vector<Candidate> recent_;  // a heap of what was used since, the first to go on top
  uint32_t batch_frame_ = 0;
  uint32_t all_spared_ = 0;  // the frame in which every item has been
  size_t calls_ = 0;         // since the batch was chosen
  size_t uses_ = 0;          // since it was learnt from them
  bool has_learnt_ = false;
};

}  // namespace

std::unique_ptr<EvictionPolicy> MakeReuse() { return std::make_unique<Reuse>(); }

}  // namespace linetree
