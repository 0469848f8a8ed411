// Looks for the worst case by climbing.
#pragma once

#include <algorithm>
#include <cmath>

#include "tests/support/random.h"

namespace linetree::test {

// Changes numbers of a case, `x`, at random, relative to their size, and keeps what makes
// error(case) larger; steps grow where that succeeds and shrink to `least_step` where it does not.
// Returns the largest error.
template <class Case, class Error>
double Climb(Case best, int tries, double least_step, Random& random, const Error& error) {
  double most = error(best);
  double step = 1;
  for (int i = 0; i < tries; ++i) {
    Case next = best;
    for (double& x : next.x) {
      if (random.Below(2) == 0) x += step * random.Uniform(-1, 1) * (0.1 + std::abs(x));
    }
    const double found = error(next);
    step = std::clamp(found > most ? 1.5 * step : 0.97 * step, least_step, 1.0);
    if (found <= most) continue;
    most = found;
    best = next;
  }
  return most;
}

}  // namespace linetree::test
