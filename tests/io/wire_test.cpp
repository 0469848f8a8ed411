#include "core/io/wire.h"

#include <gmock/gmock.h>

#include <limits>

#include "tests/support/demo_scenes.h"

namespace linetree {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// A number for every field, so that one that is forgotten or swapped shows.
FrameStats CountedStats() {
  FrameStats stats;
  uint64_t next = 1;
  for (uint64_t* field : {&stats.pixels, &stats.interpolated, &stats.traced, &stats.replayed,
                          &stats.residual, &stats.background, &stats.cells_tried,
                          &stats.cells_accepted, &stats.cells_evicted, &stats.cache_bytes}) {
    *field = next++;
  }
  for (RayCounts* counts : {&stats.base, &stats.ip}) {
    *counts = {next,     next + 1, next + 2, next + 3, next + 4,
               next + 5, next + 6, next + 7, next + 8};
    next += 9;
  }
  for (uint64_t& verdict : stats.verdicts) verdict = next++;
  stats.wall_ms = 0.5;
  stats.cpu_ms = 0.25;
  return stats;
}

void ExpectSame(const FrameStats& a, const FrameStats& b) {
  EXPECT_EQ(a.pixels, b.pixels);
  EXPECT_EQ(a.interpolated, b.interpolated);
  EXPECT_EQ(a.traced, b.traced);
  EXPECT_EQ(a.replayed, b.replayed);
  EXPECT_EQ(a.residual, b.residual);
  EXPECT_EQ(a.background, b.background);
  EXPECT_EQ(a.base, b.base);
  EXPECT_EQ(a.ip, b.ip);
  EXPECT_EQ(a.verdicts, b.verdicts);
  EXPECT_EQ(a.cells_tried, b.cells_tried);
  EXPECT_EQ(a.cells_accepted, b.cells_accepted);
  EXPECT_EQ(a.cells_evicted, b.cells_evicted);
  EXPECT_EQ(a.cache_bytes, b.cache_bytes);
  EXPECT_EQ(a.wall_ms, b.wall_ms);
  EXPECT_EQ(a.cpu_ms, b.cpu_ms);
}

TEST(WireTest, StatsLoseNothing) {
  const FrameStats stats = CountedStats();
  const v1::FrameStats message = FrameStatsToWire(stats, 640, 480);
  ExpectSame(FrameStatsFromWire(message), stats);
  EXPECT_EQ(message.width(), 640u);
  EXPECT_EQ(message.height(), 480u);
}

TEST(WireTest, StatsOnTheWireAddUp) {
  const v1::FrameStats message = FrameStatsToWire(CountedStats(), 0, 0);
  EXPECT_EQ(message.intersect(), message.base_intersect() + message.ip_intersect());
  EXPECT_EQ(message.shade(), message.base_shade() + message.ip_shade());
  EXPECT_GT(message.eye_rays(), message.ip_eye_rays());
}

TEST(WireTest, CamerasLoseNothing) {
  const Camera camera{"side", {1, 2, 3}, {4, 5, 6}, {0, 0, 1}, 33};
  EXPECT_EQ(CameraFromWire(CameraToWire(camera)), camera);
}

TEST(WireTest, CamerasHaveTheDefaultsOfTheFormat) {
  v1::Camera message;
  message.mutable_eye()->set_z(7);
  const Camera camera = CameraFromWire(message);
  EXPECT_EQ(camera.up, (Vec3d{0, 1, 0}));
  EXPECT_EQ(camera.look_at, (Vec3d{0, 0, 0}));
  EXPECT_EQ(camera.fov_deg, 45);
}

TEST(WireTest, OptionsLoseNothing) {
  RenderOptions options;
  options.mode = Mode::kClassical;
  options.judge = JudgeKind::kCertified;
  options.max_relative_error = 0.375;
  options.limits = {7, 0.125};
  const auto back = RenderOptionsFromWire(RenderOptionsToWire(options), RenderOptions(), "");
  ASSERT_TRUE(back.ok()) << back.status();
  EXPECT_EQ(back->mode, options.mode);
  EXPECT_EQ(back->judge, options.judge);
  EXPECT_EQ(back->max_relative_error, options.max_relative_error);
  EXPECT_EQ(back->limits, options.limits);
}

TEST(WireTest, OptionsThatAreLeftOutAreTheDefaults) {
  RenderOptions defaults;
  defaults.mode = Mode::kClassical;
  defaults.max_relative_error = 0.5;
  defaults.limits = {9, 0.25};
  const auto options = RenderOptionsFromWire({}, defaults, "");
  ASSERT_TRUE(options.ok()) << options.status();
  EXPECT_EQ(options->mode, Mode::kClassical);
  EXPECT_EQ(options->max_relative_error, 0.5);
  EXPECT_EQ(options->limits, defaults.limits);
}

TEST(WireTest, AnExplicitZeroIsNotLeftOut) {
  v1::RenderOptions message;
  message.set_max_relative_error(0);
  message.set_min_weight(0);
  const auto options = RenderOptionsFromWire(message, RenderOptions(), "");
  ASSERT_TRUE(options.ok()) << options.status();
  EXPECT_EQ(options->max_relative_error, 0);
  EXPECT_EQ(options->limits.min_weight, 0);
}

class FrameRequestTest : public testing::Test {
 protected:
  FrameRequestTest() : scene_(test::BallsOnFloor(3, 1)) {
    request_.set_scene("balls");
    request_.set_width(64);
    request_.set_height(48);
  }

