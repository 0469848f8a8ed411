// Least recently used.
#include "core/policy/make_policy.h"
#include "core/policy/queue_policy.h"

namespace linetree {
namespace {

class Lru : public QueuePolicy {
 public:
  void Access(uint64_t id) override { queue_.MakeNewest(items_.At(id)); }
};

}  // namespace

std::unique_ptr<EvictionPolicy> MakeLru() { return std::make_unique<Lru>(); }

}  // namespace linetree
