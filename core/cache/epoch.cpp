#include "core/cache/epoch.h"

#include <urcu/urcu-memb.h>

#include <atomic>
#include <shared_mutex>

#include "core/math/check.h"

// The thread sanitizer does not see into liburcu: that who waits comes after those who have ended
// is said to it here.
#ifdef __SANITIZE_THREAD__
extern "C" void __tsan_acquire(void*);
extern "C" void __tsan_release(void*);
#endif

namespace linetree {
namespace {

// Known to liburcu while the thread lives.
struct Thread {
  Thread() { urcu_memb_register_thread(); }
  ~Thread() { urcu_memb_unregister_thread(); }
  int guards = 0;
};
thread_local Thread thread;

std::atomic<EpochKind> kind{EpochKind::kRcu};
std::shared_mutex plain_mutex;
#ifdef __SANITIZE_THREAD__
char ended;
#endif

}  // namespace

EpochGuard::EpochGuard() {
  if (thread.guards++ > 0) return;
  if (kind.load(std::memory_order_relaxed) == EpochKind::kRcu) {
    urcu_memb_read_lock();
  } else {
    plain_mutex.lock_shared();
  }
}

EpochGuard::~EpochGuard() {
  if (--thread.guards > 0) return;
  if (kind.load(std::memory_order_relaxed) == EpochKind::kRcu) {
#ifdef __SANITIZE_THREAD__
    __tsan_release(&ended);
#endif
    urcu_memb_read_unlock();
  } else {
    plain_mutex.unlock_shared();
  }
}

void AwaitReaders() {
  LT_CHECK(thread.guards == 0);
  if (kind.load(std::memory_order_relaxed) == EpochKind::kRcu) {
    urcu_memb_synchronize_rcu();
#ifdef __SANITIZE_THREAD__
    __tsan_acquire(&ended);
#endif
  } else {
    plain_mutex.lock();
    plain_mutex.unlock();
  }
}

void SetEpochKind(EpochKind to) { kind = to; }

}  // namespace linetree
