#include "core/trace/intersect_quadric.h"

#include <gtest/gtest.h>

#include "core/trace/intersect.h"
#include "tests/support/random.h"
#include "tests/support/scene_builder.h"

namespace linetree {
namespace {

using test::Random;

Crossings<double> Cross(const Shape& shape, const Vec3d& origin, const Vec3d& direction) {
  return LineCrossings(shape, origin, direction);
}

// Rounding of a handful of operations on numbers of order one.
constexpr double kRounding = 0x1p-48;

TEST(Sphere, EntryAndExitAreTheTextbooks) {
  Random random(1);
  const Vec3d center{1, -2, 3};
  const double radius = 2.5;
  const Shape sphere = test::Sphere(center, radius);
  for (int k = 0; k < 20000; ++k) {
    const Vec3d origin = random.InCube(10);
    const Vec3d direction = random.Direction();
    // By the foot of the perpendicular from the centre.
    const double foot = Dot(center - origin, direction);
    const double miss = Length(origin + direction * foot - center);
    const auto crossings = Cross(sphere, origin, direction);
    if (std::abs(miss - radius) < 1e-9) continue;
    ASSERT_EQ(crossings.count, miss < radius ? 2 : 0);
    if (crossings.count == 0) continue;
    const double half = std::sqrt((radius - miss) * (radius + miss));
    const double tolerance = 10 * kRounding * (1 + radius / half);
    EXPECT_NEAR(crossings.at[0].t, foot - half, tolerance);
    EXPECT_NEAR(crossings.at[1].t, foot + half, tolerance);
    EXPECT_EQ(crossings.at[0].side, Side::kOutside);
    EXPECT_EQ(crossings.at[1].side, Side::kInside);
    EXPECT_TRUE(crossings.at[0].first_on_line);
    EXPECT_FALSE(crossings.at[1].first_on_line);
  }
}

TEST(Sphere, TangentLineTouchesOnce) {
  const auto crossings = Cross(test::Sphere({}, 1), {-5, 1, 0}, {1, 0, 0});
  ASSERT_EQ(crossings.count, 2);
  EXPECT_EQ(crossings.at[0].t, 5);
  EXPECT_EQ(crossings.at[1].t, 5);
  EXPECT_EQ(Cross(test::Sphere({}, 1), {-5, 1 + 1e-15, 0}, {1, 0, 0}).count, 0);
}

// Far away, b^2 - a c would lose every digit: a unit sphere from 1e9 away.
TEST(Sphere, FarOriginsKeepTheirDigits) {
  const Shape sphere = test::Sphere({}, 1);
  const double distance = 1e9;
  const auto inside = Cross(sphere, {-distance, 0.999, 0}, {1, 0, 0});
  ASSERT_EQ(inside.count, 2);
  EXPECT_NEAR(inside.at[1].t - inside.at[0].t, 2 * std::sqrt(1 - 0.999 * 0.999), 4e-7);
  EXPECT_EQ(Cross(sphere, {-distance, 1.001, 0}, {1, 0, 0}).count, 0);
}

// The cone x^2 + y^2 = (1 - z)^2, z in [0, 1], apex up.
Shape UnitCone(bool open) { return test::Frustum({0, 0, 0}, {0, 0, 1}, 1, 0, open); }

TEST(Frustum, LineThroughTheApexFromAbove) {
  const auto crossings = Cross(UnitCone(false), {0, 0, 5}, {0, 0, -1});
  ASSERT_EQ(crossings.count, 2);
  EXPECT_EQ(crossings.at[0].t, 4);
  EXPECT_EQ(crossings.at[1].t, 5);
  EXPECT_EQ(crossings.at[1].face, kBaseFace);
}

// A horizontal line through the apex touches it; one above misses both nappes' solid.
TEST(Frustum, LineOverTheApex) {
  const auto crossings = Cross(UnitCone(false), {-5, 0, 1}, {1, 0, 0});
  ASSERT_EQ(crossings.count, 2);
  EXPECT_EQ(crossings.at[0].t, 5);
  EXPECT_EQ(crossings.at[1].t, 5);
  EXPECT_EQ(Cross(UnitCone(false), {-5, 0, 1.001}, {1, 0, 0}).count, 0);
  EXPECT_EQ(Cross(UnitCone(true), {-5, 0, 1.5}, {1, 0, 0}).count, 0) << "the other nappe";
}

TEST(Frustum, NormalAtTheApexFacesTheRay) {
  const Vec3d direction = Normalized(Vec3d{1, 0, -2});
  EXPECT_NEAR(
      Length(FacingNormal(UnitCone(false), kLateralFace, Vec3d{0, 0, 1}, direction) + direction), 0,
      kRounding);
}

// a = 0: parallel to a generator, one crossing of the cone; the base closes the chord.
TEST(Frustum, LineParallelToAGenerator) {
  const Vec3d down = Normalized(Vec3d{1, 0, -1});  // along the generator at +x
  const auto crossings = Cross(UnitCone(false), {-0.75, 0, 0.75}, down);
  ASSERT_EQ(crossings.count, 2);
  EXPECT_EQ(crossings.at[0].face, kLateralFace);
  EXPECT_NEAR(crossings.at[0].t, 0.25 * std::sqrt(2), kRounding);
  EXPECT_EQ(crossings.at[1].face, kBaseFace);
  EXPECT_NEAR(crossings.at[1].t, 0.75 * std::sqrt(2), kRounding);
  EXPECT_EQ(Cross(UnitCone(true), {-0.75, 0, 0.75}, down).count, 1);
  EXPECT_EQ(Cross(UnitCone(false), {1, 0, 0.5}, down).count, 0) << "outside the generator";
  EXPECT_EQ(Cross(UnitCone(false), {0, 2, 1}, down).count, 0) << "beside the generator";
}

TEST(Frustum, LineParallelToTheAxisOfACylinder) {
  const Shape closed = test::Frustum({0, 0, 0}, {0, 0, 2}, 1, 1);
  const auto crossings = Cross(closed, {0.5, 0.5, -3}, {0, 0, 1});
  ASSERT_EQ(crossings.count, 2);
  EXPECT_EQ(crossings.at[0].face, kBaseFace);
  EXPECT_EQ(crossings.at[0].t, 3);
  EXPECT_EQ(crossings.at[1].face, kTopFace);
  EXPECT_EQ(crossings.at[1].t, 5);
  EXPECT_EQ(Cross(closed, {0.8, 0.8, -3}, {0, 0, 1}).count, 0);
  const Shape open = test::Frustum({0, 0, 0}, {0, 0, 2}, 1, 1, true);
  EXPECT_EQ(Cross(open, {0.5, 0.5, -3}, {0, 0, 1}).count, 0) << "through the tube";
}

TEST(Frustum, LineParallelToTheCaps) {
  const Shape closed = test::Frustum({0, 0, 0}, {0, 0, 2}, 1, 1);
  EXPECT_EQ(Cross(closed, {-5, 0, 1}, {1, 0, 0}).count, 2);
  EXPECT_EQ(Cross(closed, {-5, 0, 2.5}, {1, 0, 0}).count, 0);
  EXPECT_EQ(Cross(closed, {-5, 0, -0.5}, {1, 0, 0}).count, 0);
}

// Through the open end on to the far wall: seen from inside, and yet first on the line.
TEST(Frustum, OpenEndsLetRaysIn) {
  const Shape open = test::Frustum({0, 0, 0}, {0, 0, 2}, 1, 1, true);
  const Vec3d direction = Normalized(Vec3d{1, 0, -1});
  const auto crossings = Cross(open, {-0.5, 0, 2.5}, direction);
  ASSERT_EQ(crossings.count, 1);
  EXPECT_EQ(crossings.at[0].side, Side::kInside);
  EXPECT_TRUE(crossings.at[0].first_on_line);
  EXPECT_NEAR(crossings.at[0].t, 1.5 * std::sqrt(2), kRounding);
}

TEST(Frustum, FarWallFromInside) {
  const Shape open = test::Frustum({0, 0, 0}, {0, 0, 2}, 1, 1, true);
  const Vec3d start{-1, 0, 1};
  const auto far = CrossingsFromStart(open, start, Vec3d{1, 0, 0}, 0, Side::kInside);
  ASSERT_EQ(far.count, 1);
  EXPECT_EQ(far.at[0].t, 2);
  EXPECT_EQ(far.at[0].side, Side::kInside);
  EXPECT_FALSE(far.at[0].first_on_line);
  const Vec3d out = Normalized(Vec3d{1, 0, 1});  // leaves through the open top
  EXPECT_EQ(CrossingsFromStart(open, start, out, 0, Side::kInside).count, 0);
}

// An open frustum is the closed one without its caps, to the bit.
TEST(Frustum, OpenIsClosedWithoutCaps) {
  Random random(2);
  int both = 0, one = 0;
  for (int k = 0; k < 50000; ++k) {
    const double base_radius = random.Below(4) == 0 ? 0 : random.Uniform(0.1, 2);
    const double top_radius = random.Below(4) == 0 ? base_radius + 0.3 : random.Uniform(0.1, 2);
    const Vec3d base = random.InCube(2);
    const Vec3d top = base + random.Direction() * random.Uniform(0.3, 3);
    const Shape closed = test::Frustum(base, top, base_radius, top_radius);
    const Shape open = test::Frustum(base, top, base_radius, top_radius, true);
    const Vec3d origin = random.InCube(5);
    const Vec3d direction = (base + top) * 0.5 + random.InCube(1) - origin;
    std::vector<Crossing<double>> expected;
    for (const auto& crossing : Cross(closed, origin, direction)) {
      if (crossing.face == kLateralFace) expected.push_back(crossing);
    }
    const auto found = Cross(open, origin, direction);
    ASSERT_EQ(static_cast<size_t>(found.count), expected.size()) << "line " << k;
    (found.count == 2 ? both : one) += found.count > 0;
    for (int i = 0; i < found.count; ++i) {
      EXPECT_EQ(found.at[i].t, expected[static_cast<size_t>(i)].t);
      EXPECT_EQ(found.at[i].side, expected[static_cast<size_t>(i)].side);
      EXPECT_EQ(found.at[i].first_on_line, i == 0);
    }
  }
  EXPECT_GT(both, 5000);
  EXPECT_GT(one, 5000);
}

}  // namespace
}  // namespace linetree
