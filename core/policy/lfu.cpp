// Least frequently used since it came in; of equals the one that was used longest ago.
#include "core/policy/heap_policy.h"
#include "core/policy/make_policy.h"

namespace linetree {
namespace {

class Lfu : public HeapPolicy {
  double KeyOf(ItemTable::Entry& entry) override { return ++entry.mark; }
};

}  // namespace

std::unique_ptr<EvictionPolicy> MakeLfu() { return std::make_unique<Lfu>(); }

}  // namespace linetree
