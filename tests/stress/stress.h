// What all stress tests share: the seed, how long to run, and how results are printed.
//
//   LINETREE_STRESS_SEED  the seed, a number; kDefaultSeed when not set
//   LINETREE_STRESS_LONG  set and not "0": the long form, some twenty times as much
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>

#include "tests/support/random.h"

namespace linetree::stress {

inline constexpr uint64_t kDefaultSeed = 20261122;

// Printed by the first caller.
uint64_t Seed();
bool IsLong();

// The address sanitizer takes some ten times as long.
#ifdef __SANITIZE_ADDRESS__
inline constexpr int kShare = 8;
#else
inline constexpr int kShare = 1;
#endif

// How often to do something; at least once.
inline int Times(int in_short_form) {
  return std::max(1, (IsLong() ? 20 * in_short_form : in_short_form) / kShare);
}

// An independent stream of random numbers for a test of that name.
test::Random RandomFor(const std::string& name);

// The largest error that one test saw beside the bound that is claimed for it. Prints one line when
// it goes out of scope.
class Largest {
 public:
  // `unit` says what the bound is a multiple of.
  Largest(std::string name, double bound, std::string unit = "");
  ~Largest();
  Largest(const Largest&) = delete;
  Largest& operator=(const Largest&) = delete;

  // Returns whether the error is within the bound; false for NaN. Not thread-safe.
  bool Add(double error);

  double error() const { return error_; }
  uint64_t count() const { return count_; }

 private:
  std::string name_;
  double bound_;
  std::string unit_;
  double error_ = 0;
  uint64_t count_ = 0;
};

}  // namespace linetree::stress
