// When what readers may still look at can be destroyed: userspace RCU (liburcu, McKenney and
// Desnoyers), the flavour that costs readers no barrier.
//
// Readers say when they begin and when they end, and never wait for anybody. Who has taken
// something away from where readers find it waits for those who had begun before that, and destroys
// it then.
#pragma once

namespace linetree {

// A thread reads while it has one; they may be nested. Keep it short, a part of a frame: who takes
// things away waits for it. Must be destroyed by the thread that made it.
class EpochGuard {
 public:
  EpochGuard();
  ~EpochGuard();
  EpochGuard(const EpochGuard&) = delete;
  EpochGuard& operator=(const EpochGuard&) = delete;
};

// Returns when all guards that were there when it was called are gone. The calling thread must not
// have one.
void AwaitReaders();

// The plain twin: a lock that readers share. Only while nobody reads.
enum class EpochKind { kRcu, kSharedLock };
void SetEpochKind(EpochKind kind);

}  // namespace linetree
