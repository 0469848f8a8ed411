#include "core/audit/budget_study.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/audit/flight_corpus.h"
#include "tests/support/demo_scenes.h"

namespace linetree {
namespace {

TEST(BudgetStudy, ComparesFramesOfASmallCacheWithNone) {
  const auto scene = test::BallsOnFloor(5, 3);
  WorkerPool pool(1);
  BudgetStudyOptions options{.share = 0.25, .frames = {}};
  options.frames.width = options.frames.height = 64;
  options.frames.repeats = 2;
  for (const Lanes lanes : {Lanes::kScalar, Lanes::kSimd}) {
    options.frames.lanes = lanes;
    const auto views = FlightViews(*scene, scene->cameras[0], FlightPattern::kOrbit, 6);
    double done = 0;
    const auto study = StudyBudget(scene, views, options, pool, [&](double share) {
      EXPECT_GE(share, done);
      done = share;
    });
    ASSERT_TRUE(study.ok()) << study.status();
    EXPECT_DOUBLE_EQ(done, 1);
    EXPECT_GT(study->working_set_bytes, 0u);
    EXPECT_EQ(study->memory_bytes, study->working_set_bytes / 4);
    uint64_t held = 0;
    for (const MemoryPart& part : study->speed.memory) held += part.has_cells ? part.bytes : 0;
    EXPECT_LE(held, study->memory_bytes) << "the small cache is measured, not the large one";
    EXPECT_EQ(study->speed.turns.size(), 6u);
    EXPECT_EQ(study->speed.pixels, 2u * 6u * 64u * 64u);
    EXPECT_EQ(study->speed.beyond, 0u);
    EXPECT_LE(study->least_ratio, study->median_ratio);
    EXPECT_GT(study->average_ratio, 0);  // of sums: one slow frame may take it below the least
  }
}

}  // namespace
}  // namespace linetree
