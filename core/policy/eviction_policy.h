// Which of the items that a cache holds should make room. A policy knows nothing of what items are:
// whoever owns them tells it what comes, is used and goes, and asks it for victims.
//
// Time is counted in frames: an item that a frame uses is told to the policy once, however often
// the frame has looked it up, and NextFrame ends the frame.
//
// Thread safety: none; the owner has a lock.
#pragma once

#include <cstdint>

namespace linetree {

struct PolicyItem {
  uint64_t id = 0;
  uint64_t bytes = 1;    // more than 0
  float rebuild_ns = 1;  // what building it anew costs, more than 0
};

class EvictionPolicy {
 public:
  virtual ~EvictionPolicy() = default;
  EvictionPolicy(const EvictionPolicy&) = delete;
  EvictionPolicy& operator=(const EvictionPolicy&) = delete;

  // Bytes that the owner may hold, by which policies of several queues divide them. It is the owner
  // who sees to it that they are kept.
  virtual void SetBudget(uint64_t budget_bytes) { budget_bytes_ = budget_bytes; }

  // An item has been missed: the victims that are picked up to its Insert make room for it. Owners
  // who make room later need not say so.
  virtual void Expect(const PolicyItem& /*item*/) {}
  // An item has come that was not held.
  virtual void Insert(const PolicyItem& item) = 0;
  // A held item has other bytes or costs than before.
  virtual void Change(const PolicyItem& item) = 0;
  // A held item has been used.
  virtual void Access(uint64_t id) = 0;
  // A held item has gone, though not by the policy's choice: nothing is remembered of it.
  virtual void Remove(uint64_t id) = 0;

  // The item to evict. It stays the same until something else is called. At least one must be held.
  virtual uint64_t PickVictim() = 0;
  // A held item, as a rule the victim, has been evicted: it may come back.
  virtual void Evict(uint64_t id) = 0;
  // The victim stays after all, being in use: another one's turn comes, of the same queue where a
  // policy has several.
  virtual void Spare(uint64_t id) { Access(id); }

  // Ends a frame.
  virtual void NextFrame() {}
  // The owner expects that a held item is used again in so many frames, from what it knows of where
  // viewpoints are heading; it says so anew when the item has been used or the guess is no longer
  // good. Infinity: not at all.
  virtual void ExpectUse(uint64_t /*id*/, double /*frames*/) {}
  // The owner says so of all items that are used within so many frames: what it does not speak of
  // is used later, if at all. 0, as in the beginning: of some.
  virtual void SetForesight(double /*frames*/) {}

  // Of what the policy remembers, beside itself.
  virtual uint64_t ByteSize() const = 0;

 protected:
  EvictionPolicy() = default;
  uint64_t budget_bytes() const { return budget_bytes_; }
  uint64_t ShareOfBudget(double share) const {
    return static_cast<uint64_t>(share * static_cast<double>(budget_bytes_));
  }

 private:
  uint64_t budget_bytes_ = 0;
};

}  // namespace linetree
