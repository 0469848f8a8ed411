#include "core/policy/policies.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/policy/make_policy.h"

namespace linetree {
namespace {

struct Known {
  PolicyNote note;
  std::unique_ptr<EvictionPolicy> (*make)();
};

constexpr Known kKnown[] = {
    {{"fifo", "what came first goes first"}, MakeFifo},
    {{"lru", "least recently used"}, MakeLru},
    {{"clock", "FIFO with a second chance for what was used"}, MakeClock},
    {{"lfu", "least frequently used while it was held"}, MakeLfu},
    {{"2q", "a queue for newcomers, LRU for what comes back"}, MakeTwoQueue},
    {{"arc", "recency and frequency, balanced by what was evicted too soon"}, MakeArc},
    {{"s3-fifo", "three FIFOs: small, main and ghost"}, MakeS3Fifo},
    {{"sieve", "a hand that passes over what was used"}, MakeSieve},
    {{"w-tinylfu", "a sketch of frequencies decides who passes a window"}, MakeWTinyLfu},
    {{"gdsf", "GreedyDual-Size-Frequency: frequency x cost / bytes, ageing"}, MakeGdsf},
    {{"reuse", "predicted reuse x rebuild cost / bytes"}, MakeReuse},
};

}  // namespace

const std::vector<PolicyNote>& AllPolicies() {
  static const auto* const notes = [] {
    auto* all = new std::vector<PolicyNote>;
    for (const Known& known : kKnown) all->push_back(known.note);
    return all;
  }();
  return *notes;
}

std::string PolicyNames() {
  return absl::StrJoin(AllPolicies(), ", ",
                       [](std::string* out, const PolicyNote& note) { out->append(note.name); });
}

absl::StatusOr<std::unique_ptr<EvictionPolicy>> MakePolicy(std::string_view name,
                                                           uint64_t budget_bytes) {
  for (const Known& known : kKnown) {
    if (known.note.name != name) continue;
    std::unique_ptr<EvictionPolicy> policy = known.make();
    policy->SetBudget(budget_bytes);
    return policy;
  }
  return absl::InvalidArgumentError(
      absl::StrCat("unknown policy '", std::string(name), "', expected one of ", PolicyNames()));
}

}  // namespace linetree
