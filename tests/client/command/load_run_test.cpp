#include "client/command/load_run.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <functional>

#include "client/command/local_client.h"
#include "client/library/status.h"

namespace linetree {
namespace {

constexpr std::chrono::milliseconds kServiceTime_ms{2};

// Answers frames as a script says, of no pixels; the rest is LocalClient's.
class ScriptedClient : public LocalClient {
 public:
  // What the call of this number, from 0, ends with.
  using Script = std::function<absl::Status(int call)>;
  explicit ScriptedClient(Script script) : LocalClient(1, 1 << 20), script_(std::move(script)) {}

  absl::StatusOr<Frame> RenderFrame(const std::string&, const FrameRequest& request,
                                    const std::string&, const FrameFormat&,
                                    const Progress&) override {
    const absl::Status status = script_(calls_++);
    if (!status.ok()) return status;
    Frame frame;
    frame.camera = request.camera;
    frame.wire_bytes = 1000;
    frame.stats.interpolated = 1;
    return frame;
  }
  absl::StatusOr<v1::GetStatsReply> GetStats(const std::string&) override {
    v1::GetStatsReply reply;
    v1::GetStatsReply::SceneStats& scene = *reply.add_scenes();
    scene.set_cells(static_cast<uint64_t>(10 * calls_));
    // One by each judge's trees.
    scene.set_cells_evicted(static_cast<uint64_t>(calls_));
    scene.mutable_totals()->set_cells_evicted(static_cast<uint64_t>(calls_));
    return reply;
  }

  int calls() const { return calls_; }

