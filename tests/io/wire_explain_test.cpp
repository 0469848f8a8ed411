#include "core/io/wire_explain.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "tests/support/demo_scenes.h"

namespace linetree {
namespace {

using ::testing::HasSubstr;

// Object i has 10 i points, but the last one none.
SceneHost::Explanation ExplanationOf(size_t objects) {
  SceneHost::Explanation explanation;
  explanation.features = {{"lights", 2, "searched"}, {"diffuse sums", std::nullopt, "used"}};
  explanation.decisions = 3;
  for (size_t i = 0; i < objects; ++i) {
    ObjectPlan plan;
    plan.object = i;
    plan.asked = i % 2 == 1;
    plan.tree_work = 4;
    plan.classical_work = 9;
    plan.reason = plan.asked ? PlanReason::kPays : PlanReason::kTooSmall;
    plan.points = i + 1 == objects ? 0 : static_cast<uint32_t>(10 * i);
    plan.trees = {.cells = i, .bytes = 100 * i};
    explanation.objects.push_back(plan);
  }
  return explanation;
}

TEST(WireExplain, ListsTheObjectsWithTheMostPointsAndCountsAll) {
  const auto scene = test::BallsOnFloor(5, 3);
  const v1::ExplainReply reply = ExplanationToWire(*scene, ExplanationOf(5), 2);
  ASSERT_EQ(reply.features_size(), 2);
  EXPECT_EQ(reply.features(0).count(), 2u);
  EXPECT_FALSE(reply.features(1).has_count());
  EXPECT_EQ(reply.decisions(), 3u);
  EXPECT_EQ(reply.objects_asked(), 2u);
  EXPECT_EQ(reply.objects_skipped(), 3u);
  ASSERT_EQ(reply.reasons_size(), 2);
  EXPECT_EQ(reply.reasons(0).reason(), v1::PLAN_REASON_PAYS);
  EXPECT_EQ(reply.reasons(0).objects(), 2u);
  EXPECT_EQ(reply.reasons(1).objects(), 3u);
  ASSERT_EQ(reply.objects_size(), 2);
  const auto& first = reply.objects(0);
  EXPECT_EQ(first.object(), 3u);
  EXPECT_EQ(first.name(), scene->objects[3].name);
  EXPECT_TRUE(first.asked());
  EXPECT_EQ(first.reason(), v1::PLAN_REASON_PAYS);
  EXPECT_EQ(first.points(), 30u);
  EXPECT_EQ(first.tree_work(), 4);
  EXPECT_EQ(first.classical_work(), 9);
  EXPECT_EQ(first.cells(), 3u);
  EXPECT_EQ(first.bytes(), 300u);
  EXPECT_EQ(reply.objects(1).object(), 2u);
  EXPECT_EQ(ExplanationToWire(*scene, ExplanationOf(5), 9).objects_size(), 5);
}

TEST(WireExplain, EveryReasonHasItsWords) {
  std::set<std::string_view> words;
  for (int reason = v1::PlanReason_MIN; reason <= v1::PlanReason_MAX; ++reason) {
    words.insert(WordsFor(static_cast<v1::PlanReason>(reason)));
  }
  EXPECT_EQ(words.size(), static_cast<size_t>(v1::PlanReason_ARRAYSIZE));
  EXPECT_EQ(words.count(""), 0u);
  EXPECT_EQ(WordsFor(static_cast<v1::PlanReason>(999)), WordsFor(v1::PLAN_REASON_UNSEEN));
}

TEST(WireExplain, RequestsAreChecked) {
  const SceneHost host(test::BallsOnFloor(5, 3));
  v1::ExplainRequest request;
  const auto usual = ExplainToWire(request, 0.1, host);
  ASSERT_TRUE(usual.ok()) << usual.status();
  EXPECT_EQ(usual->objects_size(), static_cast<int>(host.scene().objects.size()));
  EXPECT_EQ(usual->objects(0).reason(), v1::PLAN_REASON_UNSEEN);
  for (const double error : {-0.1, 1.1, std::numeric_limits<double>::quiet_NaN()}) {
    request.set_max_relative_error(error);
    EXPECT_THAT(ExplainToWire(request, 0.1, host).status().message(),
                HasSubstr("max_relative_error: expected a number in [0, 1]"));
  }
  request.set_max_relative_error(0);
  for (const uint32_t objects : {0u, kMostExplained + 1}) {
    request.set_max_objects(objects);
    EXPECT_THAT(ExplainToWire(request, 0.1, host).status().message(),
                HasSubstr("max_objects: expected a number in [1, 10000]"));
  }
}

}  // namespace
}  // namespace linetree
