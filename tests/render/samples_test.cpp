// Frames whose pixels have several samples, in every mode, against the mean of the scalar tracer's
// radiances for the same rays.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "core/frame/frame_kernels.h"
#include "core/render/sample_mean.h"
#include "core/render/scene_host.h"
#include "tests/support/demo_scenes.h"
#include "tests/support/matte_rooms.h"
#include "tests/support/render_frame.h"
#include "tests/support/sanitizer_share.h"

namespace linetree {
namespace {

using test::RenderFrame;

Sampling Regular(int samples) { return {samples, SamplePattern::kRegular, 0}; }
Sampling Jittered(int samples, uint64_t seed = 5) {
  return {samples, SamplePattern::kJittered, seed};
}

FrameRequest Request(const Camera& camera, const Sampling& sampling, Mode mode, Lanes lanes,
                     double epsilon) {
  FrameRequest request;
  request.camera = camera;
  request.width = 45;  // neither whole blocks nor whole tiles
  request.height = 38;
  request.options.mode = mode;
  request.options.lanes = lanes;
  request.options.max_relative_error = epsilon;
  request.sampling = sampling;
  return request;
}

// The means of what Tracer says, one ray after the other.
struct Truth {
  std::vector<Rgb> radiance;
  PixelLayer<int32_t> object;
  std::vector<double> depth;
};

Truth TruthOf(const Scene& scene, const FrameRequest& request) {
  const Tracer tracer(scene);
  const PixelSamples samples(request.sampling);
  const EyeRays eye_rays = EyeRays(request.camera, request.width, request.height)
                               .Divided(samples.across(), samples.down());
  const ShownSample shown(samples);
  Truth truth;
  for (int row = 0; row < request.height; ++row) {
    for (int column = 0; column < request.width; ++column) {
      const auto ray = [&](int x, int y) {
        return samples.RayOf(eye_rays, column * samples.across() + x, row * samples.down() + y);
      };
      truth.radiance.push_back(MeanOfSamples(samples, [&](int x, int y) {
        RayCounts counts;
        const auto [origin, direction] = ray(x, y);
        return tracer.Radiance(origin, direction, request.options.limits, counts);
      }));
      const auto [origin, direction] = ray(shown.column, shown.row);
      const Hit hit = tracer.Intersect(origin, direction, RayStart{});
      truth.object.push_back(hit.object);
      truth.depth.push_back(hit.IsHit() ? hit.t : Box3::kInf);
    }
  }
  return truth;
}

// In float: the distance along the axis of view, and what the pixel's ray is longer by.
constexpr double kDepthRounding = 0x1p-20;

// Returns the largest error, as a share of what is allowed.
double ExpectWithin(const Scene& scene, const Frame& frame, const Truth& truth) {
  EXPECT_EQ(frame.object, truth.object);
  const double allowed = frame.max_relative_error + frame.lane_rounding + 0x1p-23;
  double largest = 0;
  for (size_t p = 0; p < truth.radiance.size(); ++p) {
    for (int c = 0; c < 3; ++c) {
      const double wanted = truth.radiance[p][c];
      const double error =
          std::abs(static_cast<double>(frame.radiance[3 * p + static_cast<size_t>(c)]) - wanted);
      const double most = allowed * std::max(wanted, RadianceFloor(scene));
      EXPECT_LE(error, most) << "pixel " << p;
      largest = std::max(largest, error / most);
    }
    if (frame.object[p] != kNoObject) {
      EXPECT_NEAR(frame.depth[p], truth.depth[p], kDepthRounding * truth.depth[p]);
    }
    if (testing::Test::HasFailure()) return largest;
  }
  return largest;
}

void CheckCounters(const Frame& frame) {
  const FrameStats& stats = frame.stats;
  const auto samples = static_cast<uint64_t>(frame.sampling.samples) * frame.object.size();
  EXPECT_EQ(stats.pixels, samples);
  EXPECT_EQ(stats.interpolated + stats.traced + stats.background, samples);
  EXPECT_LE(stats.replayed + stats.residual, stats.traced);
}

void CheckScene(const std::shared_ptr<const Scene>& scene, const Sampling& sampling,
                bool always_ask) {
  WorkerPool pool(1);
  const Camera& camera = scene->cameras[0];
  const Truth truth =
      TruthOf(*scene, Request(camera, sampling, Mode::kClassical, Lanes::kScalar, 0));
  for (const Lanes lanes : {Lanes::kScalar, Lanes::kSimd}) {
    CacheOptions options;
    options.always_ask = always_ask;
    SceneHost host(scene, options);
    const Frame classical =
        RenderFrame(host, Request(camera, sampling, Mode::kClassical, lanes, 0), pool);
    ExpectWithin(*scene, classical, truth);
    CheckCounters(classical);
    for (const double epsilon : {0.25, 0.02, 1e-3, 0.0}) {
      for (int repeat = 0; repeat < 2; ++repeat) {
        SCOPED_TRACE(testing::Message()
                     << sampling.samples << " samples, lanes " << static_cast<int>(lanes)
                     << ", epsilon " << epsilon << ", frame " << repeat);
        const Frame frame =
            RenderFrame(host, Request(camera, sampling, Mode::kCached, lanes, epsilon), pool);
        ExpectWithin(*scene, frame, truth);
        CheckCounters(frame);
        if (epsilon == 0) {
          EXPECT_EQ(frame.radiance, classical.radiance);
          EXPECT_EQ(frame.depth, classical.depth);
        }
        if (testing::Test::HasFailure()) return;
      }
    }
  }
}

TEST(SamplesTest, EveryModeIsWithinEpsilonOfTheScalarTracersMean) {
  const std::vector<Sampling> samplings = {Regular(4),   Regular(16), Jittered(1),
                                           Jittered(16), Regular(9),  Regular(2),
                                           Jittered(5),  Regular(25), Regular(64)};
  const size_t count = samplings.size() / test::kSanitizerShare;
  for (size_t i = 0; i < std::max<size_t>(count, 3); ++i) {
    CheckScene(test::BallsOnFloor(6, i), samplings[i], i % 3 != 0);
    CheckScene(test::MatteRoom(i), samplings[i], true);
    if (HasFailure()) return;
  }
}

// More than kBlockSide cells of a pixel in a row.
TEST(SamplesTest, LongLattices) {
  CheckScene(test::BallsOnFloor(3, 1), Regular(37), true);
  if (test::kSanitizerShare == 1) CheckScene(test::MatteRoom(7), Jittered(63), true);
}

// An oracle that knows nothing of samples.
TEST(SamplesTest, GridsAreBoxFilteredFinerFrames) {
  const auto scene = test::BallsOnFloor(8, 3);
  SceneHost host(scene);
  WorkerPool pool(1);
  constexpr int kSide = 3;
  for (const Lanes lanes : {Lanes::kScalar, Lanes::kSimd}) {
    FrameRequest request =
        Request(scene->cameras[0], Regular(kSide * kSide), Mode::kClassical, lanes, 0);
    const Frame frame = RenderFrame(host, request, pool);
    request.sampling = {};
    request.width *= kSide;
    request.height *= kSide;
    const Frame finer = RenderFrame(host, request, pool);
    for (size_t i = 0; i < frame.radiance.size(); ++i) {
      const auto width = static_cast<size_t>(frame.width);
      const size_t column = i / 3 % width * kSide, row = i / 3 / width * kSide;
      double sum = 0;
      for (size_t y = row; y < row + kSide; ++y) {
        for (size_t x = column; x < column + kSide; ++x) {
          sum += finer.radiance[3 * (y * static_cast<size_t>(finer.width) + x) + i % 3];
        }
      }
      const double mean = sum / (kSide * kSide);
      EXPECT_NEAR(frame.radiance[i], mean, 0x1p-22 * mean) << i;
    }
  }
}

// Pixels that are evaluated once, with the trees as they are.
uint64_t CountOnce(SceneHost& host, const FrameRequest& request) {
  const EyeRays eye_rays(request.camera, request.width, request.height);
  const PixelSamples samples(request.sampling);
  const ShownSample shown(samples);
  const double error = request.options.max_relative_error - host.packets().radiance_rounding();
  const SurfaceCache::Reader reader(host.surfaces(), error);
  const FramePlan plan(host.scene().objects.size(), true);
  const auto pixels = static_cast<size_t>(request.width * request.height);
  std::vector<float> radiance(3 * pixels), depth(pixels);
  std::vector<int32_t> object(pixels);
  const PixelTarget target = {radiance.data(), object.data(), depth.data(), nullptr};
  PacketWorkspace workspace;
  PacketCounts counts;
  uint64_t done = 0;
  for (int row = 0; row < request.height; row += kBlockSide) {
    for (int column = 0; column < request.width; column += kBlockSide) {
      const PacketTracer::Region region = {column, row,
                                           std::min(kBlockSide, request.width - column),
                                           std::min(kBlockSide, request.height - row)};
      const OnceTask task = {eye_rays, region,  static_cast<size_t>(request.width),
                             target,   samples, shown.column,
                             shown.row};
      OnceBlock block;
      RenderOnceWide(host.packets().scene(), task, reader, plan, workspace, counts, block);
      for (const LaneMask lanes : block.done) {
        done += static_cast<uint64_t>(std::popcount(lanes));
      }
    }
  }
  return done;
}

// Rooms that are all but made of what may be evaluated once, seen closely, from far away and
// flatly, with lights of all kinds, some just over the floor: pictures in which a pixel covers a
// great part of what the light changes over.
TEST(SamplesTest, PixelsThatAreEvaluatedOnceAreWithinEpsilonOfTheMean) {
  WorkerPool pool(1);
  uint64_t pixels = 0, once = 0;
  double largest = 0;
  for (uint64_t seed = 0; seed < 40 / test::kSanitizerShare; ++seed) {
    const auto scene = test::MatteRoom(seed);
    const Sampling sampling = seed % 3 == 0 ? Jittered(4, seed) : Regular(seed % 3 == 1 ? 9 : 16);
    for (const Camera& camera : scene->cameras) {
      CacheOptions options;
      options.always_ask = true;
      SceneHost host(scene, options);
      const auto request = [&](double epsilon) {
        FrameRequest r = Request(camera, sampling, Mode::kCached, Lanes::kSimd, epsilon);
        if (seed % 4 == 0) r.width = r.height = 11;  // large pixels
        return r;
      };
      const Truth truth = TruthOf(*scene, request(0));
      for (const double epsilon : {0.25, 0.25, 0.05, 0.02, 2e-3, 2e-4}) {
        SCOPED_TRACE(testing::Message() << "seed " << seed << ", epsilon " << epsilon);
        const Frame frame = RenderFrame(host, request(epsilon), pool);
        largest = std::max(largest, ExpectWithin(*scene, frame, truth));
        CheckCounters(frame);
        if (HasFailure()) return;
      }
      pixels += truth.object.size();
      once += CountOnce(host, request(0.02));
    }
  }
  std::printf("%.0f %% evaluated once; largest error %.3f of what is allowed\n",
              100 * static_cast<double>(once) / static_cast<double>(pixels), largest);
  EXPECT_GT(once, pixels / 16);
}

// A floor and one light over it, seen from above in pixels that are about as large as the light is
// high: what a centre says and the mean differ by far more than epsilon in many, and are as good as
// equal in others.
TEST(SamplesTest, CentresOfLargePixelsUnderLowLightsAreNotTheirMeans) {
  WorkerPool pool(1);
  test::Random random(7);
  uint64_t pixels = 0, once = 0, far_off = 0;
  double largest = 0;
  for (int i = 0; i < 24; ++i) {
    auto scene = std::make_shared<Scene>();
    scene->materials = {test::Matte({0.5, 0.6, 0.7})};
    scene->objects = {
        test::ObjectOf(test::Polygon({{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}}))};
    scene->lights = {test::PointLight({0.1, 0.2, random.LogUniform(0.05, 5)})};
    if (i % 3 == 1) scene->lights[0].fade_distance = random.LogUniform(0.1, 3);
    if (i % 6 == 1) scene->lights[0].fade_power = 8;
    scene->cameras = {{"above", {0.3, 0.1, 10}, {0.2, random.Uniform(0, 5), 0}, {0, 1, 0}, 45}};
    CacheOptions options;
    options.always_ask = true;
    SceneHost host(scene, options);
    const Sampling sampling = i % 2 == 0 ? Regular(16) : Jittered(4);
    FrameRequest request = Request(scene->cameras[0], sampling, Mode::kCached, Lanes::kSimd, 0.02);
    request.width = request.height = 32;
    const Truth truth = TruthOf(*scene, request);
    for (int frame = 0; frame < 3; ++frame) {
      largest = std::max(largest, ExpectWithin(*scene, RenderFrame(host, request, pool), truth));
      if (HasFailure()) return;
    }
    once += CountOnce(host, request);
    pixels += truth.object.size();
    request.sampling = {};
    const Truth centres = TruthOf(*scene, request);
    for (size_t p = 0; p < centres.radiance.size(); ++p) {
      const double mean = truth.radiance[p].g;
      far_off += std::abs(centres.radiance[p].g - mean) > 0.02 * mean ? 1 : 0;
    }
  }
  std::printf(
      "%.0f %% evaluated once, %.0f %% must not be; largest error %.3f of what is allowed\n",
      100 * static_cast<double>(once) / static_cast<double>(pixels),
      100 * static_cast<double>(far_off) / static_cast<double>(pixels), largest);
  EXPECT_GT(once, pixels / 8);
  EXPECT_GT(far_off, pixels / 32);
}

TEST(SamplesTest, PicturesDoNotDependOnThreads) {
  const auto scene = test::BallsOnFloor(6, 2);
  for (const Mode mode : {Mode::kCached, Mode::kClassical}) {
    for (const Lanes lanes : {Lanes::kScalar, Lanes::kSimd}) {
      const FrameRequest request = Request(scene->cameras[0], Jittered(9), mode, lanes, 0.1);
      WorkerPool one(1), three(3);
      SceneHost by_one(scene), by_three(scene);
      for (int frame = 0; frame < 2; ++frame) {
        EXPECT_EQ(RenderFrame(by_one, request, one).radiance,
                  RenderFrame(by_three, request, three).radiance);
      }
    }
  }
}

TEST(SamplesTest, SeedsMakeOtherPictures) {
  const auto scene = test::BallsOnFloor(6, 2);
  SceneHost host(scene);
  WorkerPool pool(1);
  const auto render = [&](const Sampling& sampling) {
    return RenderFrame(
               host, Request(scene->cameras[0], sampling, Mode::kClassical, Lanes::kSimd, 0), pool)
        .radiance;
  };
  EXPECT_EQ(render(Jittered(4, 1)), render(Jittered(4, 1)));
  EXPECT_NE(render(Jittered(4, 1)), render(Jittered(4, 2)));
  EXPECT_NE(render(Jittered(4, 1)), render(Regular(4)));
  EXPECT_NE(render(Regular(4)), render(Regular(1)));
}

TEST(SamplesTest, ThePapersJudgeAnswersSamples) {
  const auto scene = test::BallsOnFloor(4, 2);
  SceneHost host(scene);
  WorkerPool pool(1);
  FrameRequest request = Request(scene->cameras[0], Regular(4), Mode::kCached, Lanes::kScalar, 0);
  request.options.judge = JudgeKind::kPaper;
  const Frame paper = RenderFrame(host, request, pool);
  ExpectWithin(*scene, paper, TruthOf(*scene, request));
  EXPECT_EQ(paper.sampling, request.sampling);
}

TEST(SamplesTest, BadNumbersAndTooManyAreRefused) {
  const auto scene = test::BallsOnFloor(1, 1);
  RenderLimits limits;
  limits.max_samples = 45 * 38 * 9;
  SceneHost host(scene, {}, limits);
  WorkerPool pool(1);
  const auto ask = [&](int samples) {
    return host
        .RenderFrame(
            Request(scene->cameras[0], Regular(samples), Mode::kClassical, Lanes::kSimd, 0), pool)
        .status();
  };
  EXPECT_TRUE(absl::IsInvalidArgument(ask(0)));
  EXPECT_TRUE(absl::IsInvalidArgument(ask(65)));
  EXPECT_TRUE(absl::IsResourceExhausted(ask(10)));
  EXPECT_TRUE(ask(9).ok());
}

TEST(SamplesTest, CancelledFramesStop) {
  const auto scene = test::BallsOnFloor(1, 1);
  SceneHost host(scene);
  WorkerPool pool(1);
  CancelToken cancel;
  cancel.Cancel();
  for (const Lanes lanes : {Lanes::kScalar, Lanes::kSimd}) {
    const FrameRequest request = Request(scene->cameras[0], Regular(4), Mode::kCached, lanes, 0.1);
    EXPECT_TRUE(absl::IsCancelled(host.RenderFrame(request, pool, &cancel).status()));
  }
}

}  // namespace
}  // namespace linetree
