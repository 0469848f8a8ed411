// One small scene for every verdict, and what a certified cell must hold.
#include "core/tree/paper_judge.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/random.h"
#include "tests/support/scene_builder.h"

namespace linetree {
namespace {

using test::ObjectOf;

class PaperJudgeTest : public testing::Test {
 protected:
  PaperJudgeTest() {
    scene_.ambient = {0.1, 0.1, 0.1};
    Material matte = test::Matte({0.6, 0.5, 0.4});
    matte.ambient = {1, 1, 1};
    Material glossy = matte;
    glossy.specular = {0.5, 0.5, 0.5};
    glossy.exponent = 30;
    scene_.materials = {matte, glossy, test::Mirror({0.8, 0.8, 0.8}),
                        test::Glass({0.9, 0.9, 0.9}, 1.5)};
    scene_.lights = {test::PointLight({0, 0, 10})};
  }

  // The floor z = 0, [-4, 4]^2: always object 0.
  void AddFloor(int material = 0) {
    scene_.objects.push_back(
        ObjectOf(test::Polygon({{-4, -4, 0}, {4, -4, 0}, {4, 4, 0}, {-4, 4, 0}}), material));
  }
  void Add(const Shape& shape, int material = 0) {
    scene_.objects.push_back(ObjectOf(shape, material));
  }

  // The cell of the given depth of `object` that holds the line through `point` along `direction`.
  Judgement Decide(int object, const Vec3d& point, const Vec3d& direction, int depth) {
    const Tracer tracer(scene_);
    const ObjectChart chart(scene_.objects[static_cast<size_t>(object)]);
    const int pair = chart.PairOf(direction);
    const auto coords = chart.CoordsOf(pair, point, direction);
    EXPECT_TRUE(coords.has_value());
    cell_ = CellAt(*coords, depth);
    Corners corners;
    RayCounts counts;
    for (int m = 0; m < kCellCorners; ++m) {
      corners[static_cast<size_t>(m)] = std::make_shared<CornerSample>(
          TraceCorner(tracer, object, chart, pair, CoordsOfGrid(cell_.Corner(m)), {}, counts));
    }
    return PaperJudge(tracer).Decide(corners);
  }

