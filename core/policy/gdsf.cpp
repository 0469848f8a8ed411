// GreedyDual-Size-Frequency (Cherkasova: Improving WWW Proxies Performance with
// Greedy-Dual-Size-Frequency Caching Policy, HP Labs, 1998): an item's key is frequency x cost /
// bytes above the key of the last victim when it was used, so that what is no longer used ages.
#include "core/policy/heap_policy.h"
#include "core/policy/make_policy.h"

namespace linetree {
namespace {

class Gdsf : public HeapPolicy {
 public:
  void Evict(uint64_t id) override {
    if (IsFirst(id)) age_ = heap().first_key();
    Remove(id);
  }

 private:
  double KeyOf(ItemTable::Entry& entry) override {
    const double worth = entry.item.rebuild_ns / static_cast<double>(entry.item.bytes);
    return age_ + ++entry.mark * worth;
  }

  double age_ = 0;
};

}  // namespace

std::unique_ptr<EvictionPolicy> MakeGdsf() { return std::make_unique<Gdsf>(); }

}  // namespace linetree
