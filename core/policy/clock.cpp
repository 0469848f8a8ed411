// CLOCK (Corbato, 1968), one bit: what was used since the hand came by gets another round.
#include "core/policy/make_policy.h"
#include "core/policy/queue_policy.h"

namespace linetree {
namespace {

class Clock : public QueuePolicy {
 public:
  void Access(uint64_t id) override { items_[items_.At(id)].mark = 1; }
  uint64_t PickVictim() override {
    while (items_[queue_.oldest()].mark != 0) {
      items_[queue_.oldest()].mark = 0;
      queue_.MakeNewest(queue_.oldest());
    }
    return QueuePolicy::PickVictim();
  }
};

}  // namespace

std::unique_ptr<EvictionPolicy> MakeClock() { return std::make_unique<Clock>(); }

}  // namespace linetree
