#include "core/audit/sampling.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace linetree {
namespace {

std::vector<uint64_t> Picked(double share, uint64_t request, uint64_t count) {
  SampledIndices indices(share, request);
  std::vector<uint64_t> picked;
  for (uint64_t i = indices.Next(); i < count; i = indices.Next()) picked.push_back(i);
  return picked;
}

TEST(SamplingTest, NoneAndAll) {
  EXPECT_TRUE(Picked(0, 1, 1000).empty());
  EXPECT_EQ(Picked(1, 1, 1000).size(), 1000u);
}

TEST(SamplingTest, RequestsRepeatAndDiffer) {
  EXPECT_EQ(Picked(0.1, 7, 1000), Picked(0.1, 7, 1000));
  EXPECT_NE(Picked(0.1, 7, 1000), Picked(0.1, 8, 1000));
}

// Six standard deviations.
TEST(SamplingTest, EveryIndexIsPickedAsOften) {
  constexpr double kShare = 0.03;
  constexpr uint64_t kRequests = 20'000, kCount = 64;
  std::vector<double> times(kCount);
  double sum = 0;
  for (uint64_t request = 0; request < kRequests; ++request) {
    for (const uint64_t i : Picked(kShare, request, kCount)) {
      ++times[i];
      ++sum;
    }
  }
  const double deviation = std::sqrt(kRequests * kShare * (1 - kShare));
  for (const double n : times) EXPECT_NEAR(n, kRequests * kShare, 6 * deviation);
  EXPECT_NEAR(sum, kCount * kRequests * kShare, 6 * 8 * deviation);
}

TEST(SamplingTest, TinySharesEnd) {
  for (const double share : {1e-18, 1e-300, 5e-324}) {
    SampledIndices indices(share, 3);
    EXPECT_GT(indices.Next(), uint64_t{1} << 40);
  }
}

}  // namespace
}  // namespace linetree