  absl::StatusOr<FrameRequest> Read() const {
    return FrameRequestFromWire(request_, *scene_, RenderOptions(), RenderLimits(), "frame.");
  }

  std::shared_ptr<const Scene> scene_;
  v1::RenderFrameRequest request_;
};

TEST_F(FrameRequestTest, LosesNothing) {
  FrameRequest request;
  request.camera = {"c", {0, -8, 2}, {0, 0, 1}, {0, 0, 1}, 50};
  request.width = 33;
  request.height = 44;
  request.options.max_relative_error = 0.75;
  request.sampling = {9, SamplePattern::kJittered, ~uint64_t{0}};
  request_ = FrameRequestToWire("balls", request, "", {.all_layers = true});
  EXPECT_TRUE(request_.all_layers());
  const auto back = Read();
  ASSERT_TRUE(back.ok()) << back.status();
  EXPECT_EQ(back->camera, request.camera);
  EXPECT_EQ(back->width, 33);
  EXPECT_EQ(back->height, 44);
  EXPECT_EQ(back->options.max_relative_error, 0.75);
  EXPECT_EQ(back->sampling, request.sampling);
}

TEST_F(FrameRequestTest, SamplesAreCheckedAndOneWhenLeftOut) {
  EXPECT_TRUE(Read()->sampling.IsPlain());
  v1::Sampling& sampling = *request_.mutable_sampling();
  for (const uint32_t samples : {65u, 1u << 31, ~0u}) {
    sampling.set_samples(samples);
    const absl::Status status = Read().status();
    EXPECT_TRUE(absl::IsInvalidArgument(status));
    EXPECT_EQ(status.message().find("frame.sampling.samples: expected 1 to 64, got "), 0u)
        << status;
  }
  sampling.set_samples(64);
  EXPECT_EQ(Read()->sampling.samples, 64);
  sampling.set_pattern(static_cast<v1::SamplePattern>(7));
  EXPECT_TRUE(absl::IsInvalidArgument(Read().status()));
}

TEST_F(FrameRequestTest, NoViewIsTheFirstCamera) {
  const auto request = Read();
  ASSERT_TRUE(request.ok()) << request.status();
  EXPECT_EQ(request->camera, scene_->cameras[0]);
}

TEST_F(FrameRequestTest, ErrorsNameTheFieldByItsWholePath) {
  request_.mutable_camera()->mutable_eye()->set_x(kNan);
  EXPECT_THAT(std::string(Read().status().message()), StartsWith("frame.camera.eye:"));
  request_.set_camera_name("nowhere");
  EXPECT_TRUE(absl::IsNotFound(Read().status()));
  EXPECT_THAT(std::string(Read().status().message()), StartsWith("frame.camera_name:"));
  request_.set_camera_name("");
  request_.mutable_options()->set_max_depth(std::numeric_limits<uint32_t>::max());
  EXPECT_THAT(std::string(Read().status().message()), StartsWith("frame.options.max_depth:"));
  request_.mutable_options()->set_mode(static_cast<v1::Mode>(77));
  EXPECT_THAT(std::string(Read().status().message()), StartsWith("frame.options.mode:"));
  request_.set_width(0);
  EXPECT_THAT(std::string(Read().status().message()), StartsWith("frame.width:"));
}

TEST(WireTest, BatchesLoseNothing) {
  RayBatch batch;
  batch.stats = CountedStats();
  batch.lane_rounding = 0.25;
  batch.answers = {{{1, 2, 3}, Source::kTraced, Verdict::kGap, 5, 6.5},
                   {{0, 0.5, 0},
                    Source::kBackground,
                    Verdict::kUntried,
                    -1,
                    std::numeric_limits<double>::infinity()}};
  const v1::TraceRaysReply reply = RayBatchToWire(batch, "version");
  EXPECT_EQ(reply.scene_version(), "version");
  const auto back = RayBatchFromWire(reply);
  ASSERT_TRUE(back.ok()) << back.status();
  ExpectSame(back->stats, batch.stats);
  EXPECT_EQ(back->lane_rounding, 0.25);
  ASSERT_EQ(back->answers.size(), 2u);
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(back->answers[i].radiance, batch.answers[i].radiance);
    EXPECT_EQ(back->answers[i].source, batch.answers[i].source);
    EXPECT_EQ(back->answers[i].verdict, batch.answers[i].verdict);
    EXPECT_EQ(back->answers[i].object, batch.answers[i].object);
    EXPECT_EQ(back->answers[i].depth, batch.answers[i].depth);
  }
}

