#include "server/flight_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "server/call_info.h"
#include "server/resume_token.h"

namespace linetree {
namespace {

using testing::StartsWith;

v1::FlyRequest Viewpoint(uint64_t sequence, v1::Pacing pacing, uint32_t divisor = 0) {
  v1::FlyRequest request;
  request.set_sequence(sequence);
  request.set_pacing(pacing);
  request.mutable_frame()->set_width(100);
  request.mutable_frame()->set_height(50);
  request.mutable_frame()->mutable_options()->set_max_relative_error(0.01);
  if (divisor > 0) request.mutable_while_moving()->set_divisor(divisor);
  return request;
}

FlightPlan::Step NextOf(FlightPlan& plan) {
  EXPECT_TRUE(plan.HasNext());
  const auto step = plan.Next();
  EXPECT_TRUE(step.ok()) << step.status();
  return *step;
}

TEST(FlightPlanTest, EveryViewpointHasItsTurnUnlessTheClientWantsTheNewest) {
  for (const v1::Pacing pacing : {v1::PACING_UNSPECIFIED, v1::PACING_EVERY}) {
    FlightPlan plan(3);
    for (uint64_t i = 0; i < 3; ++i) {
      EXPECT_TRUE(plan.WantsMore());
      plan.Add(Viewpoint(i, pacing));
    }
    EXPECT_FALSE(plan.WantsMore());
    for (uint64_t i = 0; i < 3; ++i) {
      const auto step = NextOf(plan);
      EXPECT_EQ(step.viewpoint.sequence(), i);
      EXPECT_EQ(step.skipped, 0u);
      EXPECT_FALSE(step.reduced || step.refines);
    }
    EXPECT_FALSE(plan.HasNext());
  }
}

TEST(FlightPlanTest, OnlyTheNewestWaitsAndTheOthersAreCounted) {
  FlightPlan plan(3);
  for (uint64_t i = 0; i < 10; ++i) {
    EXPECT_TRUE(plan.WantsMore());
    plan.Add(Viewpoint(i, v1::PACING_NEWEST));
  }
  auto step = NextOf(plan);
  EXPECT_EQ(step.viewpoint.sequence(), 9u);
  EXPECT_EQ(step.skipped, 9u);
  EXPECT_FALSE(plan.HasNext());
  plan.Add(Viewpoint(10, v1::PACING_UNSPECIFIED));  // the first request said it for all
  plan.Add(Viewpoint(11, v1::PACING_EVERY));
  step = NextOf(plan);
  EXPECT_EQ(step.viewpoint.sequence(), 11u);
  EXPECT_EQ(step.skipped, 1u);
}

TEST(FlightPlanTest, AReducedFrameIsRefinedAtRest) {
  FlightPlan plan(3);
  v1::FlyRequest request = Viewpoint(7, v1::PACING_NEWEST, 3);
  request.mutable_while_moving()->set_max_relative_error(0.5);
  plan.Add(request);
  EXPECT_EQ(plan.WorkOfNext(), 34u * 17);
  const auto reduced = NextOf(plan);
  EXPECT_TRUE(reduced.reduced);
  EXPECT_EQ(reduced.viewpoint.frame().width(), 34u);
  EXPECT_EQ(reduced.viewpoint.frame().height(), 17u);
  EXPECT_EQ(reduced.viewpoint.frame().options().max_relative_error(), 0.5);
  EXPECT_FALSE(plan.HasNewer());
  const auto full = NextOf(plan);
  EXPECT_TRUE(full.refines);
  EXPECT_FALSE(full.reduced);
  EXPECT_EQ(full.viewpoint.sequence(), 7u);
  EXPECT_EQ(full.viewpoint.frame().SerializeAsString(), request.frame().SerializeAsString());
  EXPECT_FALSE(plan.HasNext());
}

TEST(FlightPlanTest, WhoMovesOnGetsNoRefinement) {
  FlightPlan plan(3);
  plan.Add(Viewpoint(0, v1::PACING_NEWEST, 2));
  EXPECT_TRUE(NextOf(plan).reduced);
  plan.Add(Viewpoint(1, v1::PACING_NEWEST, 2));
  EXPECT_TRUE(plan.HasNewer());
  EXPECT_EQ(NextOf(plan).viewpoint.sequence(), 1u);
  EXPECT_TRUE(NextOf(plan).refines);
  EXPECT_FALSE(plan.HasNext());
}

struct BadRequest {
  const char* field;
  void (*spoil)(v1::FlyRequest& request);
};

TEST(FlightPlanTest, WhatIsWrongHasItsTurnAndIsTheLast) {
  const BadRequest kBad[] = {
      {"pacing", [](v1::FlyRequest& r) { r.set_pacing(static_cast<v1::Pacing>(9)); }},
      {"while_moving.divisor",
       [](v1::FlyRequest& r) { r.mutable_while_moving()->set_divisor(65); }},
      {"while_moving.max_relative_error",
       [](v1::FlyRequest& r) { r.mutable_while_moving()->set_max_relative_error(1.5); }},
      {"while_moving.max_relative_error", [](v1::FlyRequest& r) {
         r.mutable_while_moving()->set_max_relative_error(std::numeric_limits<double>::quiet_NaN());
       }}};
  for (const auto& [field, spoil] : kBad) {
    FlightPlan plan(3);
    v1::FlyRequest request = Viewpoint(0, v1::PACING_NEWEST);
    spoil(request);
    plan.Add(request);
    EXPECT_FALSE(plan.WantsMore());
    plan.Add(Viewpoint(1, v1::PACING_NEWEST));
    ASSERT_TRUE(plan.HasNext());
    const auto step = plan.Next();
    EXPECT_TRUE(absl::IsInvalidArgument(step.status())) << field;
    EXPECT_THAT(std::string(step.status().message()), StartsWith(std::string(field) + ":"));
    EXPECT_FALSE(plan.HasNext());
  }
  FlightPlan plan(3);
  plan.Add(Viewpoint(0, v1::PACING_NEWEST));
  plan.Add(absl::InvalidArgumentError("FlyRequest: rubbish"));
  EXPECT_EQ(NextOf(plan).viewpoint.sequence(), 0u) << "not overtaken by rubbish";
  EXPECT_TRUE(absl::IsInvalidArgument(plan.Next().status()));
}

TEST(FlightPlanTest, WorkIsEstimatedWithoutOverflow) {
  v1::RenderFrameRequest request;
  EXPECT_EQ(EstimatedRays(request), 1u);
  request.set_width(300);
  request.set_height(200);
  EXPECT_EQ(EstimatedRays(request), 60'000u);
  request.mutable_sampling()->set_samples(16);
  EXPECT_EQ(EstimatedRays(request), 960'000u);
  constexpr uint32_t kMost = std::numeric_limits<uint32_t>::max();
  request.set_width(kMost);
  request.set_height(kMost);
  request.mutable_sampling()->set_samples(kMost);
  EXPECT_EQ(EstimatedRays(request), std::numeric_limits<uint64_t>::max());
}

TEST(ResumeTokenTest, ComesBackAsItWas) {
  const ResumeToken token{RandomId(), 12};
  const auto back = ParseResumeToken(ToText(token), "resume_token");
  ASSERT_TRUE(back.ok()) << back.status();
  EXPECT_EQ(back->session, token.session);
  EXPECT_EQ(back->frames, 12u);
  EXPECT_NE(RandomId(), RandomId());
}

TEST(ResumeTokenTest, RubbishIsRefused) {
  const std::string session(32, 'a');
  for (const std::string& text :
       {std::string("x"), session, session + "-", session + "-x", session + "-1 ", session + "--1",
        session + "-01", std::string(32, 'g') + "-1", session + "-99999999999999999999",
        "a" + session + "-1", std::string(100'000, '-')}) {
    const auto token = ParseResumeToken(text, "resume_token");
    EXPECT_TRUE(absl::IsInvalidArgument(token.status())) << text.substr(0, 60);
    EXPECT_THAT(std::string(token.status().message()), StartsWith("resume_token:"));
  }
}

}  // namespace
}  // namespace linetree
