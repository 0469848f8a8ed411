#include "core/io/split_polygon.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "core/scene/make_shape.h"

namespace linetree {
namespace {

using Loop = std::vector<Vec3d>;

PlanarLoop Checked(const Loop& vertices) {
  const auto loop = MakePlanarLoop(vertices);
  EXPECT_TRUE(loop.ok()) << loop.status();
  return *loop;
}

double AreaOf(const Loop& loop) { return Length(AreaVector(loop)) / 2; }

// The pieces are convex, as oriented as the polygon, cover its area and no more.
std::vector<Loop> CheckedPieces(const Loop& vertices) {
  const PlanarLoop loop = Checked(vertices);
  const auto pieces = SplitPolygon(loop);
  EXPECT_TRUE(pieces.ok()) << pieces.status();
  if (!pieces.ok()) return {};
  double area = 0;
  for (const Loop& piece : *pieces) {
    const auto shape = MakeConvexPolygon(piece);
    EXPECT_TRUE(shape.ok()) << shape.status();
    EXPECT_GT(Dot(AreaVector(piece), loop.normal), 0);
    area += AreaOf(piece);
  }
  EXPECT_NEAR(area, AreaOf(loop.vertices), 1e-9 * area);
  return *pieces;
}

// A star-shaped polygon: vertex i at angle 2 pi i / n.
Loop Ring(const std::vector<double>& radii) {
  Loop loop;
  for (size_t i = 0; i < radii.size(); ++i) {
    const double angle =
        2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(radii.size());
    loop.push_back({radii[i] * std::cos(angle), radii[i] * std::sin(angle), 0});
  }
  return loop;
}

TEST(SplitPolygon, KnownNumbersOfPieces) {
  // One reflex corner: two pieces.
  EXPECT_EQ(CheckedPieces({{0, 0, 0}, {2, 0, 0}, {1, 0.2, 0}, {1, 2, 0}}).size(), 2u);
  // An L.
  EXPECT_EQ(
      CheckedPieces({{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}}).size(), 2u);
  // A plus: four reflex corners, three pieces at best; Hertel and Mehlhorn promise at most 4 times.
  const auto plus = CheckedPieces({{1, 0, 0},
                                   {2, 0, 0},
                                   {2, 1, 0},
                                   {3, 1, 0},
                                   {3, 2, 0},
                                   {2, 2, 0},
                                   {2, 3, 0},
                                   {1, 3, 0},
                                   {1, 2, 0},
                                   {0, 2, 0},
                                   {0, 1, 0},
                                   {1, 1, 0}});
  EXPECT_GE(plus.size(), 3u);
  EXPECT_LE(plus.size(), 5u);
}

TEST(SplitPolygon, EitherOrientationAndAnyPlane) {
  const Loop flat{{0, 0, 0}, {2, 0, 0}, {1, 0.2, 0}, {1, 2, 0}};
  for (const auto& axes : {std::array{0, 1, 2}, std::array{1, 2, 0}, std::array{2, 0, 1},
                           std::array{1, 0, 2}, std::array{0, 2, 1}, std::array{2, 1, 0}}) {
    Loop loop;
    for (const Vec3d& v : flat) {
      Vec3d w;
      for (int i = 0; i < 3; ++i) w[axes[static_cast<size_t>(i)]] = v[i];
      loop.push_back(w + Vec3d{10, -20, 30});
    }
    EXPECT_EQ(CheckedPieces(loop).size(), 2u);
    EXPECT_EQ(CheckedPieces(Loop(loop.rbegin(), loop.rend())).size(), 2u);
  }
}

TEST(SplitPolygon, RandomStarsAndSpirals) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> radius(0.1, 1);
  for (int trial = 0; trial < 300; ++trial) {
    std::vector<double> radii(5 + trial % 60);
    for (double& r : radii) r = radius(random);
    CheckedPieces(Ring(radii));
  }
  // A spiral corridor: most corners of its inner side are reflex.
  Loop spiral;
  for (int i = 0; i <= 200; ++i) {
    const double angle = 0.1 * i;
    spiral.push_back({(1 + 0.2 * angle) * std::cos(angle), (1 + 0.2 * angle) * std::sin(angle), 0});
  }
  for (int i = 200; i >= 0; --i) {
    const double angle = 0.1 * i;
    spiral.push_back(
        {(0.7 + 0.2 * angle) * std::cos(angle), (0.7 + 0.2 * angle) * std::sin(angle), 0});
  }
  CheckedPieces(spiral);
}

TEST(SplitPolygon, CornersOnEdgesAndInLines) {
  // Teeth with collinear tips and bottoms.
  Loop comb{{0, 0, 0}, {9, 0, 0}};
  for (int i = 9; i > 0; --i) {
    comb.push_back({static_cast<double>(i), i % 2 ? 2.0 : 1.0, 0});
    comb.push_back({static_cast<double>(i - 1), i % 2 ? 2.0 : 1.0, 0});
  }
  CheckedPieces(comb);
  // Six decimal digits, as files have: vertices nearly on the line between their neighbours.
  CheckedPieces({{0, 0, 0}, {1, 0.000001, 0}, {2, 0, 0}, {2, 1, 0}, {1, 0.999999, 0}, {0, 1, 0}});
}

TEST(SplitPolygon, HolesOnABridge) {
  // A square with a square hole, reached along the edge (0,0) - (1,1) and back.
  const auto pieces = CheckedPieces({{0, 0, 0},
                                     {3, 0, 0},
                                     {3, 3, 0},
                                     {0, 3, 0},
                                     {0, 0, 0},
                                     {1, 1, 0},
                                     {1, 2, 0},
                                     {2, 2, 0},
                                     {2, 1, 0},
                                     {1, 1, 0}});
  double area = 0;
  for (const Loop& piece : pieces) area += AreaOf(piece);
  EXPECT_NEAR(area, 8, 1e-12);
}

TEST(SplitPolygon, CrossingsAreRefused) {
  for (const Loop& loop : {Loop{{0, 0, 0}, {2, 1, 0}, {2, 0, 0}, {0, 2, 0}},
                           Loop{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {2, -1, 0}, {0, 4, 0}}}) {
    const auto pieces = SplitPolygon(Checked(loop));
    EXPECT_EQ(pieces.status().code(), absl::StatusCode::kInvalidArgument);
    EXPECT_THAT(std::string(pieces.status().message()),
                testing::HasSubstr("does not cross itself"));
  }
  // A pentagram turns left everywhere.
  const Loop star = Ring({1, 1, 1, 1, 1});
  const PlanarLoop pentagram = Checked({star[0], star[2], star[4], star[1], star[3]});
  EXPECT_FALSE(pentagram.convex);
  EXPECT_FALSE(SplitPolygon(pentagram).ok());
}

TEST(Triangulate, IndicesOfTheLoop) {
  const PlanarLoop loop = Checked({{0, 0, 0}, {2, 0, 0}, {1, 0.2, 0}, {1, 2, 0}});
  const auto triangles = Triangulate(loop);
  ASSERT_TRUE(triangles.ok()) << triangles.status();
  EXPECT_EQ(triangles->size(), 2u);
  for (const auto& triangle : *triangles) {
    Loop corners;
    for (int i : triangle) corners.push_back(loop.vertices.at(static_cast<size_t>(i)));
    EXPECT_GT(Dot(AreaVector(corners), loop.normal), 0);
  }
}

}  // namespace
}  // namespace linetree
