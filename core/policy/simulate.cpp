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
  bool Holds(uint64_t id) const { return held_.contains(id); }
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

// Says what is used within a number of frames, when that comes to be so.
class Foresight {
 public:
  Foresight(const Trace& trace, uint32_t frames) : trace_(trace), frames_(frames) {
    if (frames == 0) return;
    frame_.reserve(trace.size());
    for (size_t i = 0; i < trace.size(); ++i) {
      if (i == 0 || trace[i].time != trace[i - 1].time) begins_.push_back(i);
      frame_.push_back(static_cast<uint32_t>(begins_.size() - 1));
    }
    begins_.push_back(trace.size());
    before_.assign(trace.size(), kNeverAgain);
    for (size_t i = 0; i < trace.size(); ++i) {
      const int64_t next = trace[i].next;
      if (next != kNeverAgain) before_[static_cast<size_t>(next)] = static_cast<int64_t>(i);
    }
  }

  // The frame of event `i`, its first, begins: what the last one of those ahead uses is within
  // reach.
  void BeginFrame(size_t i, const Replay& replay, EvictionPolicy& policy) const {
    if (frames_ == 0) return;
    const size_t last = frame_[i] + size_t{frames_};
    if (last + 1 >= begins_.size()) return;
    for (size_t k = begins_[last]; k < begins_[last + 1]; ++k) {
      // Who is used before that has been spoken of.
      const bool is_next = before_[k] == kNeverAgain || static_cast<size_t>(before_[k]) < i;
      if (is_next && replay.Holds(trace_[k].id)) policy.ExpectUse(trace_[k].id, frames_);
    }
  }
  // Event `i` has been replayed.
  void AfterUse(size_t i, const Replay& replay, EvictionPolicy& policy) const {
    if (frames_ == 0 || trace_[i].next == kNeverAgain || !replay.Holds(trace_[i].id)) return;
    const uint32_t gap = frame_[static_cast<size_t>(trace_[i].next)] - frame_[i];
    if (gap <= frames_) policy.ExpectUse(trace_[i].id, gap);
  }

 private:
  const Trace& trace_;
  const uint32_t frames_;
  std::vector<uint32_t> frame_;  // number of each event's
  std::vector<size_t> begins_;   // each frame's first event, and the end
  std::vector<int64_t> before_;  // the last event with the same id
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
  policy->SetForesight(options.foresight_frames);
  Replay replay(*policy, options);
  const Foresight foresight(trace, options.foresight_frames);
  for (size_t i = 0; i < trace.size(); ++i) {
    const bool begins = i == 0 || trace[i].time != trace[i - 1].time;
    if (begins && i > 0) policy->NextFrame();
    if (begins) foresight.BeginFrame(i, replay, *policy);
    next = trace[i].next;
    replay.Use(trace[i]);
    foresight.AfterUse(i, replay, *policy);
  }
  return replay.result();
}

}  // namespace linetree
