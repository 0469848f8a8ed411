// Runs something on every instruction set that jets are compiled for and this machine has.
#pragma once

#include <cstdint>

#include "core/jet/simd_targets.h"
#include "hwy/highway.h"

namespace linetree::test {

// fn(name of the target). Returns how many there were. Not while other threads use SIMD.
template <class Fn>
int ForEveryTarget(Fn&& fn) {
  int count = 0;
  for (int64_t left = hwy::SupportedTargets() & HWY_TARGETS; left != 0; left &= left - 1) {
    const int64_t target = left & -left;
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    fn(hwy::TargetName(target));
    ++count;
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  return count;
}

}  // namespace linetree::test
