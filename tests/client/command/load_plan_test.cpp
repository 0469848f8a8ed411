#include "client/command/load_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

namespace linetree {
namespace {

constexpr double kNoEnd = std::numeric_limits<double>::infinity();
constexpr size_t kNoMost = std::numeric_limits<size_t>::max();

std::set<size_t> CamerasOf(const FlightPiece& piece) {
  std::set<size_t> cameras;
  for (size_t i = 0; i < piece.frames; ++i) cameras.insert(piece.first + i);
  return cameras;
}

size_t Shared(const FlightPiece& a, const FlightPiece& b) {
  size_t shared = 0;
  const std::set<size_t> others = CamerasOf(b);
  for (const size_t camera : CamerasOf(a)) shared += others.count(camera);
  return shared;
}

TEST(LoadPlan, WithoutOverlapEverybodyFliesAllFromEvenlySpreadStarts) {
  const auto pieces = PlanPieces(4, {30}, std::nullopt);
  ASSERT_EQ(pieces.size(), 4u);
  for (size_t c = 0; c < 4; ++c) {
    EXPECT_EQ(pieces[c].first, c * 30 / 4);
    EXPECT_EQ(pieces[c].frames, 30u);
  }
}

TEST(LoadPlan, PiecesCoverThePathAndShareWhatTheOverlapSays) {
  for (const size_t clients : {1u, 2u, 3u, 7u, 16u}) {
    for (const double overlap : {0.0, 0.25, 0.5, 0.9, 1.0}) {
      const auto pieces = PlanPieces(clients, {1000}, overlap);
      std::set<size_t> all;
      for (size_t c = 0; c < clients; ++c) {
        const std::set<size_t> own = CamerasOf(pieces[c]);
        all.insert(own.begin(), own.end());
        EXPECT_EQ(pieces[c].frames, pieces[0].frames);
        if (c == 0) continue;
        // Starts are whole cameras.
        EXPECT_NEAR(static_cast<double>(Shared(pieces[c - 1], pieces[c])),
                    overlap * static_cast<double>(pieces[c].frames), 2)
            << clients << " clients, overlap " << overlap;
      }
      EXPECT_EQ(all.size(), 1000u) << clients << " clients, overlap " << overlap;
      EXPECT_EQ(*all.rbegin(), 999u);
    }
  }
}

TEST(LoadPlan, MoreClientsThanCamerasStillHaveAFrameEach) {
  for (const FlightPiece& piece : PlanPieces(9, {4}, 0.0)) {
    EXPECT_EQ(piece.frames, 1u);
    EXPECT_LT(piece.first, 4u);
  }
}

TEST(LoadPlan, ClientsTakePathsInTurn) {
  const auto pieces = PlanPieces(5, {10, 20}, 1.0);
  const std::vector<size_t> paths = {0, 1, 0, 1, 0};
  for (size_t c = 0; c < pieces.size(); ++c) {
    EXPECT_EQ(pieces[c].path, paths[c]);
    EXPECT_EQ(pieces[c].frames, paths[c] == 0 ? 10u : 20u);
    EXPECT_EQ(pieces[c].first, 0u);
  }
}

TEST(LoadPlan, FixedArrivalsAreEquallySpacedAndBounded) {
  EXPECT_THAT(PlanArrivals({.rate = 4}, 3, kNoEnd), testing::ElementsAre(0, 0.25, 0.5));
  EXPECT_THAT(PlanArrivals({.rate = 4}, kNoMost, 0.5), testing::ElementsAre(0, 0.25));
  EXPECT_THAT(PlanArrivals({.rate = 4}, 0, 1), testing::IsEmpty());
}

TEST(LoadPlan, PoissonArrivalsHaveTheirRateAndItsVariance) {
  constexpr size_t kCount = 100'000;
  const ArrivalOptions options{.rate = 50, .kind = ArrivalKind::kPoisson, .seed = 7};
  const std::vector<double> times = PlanArrivals(options, kCount, kNoEnd);
  ASSERT_EQ(times.size(), kCount);
  double sum = 0, squares = 0;
  for (size_t i = 1; i < kCount; ++i) {
    const double step = 50 * (times[i] - times[i - 1]);
    ASSERT_GE(step, 0);
    sum += step;
    squares += step * step;
  }
  // Of exponential steps the mean is 1 and the mean square 2; five standard deviations of each.
  EXPECT_NEAR(sum / (kCount - 1), 1, 5 / std::sqrt(kCount));
  EXPECT_NEAR(squares / (kCount - 1), 2, 5 * std::sqrt(20) / std::sqrt(kCount));
  EXPECT_EQ(times, PlanArrivals(options, kCount, kNoEnd));
  EXPECT_NE(times,
            PlanArrivals({.rate = 50, .kind = ArrivalKind::kPoisson, .seed = 8}, kCount, kNoEnd));
}

}  // namespace
}  // namespace linetree