  Scene scene_;
  CellId cell_;
};

TEST_F(PaperJudgeTest, AnOpenFloorIsCertified) {
  AddFloor();
  const Judgement j = Decide(0, {1.1, 1.2, 0}, {0.1, 0.2, -1}, 4);
  ASSERT_EQ(j.verdict, Verdict::kCertified);
  EXPECT_GT(j.spread, 0);
  EXPECT_LT(j.spread, 0.2);
}

TEST_F(PaperJudgeTest, TheInterpolantIsWithinTheSpreadOfTheTruth) {
  AddFloor();
  const Tracer tracer(scene_);
  const ObjectChart chart(scene_.objects[0]);
  test::Random random(30);
  int certified = 0;
  for (int i = 0; i < 200; ++i) {
    const Vec3d point = random.InBox({-3.9, -3.9, 0}, {3.9, 3.9, 0});
    const Vec3d direction{random.Uniform(-0.9, 0.9), random.Uniform(-0.9, 0.9), -1};
    const Judgement j = Decide(0, point, direction, 4);
    if (j.verdict != Verdict::kCertified) continue;
    ++certified;
    const auto coords = chart.CoordsOf(chart.PairOf(direction), point, direction);
    const Rgb value = Evaluate(j.interpolant, LocalCoords(cell_, *coords));
    RayCounts counts;
    const Rgb truth = tracer.Radiance(point - direction, Normalized(direction), {}, counts);
    for (int c = 0; c < 3; ++c) ASSERT_LE(std::abs(value[c] - truth[c]), j.spread * truth[c]);
  }
  EXPECT_GT(certified, 150);
}

TEST_F(PaperJudgeTest, GapAtTheSilhouette) {
  AddFloor();
  EXPECT_NE(Decide(0, {3.999, 0, 0}, {0.5, 0, -1}, 2).verdict, Verdict::kGap)
      << "a rectangle fills its chart up to the edge";
  // A mirror that shows an edge.
  Add(test::Sphere({0, 0, 3}, 1), 2);
  EXPECT_EQ(Decide(1, {0.7, 0, 3.7}, {-0.1, 0, -1}, 2).verdict, Verdict::kGap);
  Add(test::Disc({0, 0, 7}, {0, 0, 1}, 1));
  EXPECT_EQ(Decide(2, {0.7, 0.7, 7}, {0.5, 0, -1}, 3).verdict, Verdict::kGap);
}

TEST_F(PaperJudgeTest, SelfShadowAtTheTerminator) {
  Add(test::Sphere({0, 0, 0}, 1));
  EXPECT_EQ(Decide(0, {0.995, 0, 0.1}, {-1, 0, 0}, 4).verdict, Verdict::kSelfShadow);
}

TEST_F(PaperJudgeTest, BlockerAtAShadowEdgeAndBetweenTheExtremalRays) {
  AddFloor();
  Add(test::Sphere({0, 0, 2}, 0.3));
  // Its shadow's edge is at a radius of about 0.375.
  EXPECT_EQ(Decide(0, {0.37, 0.01, 0}, {0.01, 0, -1}, 4).verdict, Verdict::kBlocker);
  // All sixteen corners of the root cell's children see the light, but the shadow lies inside.
  scene_.objects[1] = ObjectOf(test::Sphere({1, 1, 2}, 0.05));
  EXPECT_EQ(Decide(0, {1.1, 1.1, 0}, {0.02, 0.01, -1}, 2).verdict, Verdict::kBlocker);
}

TEST_F(PaperJudgeTest, DeepInAShadowOneOccluderServesAllCorners) {
  AddFloor();
  Add(test::Sphere({0, 0, 2}, 0.9));
  EXPECT_EQ(Decide(0, {0.3, 0.3, 0}, {0.8, 0.3, -1}, 5).verdict, Verdict::kCertified);
}

TEST_F(PaperJudgeTest, FunnelWhereRaysLeaveGlass) {
  Add(test::Sphere({0, 0, 0}, 1), 3);
  EXPECT_EQ(Decide(0, {0.2, 0.1, 0.97}, {0.02, 0.01, -1}, 6).verdict, Verdict::kFunnel);
}

TEST_F(PaperJudgeTest, PeakUnderAHighlight) {
  AddFloor(1);
  // Seen along the mirrored light ray.
  const Vec3d point{1.3, 0.7, 0};
  const Vec3d to_light = Normalized(Vec3d{0, 0, 10} - point);
  const Vec3d view{-to_light.x, -to_light.y, to_light.z};
  EXPECT_EQ(Decide(0, point, -view, 4).verdict, Verdict::kPeak);
  EXPECT_EQ(Decide(0, point, {0.9, 0.8, -1}, 6).verdict, Verdict::kCertified);
}

TEST_F(PaperJudgeTest, TheFootOfANearbyLightIsBrighterThanTheExtremalRays) {
  AddFloor();
  scene_.ambient = {0, 0, 0};
  scene_.lights = {test::PointLight({0.5, 0.5, 0.5})};
  // The cell about the foot of the light: all corners are equally far from it.
  const Vec3d foot{0.5, 0.5, 0};
  const Judgement j = Decide(0, foot, {0.01, 0.01, -1}, 3);
  ASSERT_EQ(j.verdict, Verdict::kCertified);
  double hi = 0;
  for (const auto& corner : j.interpolant.corner) hi = std::max<double>(hi, corner[0]);
  const double truth = scene_.materials[0].diffuse.r;  // n.l = 1
  EXPECT_GE(j.spread * hi, (truth - hi) * (1 - 1e-6));
  scene_.lights[0].fade_distance = 1;
  EXPECT_EQ(Decide(0, foot, {0.01, 0.01, -1}, 3).verdict, Verdict::kPeak);
}

TEST_F(PaperJudgeTest, BlockerBetweenAMirrorAndWhatItShows) {
  AddFloor(2);
  scene_.lights.clear();
  Add(test::Polygon({{-40, -40, 20}, {-40, 40, 20}, {40, 40, 20}, {40, -40, 20}}));
  EXPECT_EQ(Decide(0, {1, 1, 0}, {0.1, 0.1, -1}, 4).verdict, Verdict::kCertified);
  Add(test::Sphere({1.05, 1.05, 10}, 0.02));
  EXPECT_EQ(Decide(0, {1, 1, 0}, {0.1, 0.1, -1}, 4).verdict, Verdict::kBlocker);
}

TEST_F(PaperJudgeTest, LightThroughAFilmIsCertifiedAwayFromItsEdge) {
  AddFloor();
  Add(test::Polygon({{-2, -2, 3}, {2, -2, 3}, {2, 2, 3}, {-2, 2, 3}}), 3);
  EXPECT_EQ(Decide(0, {0.3, 0.3, 0}, {2, 0.3, -1}, 5).verdict, Verdict::kCertified);
  EXPECT_EQ(Decide(0, {2.9, 0.3, 0}, {2, 0.3, -1}, 4).verdict, Verdict::kBlocker);
}

TEST_F(PaperJudgeTest, TheSpreadIsThatOfTheWorstChannel) {
  AddFloor();
  scene_.ambient = {0, 0, 0};
  scene_.materials[0].diffuse = {1, 0, 0};
  const Judgement red = Decide(0, {1, 1, 0}, {0.1, 0.1, -1}, 3);
  ASSERT_EQ(red.verdict, Verdict::kCertified);
  double lo = 1e9, hi = 0;
  for (const auto& corner : red.interpolant.corner) {
    lo = std::min(lo, static_cast<double>(corner[0]));
    hi = std::max(hi, static_cast<double>(corner[0]));
    EXPECT_EQ(corner[1], 0);
  }
  EXPECT_NEAR(red.spread, (hi - lo) / lo, 1e-5);
}

}  // namespace
}  // namespace linetree
