#include "core/audit/edit_study.h"

#include <gtest/gtest.h>

#include "core/audit/speed_scenes.h"

namespace linetree {
namespace {

TEST(EditStudyTest, MovedSpheresLeaveMostOfTheCacheAndNoWrongPixel) {
  WorkerPool pool(2);
  EditStudyOptions options;
  options.width = options.height = 96;
  options.edits = 5;
  options.warm_frames = 3;
  const auto study = StudyEdits(MakeSpheres(60, 2), options, pool, nullptr);
  ASSERT_TRUE(study.ok()) << study.status();
  EXPECT_EQ(study->objects, 60u);
  EXPECT_GT(study->cells, 50u);
  EXPECT_EQ(study->beyond, 0u);
  EXPECT_EQ(study->pixels, 5u * 96 * 96);
  EXPECT_GT(study->dropped_share.most, 0);
  EXPECT_LT(study->dropped_share.median, 0.9);
}

TEST(EditStudyTest, SomethingHasToMove) {
  WorkerPool pool(1);
  const Scene empty;
  const auto study = StudyEdits(std::make_shared<Scene>(empty), {}, pool, nullptr);
  EXPECT_TRUE(absl::IsInvalidArgument(study.status())) << study.status();
}

}  // namespace
}  // namespace linetree