 private:
  const Script script_;
  std::atomic<int> calls_{0};
};

absl::Status Ok(int) { return absl::OkStatus(); }

absl::Status Refusal() {
  return WithRetryAfter(absl::ResourceExhaustedError("no room"), std::chrono::milliseconds(1));
}

// Two clients that fly two frames each, of a path of four cameras.
LoadPlan SmallPlan() {
  LoadPlan plan;
  plan.paths = {std::vector<Camera>(4)};
  plan.pieces = PlanPieces(2, {4}, 0.0);
  return plan;
}

TEST(LoadRun, AClosedLoopFliesEveryPieceOnce) {
  ScriptedClient client(Ok);
  const auto phases = RunLoad(SmallPlan(), {&client, &client}, nullptr);
  ASSERT_TRUE(phases.ok()) << phases.status();
  ASSERT_EQ(phases->size(), 1u);
  EXPECT_EQ(phases->front().samples.size(), 4u);
  // Ten for each frame are there at the end, and two had been evicted.
  EXPECT_EQ(phases->front().cells_built, 4u * (10 + 2));
  EXPECT_EQ(phases->front().cells_evicted, 4u * 2);
  for (const LoadSample& sample : phases->front().samples) {
    EXPECT_EQ(sample.intended_s, sample.start_s);
    EXPECT_LE(sample.start_s, sample.end_s);
    EXPECT_EQ(sample.wire_bytes, 1000u);
  }
}

TEST(LoadRun, WarmUpIsAPhaseOfItsOwn) {
  ScriptedClient client(Ok);
  LoadPlan plan = SmallPlan();
  plan.warm_up_frames = 3;
  plan.frames_each = 5;
  const auto phases = RunLoad(plan, {&client, &client}, nullptr);
  ASSERT_TRUE(phases.ok()) << phases.status();
  ASSERT_EQ(phases->size(), 2u);
  EXPECT_EQ((*phases)[0].name, "warm-up");
  EXPECT_EQ((*phases)[0].samples.size(), 6u);
  EXPECT_EQ((*phases)[1].name, "measured");
  EXPECT_EQ((*phases)[1].samples.size(), 10u);
  EXPECT_EQ((*phases)[1].samples.front().frame, 0u);
}

// Coordinated omission: frames that a slow server held up count from when they were to begin.
TEST(LoadRun, InAnOpenLoopWhatASlowServerHeldUpIsLate) {
  ScriptedClient client([](int) {
    const auto until = std::chrono::steady_clock::now() + kServiceTime_ms;
    while (std::chrono::steady_clock::now() < until) continue;
    return absl::OkStatus();
  });
  LoadPlan plan = SmallPlan();
  plan.pieces.resize(1);
  plan.frames_each = 10;
  plan.arrivals = ArrivalOptions{.rate = 100'000};
  const auto phases = RunLoad(plan, {&client}, nullptr);
  ASSERT_TRUE(phases.ok()) << phases.status();
  const LoadFigures figures = SummarizeLoad(phases->front());
  EXPECT_EQ(figures.frames, 10u);
  EXPECT_EQ(figures.late, 9u);
  // The tenth was to begin after 0.09 ms.
  EXPECT_GE(figures.latency.max, 10.0 * kServiceTime_ms.count() - 0.1);
  EXPECT_GE(figures.wait.max, 9.0 * kServiceTime_ms.count() - 0.1);
}

TEST(LoadRun, WhatNoClientCouldBeginInTimeIsCounted) {
  ScriptedClient client([](int) {
    const auto until = std::chrono::steady_clock::now() + 10 * kServiceTime_ms;
    while (std::chrono::steady_clock::now() < until) continue;
    return absl::OkStatus();
  });
  LoadPlan plan = SmallPlan();
  plan.pieces.resize(1);
  plan.duration_s = 5e-3 * static_cast<double>(kServiceTime_ms.count());
  plan.arrivals = ArrivalOptions{.rate = 10'000};
  const auto phases = RunLoad(plan, {&client}, nullptr);
  ASSERT_TRUE(phases.ok()) << phases.status();
  // The first one takes longer than there is time, and is the only one that may begin.
  EXPECT_LE(phases->front().samples.size(), 1u);
  EXPECT_EQ(phases->front().samples.size() + phases->front().not_begun, 100u);
}

TEST(LoadRun, RefusalsAreCountedAndEndNothing) {
  for (const bool open : {false, true}) {
    ScriptedClient client([](int call) { return call % 3 == 1 ? Refusal() : absl::OkStatus(); });
    LoadPlan plan = SmallPlan();
    plan.frames_each = 6;
    if (open) plan.arrivals = ArrivalOptions{.rate = 1e5, .kind = ArrivalKind::kPoisson};
    const auto phases = RunLoad(plan, {&client, &client}, nullptr);
    ASSERT_TRUE(phases.ok()) << phases.status();
    const LoadFigures figures = SummarizeLoad(phases->front());
    EXPECT_EQ(figures.frames, 8u);
    EXPECT_EQ(figures.refused, 4u);
    EXPECT_EQ(client.calls(), 12);
  }
}

TEST(LoadRun, AFlightGoesOnAfterARefusal) {
  ScriptedClient client([](int call) { return call == 1 ? Refusal() : absl::OkStatus(); });
  LoadPlan plan = SmallPlan();
  plan.stream = true;
  plan.pieces.resize(1);
  plan.frames_each = 5;
  const auto phases = RunLoad(plan, {&client}, nullptr);
  ASSERT_TRUE(phases.ok()) << phases.status();
  const LoadFigures figures = SummarizeLoad(phases->front());
  EXPECT_EQ(figures.frames, 4u);
  EXPECT_EQ(figures.refused, 1u);
}

TEST(LoadRun, LightCallsAreTimedMeanwhile) {
  ScriptedClient client(Ok), light(Ok);
  const auto phases = RunLoad(SmallPlan(), {&client, &client}, nullptr, &light);
  ASSERT_TRUE(phases.ok()) << phases.status();
  const std::vector<double>& latencies_ms = phases->front().light_calls_ms;
  EXPECT_FALSE(latencies_ms.empty());
  for (const double ms : latencies_ms) EXPECT_GE(ms, 0);
  EXPECT_EQ(SummarizeLoad(phases->front()).light_calls, latencies_ms.size());
}

TEST(LoadRun, AnErrorOfALightCallEndsIt) {
  class Failing : public ScriptedClient {
   public:
    Failing() : ScriptedClient(Ok) {}
    absl::StatusOr<v1::GetStatsReply> GetStats(const std::string&) override {
      return absl::UnavailableError("gone");
    }
  };
  ScriptedClient client(Ok);
  Failing light;
  EXPECT_EQ(RunLoad(SmallPlan(), {&client, &client}, nullptr, &light).status(),
            absl::UnavailableError("gone"));
}

TEST(LoadRun, OtherErrorsEndIt) {
  ScriptedClient client(
      [](int call) { return call == 2 ? absl::NotFoundError("gone") : absl::OkStatus(); });
  LoadPlan plan = SmallPlan();
  plan.frames_each = 1'000'000;
  EXPECT_EQ(RunLoad(plan, {&client, &client}, nullptr).status(), absl::NotFoundError("gone"));
  // As a server says it of what is too large.
  ScriptedClient full([](int) {
    return WithRetryAfter(absl::ResourceExhaustedError("width"), std::chrono::milliseconds(-1));
  });
  EXPECT_FALSE(RunLoad(plan, {&full, &full}, nullptr).ok());
}

}  // namespace
}  // namespace linetree
