#include "core/frame/plan_explanation.h"

#include <gtest/gtest.h>

#include "tests/support/demo_scenes.h"

namespace linetree {
namespace {

// Of one packet in cells that are all known.
PacketWork Work(uint32_t asked, uint32_t classical) { return {16, asked, classical, asked, true}; }

TEST(PlanExplanationTest, SaysWhatThePlannerDoesAndWhy) {
  FramePlan plan(6);
  plan.Book(0, Work(160, 800));
  plan.Book(1, Work(320, 160));
  plan.Book(2, Work(160, 800));
  plan.Book(3, Work(150, 160));  // less than kLeastSaving
  plan.Book(5, {16, 200, 1000, 1100, false});
  plan.Decide();
  plan.Skip(2);
  const std::vector<TreeSize> trees = {{7, 700}, {}, {}, {}, {}, {}};
  const std::vector<ObjectPlan> objects = ExplainPlan(plan, trees);
  ASSERT_EQ(objects.size(), 6u);
  const PlanReason reasons[] = {PlanReason::kPays,     PlanReason::kCostsMore,
                                PlanReason::kTooSmall, PlanReason::kCostsMore,
                                PlanReason::kUnseen,   PlanReason::kGrowing};
  for (size_t i = 0; i < objects.size(); ++i) {
    EXPECT_EQ(objects[i].object, i);
    EXPECT_EQ(objects[i].reason, reasons[i]) << i;
    EXPECT_EQ(objects[i].asked, plan.Pays(i)) << i;
  }
  EXPECT_TRUE(objects[0].asked);
  EXPECT_FALSE(objects[1].asked);
  EXPECT_FALSE(objects[2].asked);
  EXPECT_DOUBLE_EQ(objects[0].tree_work, 10);
  EXPECT_DOUBLE_EQ(objects[0].classical_work, 50);
  EXPECT_EQ(objects[0].points, 8u);  // half of what was booked before the decision
  EXPECT_EQ(objects[0].trees.cells, 7u);
  EXPECT_EQ(objects[0].trees.bytes, 700u);
  EXPECT_EQ(objects[4].points, 0u);
}

TEST(PlanExplanationTest, ASkipWithoutAnyPointsIsForLackOfPoints) {
  FramePlan plan(1);
  plan.Skip(0);
  EXPECT_EQ(ExplainPlan(plan, std::vector<TreeSize>(1))[0].reason, PlanReason::kTooSmall);
}

TEST(PlanExplanationTest, AlwaysIsAReasonOfItsOwn) {
  FramePlan plan(1, /*always=*/true);
  plan.Book(0, Work(1000, 1));
  plan.Decide();
  const ObjectPlan object = ExplainPlan(plan, std::vector<TreeSize>(1))[0];
  EXPECT_TRUE(object.asked);
  EXPECT_EQ(object.reason, PlanReason::kAlways);
}

const FeatureNote& NoteOf(const std::vector<FeatureNote>& notes, const std::string& feature) {
  for (const FeatureNote& note : notes) {
    if (note.feature == feature) return note;
  }
  ADD_FAILURE() << feature;
  return notes.front();
}

TEST(PlanExplanationTest, FeaturesAreTheScenes) {
  const auto scene = test::BallsOnFloor(6, 90);
  Scene changed = *scene;
  for (Material& material : changed.materials) {
    material.reflect = material.transmit = material.specular = {};
  }
  changed.materials[static_cast<size_t>(changed.objects[1].material)].transmit = {1, 1, 1};
  size_t transmitting = 0;
  for (const Object& object : changed.objects) {
    transmitting += object.material == changed.objects[1].material ? 1 : 0;
  }
  const Tracer tracer(changed);
  const auto notes = ExplainFeatures(PacketScene(tracer), 0.01);
  EXPECT_EQ(NoteOf(notes, "all objects").count, changed.objects.size());
  EXPECT_EQ(NoteOf(notes, "lights").count, changed.lights.size());
  EXPECT_EQ(NoteOf(notes, "reflecting").count, 0u);
  EXPECT_EQ(NoteOf(notes, "glossy").count, 0u);
  EXPECT_EQ(NoteOf(notes, "transmitting").count, transmitting);
  const auto strict = ExplainFeatures(PacketScene(tracer), -1e-6);
  EXPECT_NE(NoteOf(notes, "diffuse sums").what_frames_do,
            NoteOf(strict, "diffuse sums").what_frames_do);
}

}  // namespace
}  // namespace linetree
