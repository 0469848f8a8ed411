#include "core/scene/planar_loop.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace linetree {
namespace {

using Loop = std::vector<Vec3d>;

TEST(PlanarLoop, ConvexEitherWayRound) {
  const Loop square{{0, 0, 2}, {1, 0, 2}, {1, 1, 2}, {0, 1, 2}};
  const auto loop = MakePlanarLoop(square);
  ASSERT_TRUE(loop.ok()) << loop.status();
  EXPECT_TRUE(loop->convex);
  EXPECT_EQ(loop->vertices, square);
  EXPECT_EQ(loop->normal, (Vec3d{0, 0, 1}));
  const auto other = MakePlanarLoop(Loop(square.rbegin(), square.rend()));
  EXPECT_TRUE(other->convex);
  EXPECT_EQ(other->normal, (Vec3d{0, 0, -1}));
}

TEST(PlanarLoop, ConcaveAndStarsAreNotConvex) {
  EXPECT_FALSE(MakePlanarLoop({{0, 0, 0}, {2, 0, 0}, {1, 0.2, 0}, {1, 2, 0}})->convex);
  Loop star;
  for (int i = 0; i < 5; ++i) {
    const double angle = 2 * std::numbers::pi * 2 * i / 5;
    star.push_back({std::cos(angle), std::sin(angle), 0});
  }
  EXPECT_FALSE(MakePlanarLoop(star)->convex);
  Loop round;
  for (int i = 0; i < 1000; ++i) {
    const double angle = 2 * std::numbers::pi * i / 1000;
    round.push_back({std::cos(angle), 3, std::sin(angle)});
  }
  const auto disc = MakePlanarLoop(round);
  EXPECT_TRUE(disc->convex);
  EXPECT_EQ(disc->vertices.size(), 1000u);
}

TEST(PlanarLoop, IdleVerticesAreDropped) {
  // A repeated corner, a corner within an edge, a spike, the first corner again at the end.
  const auto loop = MakePlanarLoop({{0, 0, 0},
                                    {1, 0, 0},
                                    {2, 0, 0},
                                    {2, 0, 0},
                                    {2, 2, 0},
                                    {1, 2, 0},
                                    {1, 5, 0},
                                    {1, 2, 0},
                                    {0, 2, 0},
                                    {0, 0, 0}});
  ASSERT_TRUE(loop.ok()) << loop.status();
  EXPECT_EQ(loop->vertices.size(), 4u);
  EXPECT_TRUE(loop->convex);
}

TEST(PlanarLoop, SixDigitsArePlanarEnough) {
  // A tilted square, printed with six significant digits.
  const auto loop = MakePlanarLoop({{1.23457, 0.333333, 7.77778},
                                    {2.23457, 0.333333, 8.27779},
                                    {2.23457, 1.33333, 7.97778},
                                    {1.23457, 1.33333, 7.47778}});
  ASSERT_TRUE(loop.ok()) << loop.status();
  EXPECT_TRUE(loop->convex);
  // The vertices that remain are planar to rounding.
  for (const Vec3d& v : loop->vertices) {
    EXPECT_NEAR(Dot(v - loop->vertices[0], loop->normal), 0, 1e-14);
  }
}

TEST(PlanarLoop, ToleranceIsKept) {
  const auto bent = [](double by) {
    return MakePlanarLoop({{0, 0, 0}, {1, 0, 0}, {1, 1, by}, {0, 1, 0}});
  };
  EXPECT_TRUE(bent(0.5 * kPlanarityTolerance).ok());
  EXPECT_FALSE(bent(4 * kPlanarityTolerance).ok());
}

TEST(PlanarLoop, DegenerateLoopsAreRefused) {
  EXPECT_FALSE(MakePlanarLoop({{0, 0, 0}, {1, 0, 0}}).ok());
  EXPECT_FALSE(MakePlanarLoop({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}).ok());
  EXPECT_FALSE(MakePlanarLoop({{1, 2, 3}, {1, 2, 3}, {1, 2, 3}}).ok());
  EXPECT_FALSE(MakePlanarLoop({{0, 0, 0}, {1, 0, 0}, {0.5, 1e-14, 0}}).ok());
  EXPECT_TRUE(MakePlanarLoop({{0, 0, 0}, {1, 0, 0}, {0.5, 1e-10, 0}}).ok());
  EXPECT_FALSE(MakePlanarLoop({{0, 0, 0}, {NAN, 0, 0}, {0, 1, 0}}).ok());
  // Equal areas to both sides.
  EXPECT_FALSE(MakePlanarLoop({{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}}).ok());
}

TEST(PlanarLoop, FarFromTheOrigin) {
  const Vec3d far{1e6, -2e6, 3e6};
  const auto loop = MakePlanarLoop(
      {far, far + Vec3d{1, 0, 0}, far + Vec3d{1, 0.5, 0.5}, far + Vec3d{0.5, 0.25, 0.25}});
  ASSERT_TRUE(loop.ok()) << loop.status();
  // The last corner lies on the diagonal.
  EXPECT_EQ(loop->vertices.size(), 3u);
}

}  // namespace
}  // namespace linetree
