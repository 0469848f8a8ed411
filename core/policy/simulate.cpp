#include "core/policy/simulate.h"

#include <limits>
#include <memory>

#include "absl/container/flat_hash_map.h"
#include "core/policy/heap_policy.h"
#include "core/policy/policies.h"

namespace linetree {
namespace {

// Of equals, which are never used again, the one goes that has been so for longest.
class Belady : public HeapPolicy {
 public:
  // `next`: of the event that is being replayed.
  explicit Belady(const int64_t& next) : next_(next) {}

 private:
  double KeyOf(ItemTable::Entry&) override {
    return next_ == kNeverAgain ? -std::numeric_limits<double>::infinity()
                                : -static_cast<double>(next_);
  }

  const int64_t& next_;
};

class Replay {
 public:
  Replay(EvictionPolicy& policy, const SimulationOptions& options)
      : policy_(policy), options_(options) {}

  void Use(const TraceEvent& event) {
    ++result_.requests;
    result_.requested_bytes += event.bytes;
    if (held_.contains(event.id)) {
      ++result_.hits;
      result_.hit_bytes += event.bytes;
      policy_.Access(event.id);
      return;
    }
    result_.rebuild_ns += event.rebuild_ns;
    const PolicyItem item{event.id, options_.ignores_size ? 1 : event.bytes, event.rebuild_ns};
    if (item.bytes > options_.budget_bytes) return;
    policy_.Expect(item);
    while (bytes_ + item.bytes > options_.budget_bytes) Evict();
    policy_.Insert(item);
    held_.emplace(item.id, item.bytes);
    bytes_ += item.bytes;
  }
  const SimulationResult& result() const { return result_; }

 private:
  void Evict() {
    const uint64_t victim = policy_.PickVictim();
    const auto found = held_.find(victim);
    LT_CHECK(found != held_.end());
    bytes_ -= found->second;
    held_.erase(found);
    policy_.Evict(victim);
    ++result_.evictions;
  }

  EvictionPolicy& policy_;
  const SimulationOptions options_;
  SimulationResult result_;
  absl::flat_hash_map<uint64_t, uint64_t> held_;  // bytes by id
  uint64_t bytes_ = 0;
};

}  // namespace

absl::StatusOr<SimulationResult> Simulate(const Trace& trace, std::string_view name,
                                          const SimulationOptions& options) {
  int64_t next = kNeverAgain;
  std::unique_ptr<EvictionPolicy> policy;
  if (name == kBelady) {
    policy = std::make_unique<Belady>(next);
  } else {
    auto made = MakePolicy(name, options.budget_bytes);
    if (!made.ok()) return made.status();
    policy = *std::move(made);
  }
  Replay replay(*policy, options);
  for (size_t i = 0; i < trace.size(); ++i) {
    if (i > 0 && trace[i].time != trace[i - 1].time) policy->NextFrame();
    next = trace[i].next;
    replay.Use(trace[i]);
  }
  return replay.result();
}

}  // namespace linetree