TEST(WireTest, AnUnknownSourceIsDataLoss) {
  v1::TraceRaysReply reply;
  reply.add_answers()->set_source(static_cast<v1::Source>(9));
  EXPECT_TRUE(absl::IsDataLoss(RayBatchFromWire(reply).status()));
}

TEST(WireTest, RaysLoseNothing) {
  const std::vector<Ray> rays = {{{1, 2, 3}, {0, 0, -1}}, {{4, 5, 6}, {3, 0, 4}}};
  const v1::TraceRaysRequest request = RaysToWire("balls", rays, RenderOptions());
  EXPECT_EQ(request.scene(), "balls");
  const auto back = RaysFromWire(request);
  ASSERT_EQ(back.size(), 2u);
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(back[i].origin, rays[i].origin);
    EXPECT_EQ(back[i].direction, rays[i].direction);
  }
}

TEST(WireTest, SceneNames) {
  for (const std::string& good :
       {std::string("a"), std::string("room_2.nff"), std::string("A-b"), std::string(128, 'x')}) {
    EXPECT_TRUE(ValidateSceneName(good, "scene").ok()) << good;
  }
  for (const std::string& bad :
       {std::string(), std::string("a b"), std::string("a/b"), std::string("a\0b", 3),
        std::string("\xff"), std::string(129, 'x')}) {
    const auto status = ValidateSceneName(bad, "scene");
    EXPECT_TRUE(absl::IsInvalidArgument(status)) << bad;
    EXPECT_THAT(std::string(status.message()), StartsWith("scene:"));
  }
}

TEST(WireTest, StringsFromOutsideArePrintedSafely) {
  EXPECT_EQ(Quoted("a\nb"), "'a\\nb'");
  EXPECT_THAT(Quoted(std::string(5000, 'x')), HasSubstr("...'"));
  EXPECT_LT(Quoted(std::string(5000, '\x01')).size(), 400u);
}

TEST(WireTest, SceneInfoCountsAndBounds) {
  const auto scene = test::BallsOnFloor(3, 1);
  const v1::SceneInfo info = SceneInfoToWire("balls", *scene, 77);
  EXPECT_EQ(info.name(), "balls");
  EXPECT_EQ(info.scene_version(), scene->version);
  EXPECT_EQ(info.objects(), 6u);
  EXPECT_EQ(info.lights(), 2u);
  EXPECT_EQ(info.materials(), 4u);
  EXPECT_EQ(info.cameras_size(), 1);
  EXPECT_EQ(info.bounds_min().x(), scene->WorldBounds().min.x);
  EXPECT_EQ(info.bounds_max().z(), scene->WorldBounds().max.z);
  EXPECT_EQ(info.cache_bytes(), 77u);
}

TEST(WireTest, AuditCountsKeepTheirNames) {
  const auto stats = AuditStatsToWire(
      {.checked = 7, .violations = 2, .dropped = 5, .max_error_over_allowed = 1.5});
  EXPECT_EQ(stats.checked(), 7u);
  EXPECT_EQ(stats.violations(), 2u);
  EXPECT_EQ(stats.dropped(), 5u);
  EXPECT_EQ(stats.max_error_over_allowed(), 1.5);
}

TEST(WireTest, SceneStatsAreThoseOfTheHost) {
  SceneHost host(test::BallsOnFloor(3, 1));
  WorkerPool pool(1);
  FrameRequest request;
  request.camera = host.scene().cameras[0];
  request.width = request.height = 64;
  const auto frame = host.RenderFrame(request, pool);
  ASSERT_TRUE(frame.ok()) << frame.status();
  const auto stats = SceneStatsToWire("balls", host);
  EXPECT_EQ(stats.scene(), "balls");
  EXPECT_EQ(stats.frames(), 1u);
  EXPECT_EQ(stats.ray_batches(), 0u);
  EXPECT_EQ(stats.totals().pixels(), 64u * 64u);
  EXPECT_EQ(stats.cache_bytes(), host.CacheBytes());
  uint64_t cells = 0;
  for (const auto& object : stats.objects()) {
    EXPECT_EQ(object.name(), host.scene().objects[object.object()].name);
    for (const auto& [verdict, count] : object.cells()) cells += count;
  }
  EXPECT_EQ(cells, stats.cells());
  EXPECT_GT(cells, 0u);
}

}  // namespace
}  // namespace linetree
