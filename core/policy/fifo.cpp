// First in, first out.
#include "core/policy/make_policy.h"
#include "core/policy/queue_policy.h"

namespace linetree {
namespace {

class Fifo : public QueuePolicy {
 public:
  void Access(uint64_t /*id*/) override {}
  void Spare(uint64_t id) override { queue_.MakeNewest(items_.At(id)); }
};

}  // namespace

std::unique_ptr<EvictionPolicy> MakeFifo() { return std::make_unique<Fifo>(); }

}  // namespace linetree
