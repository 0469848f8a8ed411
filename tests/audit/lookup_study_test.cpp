#include "core/audit/lookup_study.h"

#include <gtest/gtest.h>

#include "core/audit/speed_scenes.h"

namespace linetree {
namespace {

TEST(LookupStudyTest, LooksUpWhatIsSeenByAllThreadsAndKinds) {
  WorkerPool pool(2);
  LookupStudyOptions options;
  options.width = options.height = 64;
  options.repeat = 2;
  options.passes = 1;
  options.threads = {1, 3};
  double share = 0;
  const auto study =
      StudyLookups(MakeSpheres(20, 2), options, pool, [&](double done) { share = done; });
  ASSERT_TRUE(study.ok()) << study.status();
  EXPECT_EQ(share, 1);
  EXPECT_GT(study->rays, 1000u);
  EXPECT_GT(study->known, study->rays / 2);
  EXPECT_GT(study->cells, 10u);
  ASSERT_EQ(study->rows.size(), 4u);
  EXPECT_EQ(study->rows[3].threads, 3);
  EXPECT_EQ(study->rows[3].kind, EpochKind::kSharedLock);
  for (const LookupRow& row : study->rows) EXPECT_GT(row.per_second.least, 0);
}

TEST(LookupStudyTest, SomethingHasToBeSeen) {
  WorkerPool pool(1);
  const auto study = StudyLookups(std::make_shared<Scene>(), {}, pool, [](double) {});
  EXPECT_TRUE(absl::IsInvalidArgument(study.status())) << study.status();
}

}  // namespace
}  // namespace linetree
