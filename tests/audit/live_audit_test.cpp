#include "core/audit/live_audit.h"

#include <gtest/gtest.h>

#include <latch>
#include <mutex>
#include <vector>

#include "core/audit/query_rays.h"
#include "core/audit/scene_families.h"

namespace linetree {
namespace {

// A scene as a server holds it, with answers that are right.
struct Served {
  std::shared_ptr<SceneHost> host =
      std::make_shared<SceneHost>(MakeFamilyScene(SceneFamily::kWalls, 1));
  LiveScene scene{"walls", host, std::make_shared<AuditCounts>()};
  RenderOptions options;
  std::vector<Ray> rays;
  RayBatch batch;

  explicit Served(size_t count = 500) {
    options.judge = JudgeKind::kCertified;
    const QueryRays source(host->tracer(), host->scene().cameras);
    RandomStream random(1);
    for (size_t i = 0; i < count; ++i) rays.push_back(source.Random(random));
    for (Ray& ray : rays) ray.direction = ray.direction * 3;  // need not be of unit length
    WorkerPool pool(1);
    batch = *host->TraceRays(rays, options, pool);
  }
  void Spoil(size_t index) { batch.answers[index].radiance.r += 5; }
};

class Log {
 public:
  LiveAudit::OnViolation Writer() {
    return [this](const Violation& violation) {
      const std::lock_guard lock(mutex_);
      violations_.push_back(violation);
    };
  }
  std::vector<Violation> violations() const {
    const std::lock_guard lock(mutex_);
    return violations_;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<Violation> violations_;  // guarded by mutex_
};

TEST(LiveAuditTest, RightAnswersAreCheckedAndFine) {
  Served served;
  Log log;
  LiveAudit audit({.share = 1}, log.Writer());
  audit.Offer(served.scene, served.rays, served.options, served.batch);
  audit.WaitUntilChecked();
  EXPECT_EQ(served.scene.counts->values(), (AuditCounts::Values{.checked = 500}));
  EXPECT_TRUE(log.violations().empty());
}

TEST(LiveAuditTest, APlantedViolationIsCountedAndReported) {
  Served served;
  served.Spoil(123);
  Log log;
  LiveAudit audit({.share = 1}, log.Writer());
  audit.Offer(served.scene, served.rays, served.options, served.batch);
  audit.WaitUntilChecked();
  const AuditCounts::Values values = served.scene.counts->values();
  EXPECT_EQ(values.checked, 500u);
  EXPECT_EQ(values.violations, 1u);
  EXPECT_GT(values.max_error_over_allowed, 1);
  const auto violations = log.violations();
  ASSERT_EQ(violations.size(), 1u);
  EXPECT_EQ(violations[0].scene, "walls " + served.host->scene().version);
  EXPECT_EQ(violations[0].ray.origin, served.rays[123].origin);
  EXPECT_EQ(violations[0].ray.direction, served.rays[123].direction);
  EXPECT_EQ(violations[0].answer, served.batch.answers[123].radiance);
  EXPECT_EQ(violations[0].options.judge, JudgeKind::kCertified);
}

TEST(LiveAuditTest, FramesAreComparedAsFloats) {
  Served served(1);
  served.options.max_relative_error = 0;
  FrameRequest request;
  request.camera = served.host->scene().cameras[0];
  request.width = 40;
  request.height = 30;
  request.options = served.options;
  WorkerPool pool(1);
  Frame frame = *served.host->RenderFrame(request, pool);
  Log log;
  LiveAudit audit({.share = 1}, log.Writer());
  audit.Offer(served.scene, served.options, frame);
  audit.WaitUntilChecked();
  EXPECT_EQ(served.scene.counts->values(), (AuditCounts::Values{.checked = 1200}));
  float& channel = frame.radiance[3 * (40 * 7 + 11) + 1];
  channel = std::nextafterf(channel, 10);
  audit.Offer(served.scene, served.options, frame);
  audit.WaitUntilChecked();
  EXPECT_EQ(served.scene.counts->values().violations, 1u);
  ASSERT_EQ(log.violations().size(), 1u);
  const Ray ray = EyeRays(request.camera, 40, 30).ThroughPixel(11, 7);
  EXPECT_EQ(log.violations()[0].ray.direction, ray.direction);
  EXPECT_TRUE(log.violations()[0].from_frame);
}

// All rays of a pixel are traced again, not the one through its centre.
TEST(LiveAuditTest, PixelsOfSeveralSamplesAreHeldAgainstTheirMean) {
  Served served(1);
  served.options.max_relative_error = 0;
  FrameRequest request;
  request.camera = served.host->scene().cameras[0];
  request.width = 40;
  request.height = 30;
  request.options = served.options;
  request.sampling = {5, SamplePattern::kJittered, 3};
  WorkerPool pool(1);
  auto frame = served.host->RenderFrame(request, pool);
  ASSERT_TRUE(frame.ok()) << frame.status();
  Log log;
  LiveAudit audit({.share = 1}, log.Writer());
  audit.Offer(served.scene, served.options, *frame);
  audit.WaitUntilChecked();
  EXPECT_EQ(served.scene.counts->values(), (AuditCounts::Values{.checked = 1200}));
  EXPECT_TRUE(log.violations().empty());

  frame->radiance[3 * 47] += 1;
  audit.Offer(served.scene, served.options, *frame);
  audit.WaitUntilChecked();
  ASSERT_EQ(log.violations().size(), 1u);
  EXPECT_EQ(log.violations()[0].pixel.find("7,1 of 40x30 eye="), 0u) << log.violations()[0].pixel;
  EXPECT_NE(ToLine(log.violations()[0]).find("samples=5 jittered seed=3\""), std::string::npos);
}

TEST(LiveAuditTest, RaysByPacketsMayBeOffByWhatFloatAdds) {
  Served served(1);
  served.rays = Served(500).rays;
  served.options.lanes = Lanes::kSimd;
  served.options.max_relative_error = 0;
  WorkerPool pool(1);
  served.batch = *served.host->TraceRays(served.rays, served.options, pool);
  ASSERT_GT(served.batch.lane_rounding, 0);
  Log log;
  LiveAudit audit({.share = 1}, log.Writer());
  audit.Offer(served.scene, served.rays, served.options, served.batch);
  audit.WaitUntilChecked();
  EXPECT_EQ(served.scene.counts->values().checked, 500u);
  EXPECT_EQ(served.scene.counts->values().violations, 0u);
  EXPECT_GT(served.scene.counts->values().max_error_over_allowed, 0);
  Rgb& radiance = served.batch.answers[77].radiance;
  radiance.g += 2 * served.batch.lane_rounding * std::max(radiance.g, 1.0);
  audit.Offer(served.scene, served.rays, served.options, served.batch);
  audit.WaitUntilChecked();
  EXPECT_EQ(served.scene.counts->values().violations, 1u);
}

TEST(LiveAuditTest, OnlyCachedAnswersAndOnlyAShareOfThem) {
  Served served(5000);
  Log log;
  LiveAudit audit({.share = 0.1, .max_waiting = 8192}, log.Writer());
  served.options.mode = Mode::kClassical;
  audit.Offer(served.scene, served.rays, served.options, served.batch);
  audit.WaitUntilChecked();
  EXPECT_EQ(served.scene.counts->values().checked, 0u);
  served.options.mode = Mode::kCached;
  audit.Offer(served.scene, served.rays, served.options, served.batch);
  audit.WaitUntilChecked();
  EXPECT_NEAR(static_cast<double>(served.scene.counts->values().checked), 500, 130);
  LiveAudit off({.share = 0}, log.Writer());
  off.Offer(served.scene, served.rays, served.options, served.batch);
  off.WaitUntilChecked();
}

// An audit whose thread stands still in the report of the first answer.
class HeldAudit {
 public:
  explicit HeldAudit(size_t max_waiting)
      : audit_({.share = 1, .max_waiting = max_waiting}, [this](const Violation&) {
          if (reported_++ > 0) return;
          standing_.count_down();
          go_on_.wait();
        }) {}

  // Offers a wrong answer and returns when the thread stands.
  void Hold(Served& served) {
    served.Spoil(0);
    RayBatch first;
    first.answers = {served.batch.answers[0]};
    audit_.Offer(served.scene, {served.rays[0]}, served.options, first);
    standing_.wait();
  }
  void Release() { go_on_.count_down(); }
  LiveAudit& audit() { return audit_; }

 private:
  std::latch standing_{1}, go_on_{1};
  int reported_ = 0;
  LiveAudit audit_;
};

TEST(LiveAuditTest, AFullQueueDropsAndCounts) {
  Served served;
  HeldAudit held(64);
  held.Hold(served);
  held.audit().Offer(served.scene, served.rays, served.options, served.batch);
  EXPECT_EQ(served.scene.counts->values().dropped, 500u - 64);
  held.Release();
  held.audit().WaitUntilChecked();
  EXPECT_EQ(served.scene.counts->values().checked, 1u + 64);
}

TEST(LiveAuditTest, EntriesKeepTheirSceneAndShutdownDropsThem) {
  auto served = std::make_unique<Served>();
  const std::weak_ptr<SceneHost> watch = served->host;
  const auto counts = served->scene.counts;
  {
    HeldAudit held(4096);
    held.Hold(*served);
    held.audit().Offer(served->scene, served->rays, served->options, served->batch);
    served.reset();  // as if it were unloaded
    EXPECT_FALSE(watch.expired());
    held.Release();
  }
  EXPECT_TRUE(watch.expired());
  EXPECT_LE(counts->values().checked, 501u);
}

TEST(LiveAuditTest, AnswersOfManyRequestsAddUp) {
  Served served;
  Log log;
  LiveAudit audit({.share = 1, .max_waiting = 256}, log.Writer());
  std::vector<std::thread> requests;
  for (int r = 0; r < 4; ++r) {
    requests.emplace_back([&] {
      for (int i = 0; i < 5; ++i) {
        audit.Offer(served.scene, served.rays, served.options, served.batch);
        const AuditCounts::Values now = served.scene.counts->values();
        EXPECT_LE(now.violations, now.checked);
      }
    });
  }
  for (std::thread& request : requests) request.join();
  audit.WaitUntilChecked();
  const AuditCounts::Values values = served.scene.counts->values();
  EXPECT_EQ(values.checked + values.dropped, 4u * 5 * 500);
  EXPECT_EQ(values.violations, 0u);
}

}  // namespace
}  // namespace linetree
