#include "core/tree/surface_chart.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

#include "core/trace/tracer.h"
#include "tests/support/random_shapes.h"
#include "tests/support/scene_builder.h"

namespace linetree {
namespace {

using test::Random;
using test::ShapeKind;

// By how much x lies outside of the hull along n, relative to what doubles can tell: negative when
// n does not separate them.
double Beyond(const PatchHull& hull, const Vec3d& x, const Vec3d& n) {
  double most = -Box3::kInf, size = 0;
  for (const Vec3d& p : hull.points) {
    most = std::max(most, Dot(p - x, n));
    size = std::max(size, Length(p));
  }
  return -most - size * Length(n) * 0x1p-50;
}

// Directions that would separate something from a hull: its faces' normals, exactly what decides
// for eight points (all planes through three of them), and some at random.
std::vector<Vec3d> Separators(const PatchHull& hull, Random& random) {
  std::vector<Vec3d> normals;
  for (size_t i = 0; i < 8; ++i) {
    for (size_t j = i + 1; j < 8; ++j) {
      for (size_t k = j + 1; k < 8; ++k) {
        const Vec3d a = hull.points[j] - hull.points[i], b = hull.points[k] - hull.points[i];
        const Vec3d n = Cross(a, b);
        // Nearly collinear points give a direction like any other: none may separate.
        if (!(Length(n) > 0)) continue;
        normals.push_back(Normalized(n));
        normals.push_back(-normals.back());
      }
    }
  }
  for (int i = 0; i < 20; ++i) normals.push_back(random.Direction());
  return normals;
}

// x and the 26 points around it at 0.9 of the slack.
bool HoldsWithSlack(const PatchHull& hull, const Vec3d& x, double slack, Random& random) {
  for (const Vec3d& n : Separators(hull, random)) {
    for (int i = 0; i < 27; ++i) {
      const Vec3d to{i % 3 - 1.0, i / 3 % 3 - 1.0, i / 9 - 1.0};
      const Vec3d at = i == 13 ? x : x + Normalized(to) * (0.9 * slack);
      if (Beyond(hull, at, n) > 0) return false;
    }
  }
  return true;
}

double DiameterOf(const PatchHull& hull) {
  double diameter = 0;
  for (const Vec3d& p : hull.points) {
    for (const Vec3d& q : hull.points) diameter = std::max(diameter, Length(p - q));
  }
  return diameter;
}

void ExpectUnderItsCells(const SurfaceChart& chart, int face, const Vec3d& x, Random& random) {
  const SurfacePoint at = chart.Locate(face, x);
  ASSERT_GE(at.patch, 0);
  ASSERT_LT(at.patch, chart.patches());
  ASSERT_TRUE(at.u >= 0 && at.u <= 1 && at.v >= 0 && at.v <= 1) << at.u << " " << at.v;
  for (const int depth : {0, random.Int(1, 8), random.Int(9, kMaxSurfaceDepth)}) {
    const PatchHull hull = chart.HullOf(at.patch, CellAt(at, depth));
    ASSERT_TRUE(HoldsWithSlack(hull, x, chart.Slack(), random))
        << "face " << face << " patch " << at.patch << " depth " << depth << " u " << at.u << " v "
        << at.v;
  }
}

// Hits of random eye rays aimed at the object's box, some of them from inside.
template <class HitFn>
void ForHits(const Object& object, Random& random, int rays, HitFn&& fn) {
  Scene scene;
  scene.materials.resize(1);
  scene.objects = {object};
  const Tracer tracer(scene);
  const double size = Length(object.bounds.Extent());
  for (int i = 0; i < rays; ++i) {
    const Vec3d eye = object.bounds.Center() + random.Direction() * (size * random.Uniform(0.1, 9));
    const Vec3d target = random.InBox(object.bounds.min, object.bounds.max);
    const Hit hit = tracer.Intersect(eye, Normalized(target - eye), RayStart{});
    if (hit.IsHit()) fn(hit);
  }
}

struct Placing {
  const char* name;
  double size, distance;
};

class SurfaceChartTest : public testing::TestWithParam<Placing> {};

TEST_P(SurfaceChartTest, HitsLieInTheHullsOfTheirCells) {
  Random random(11);
  const auto [name, size, distance] = GetParam();
  for (const ShapeKind kind : test::kShapeKinds) {
    int hits = 0;
    for (int i = 0; i < 6; ++i) {
      const Vec3d center = random.Direction() * distance;
      const Object object = test::ObjectOf(test::RandomShape(kind, random, size, center));
      const SurfaceChart chart(object);
      ForHits(object, random, 40, [&](const Hit& hit) {
        if (HasFatalFailure()) return;
        ++hits;
        SCOPED_TRACE(std::string(test::NameOf(kind)) + " " + std::to_string(i) + ", seed 11");
        ExpectUnderItsCells(chart, hit.face, hit.point, random);
      });
      if (HasFatalFailure()) return;
    }
    EXPECT_GT(hits, 30) << test::NameOf(kind);
  }
}

INSTANTIATE_TEST_SUITE_P(Placings, SurfaceChartTest,
                         testing::Values(Placing{"AtOrigin", 1, 0}, Placing{"Small", 1e-6, 0},
                                         Placing{"Large", 1e6, 0}, Placing{"Away", 1, 1000},
                                         Placing{"FarAway", 1, 1e6},
                                         Placing{"SmallFarAway", 1e-6, 1e6}),
                         [](const auto& placing) { return placing.param.name; });

// Plates, poles and needles: the rounding of a hit counts more there than along their long sides.
TEST(SurfaceChartPointTest, FlatAndLongShapes) {
  Random random(16);
  for (const double thin : {1e-2, 1e-4, 1e-6}) {
    for (int turn = 0; turn < 4; ++turn) {
      const AffineMap map = Then(Rotation(random.Direction(), random.Uniform(0, 360)),
                                 Translation(random.Direction() * (turn * 5.0)));
      const Vec3d top{0.2, 0, 1};
      const std::vector<Shape> shapes = {
          test::Good(MakeEllipsoid({}, {1, 1, thin}, map)),
          test::Good(MakeEllipsoid({}, {thin, 1, thin}, map)),
          test::Good(MakeBox({-1, -1, 0}, {1, 1, thin}, map)),
          test::Good(MakeFrustum({{}, top, thin, thin, true}, map)),
          test::Good(MakeFrustum({{}, top, thin, thin / 3, false}, map)),
          test::Good(MakeFrustum({{}, top * thin, 1, 0, false}, map)),
          test::Good(MakeConvexPolygon({{0, 0, 0}, {1, 0, 0}, {0, thin, 0}}, map))};
      for (size_t i = 0; i < shapes.size(); ++i) {
        const Object object = test::ObjectOf(shapes[i]);
        const SurfaceChart chart(object);
        ForHits(object, random, 40, [&](const Hit& hit) {
          SCOPED_TRACE("shape " + std::to_string(i) + " thin " + std::to_string(thin));
          if (!HasFatalFailure()) ExpectUnderItsCells(chart, hit.face, hit.point, random);
        });
      }
    }
  }
}

// Hulls are no larger than they need to be: half as wide one level deeper, down to where the slack
// shows, and hardly wider than the cell.
TEST(SurfaceChartSizeTest, HullsShrinkWithTheirCells) {
  Random random(12);
  for (const ShapeKind kind : test::kShapeKinds) {
    const Object object = test::ObjectOf(test::RandomShape(kind, random, 1, {1, 2, 3}));
    const SurfaceChart chart(object);
    ForHits(object, random, 60, [&](const Hit& hit) {
      const SurfacePoint at = chart.Locate(hit.face, hit.point);
      double previous = 0;
      for (int depth = 2; depth <= kMaxSurfaceDepth; ++depth) {
        const double diameter = DiameterOf(chart.HullOf(at.patch, CellAt(at, depth)));
        if (depth > 2) {
          // A sheared cell's shorter diagonal may become the longer one, in curved charts.
          EXPECT_LT(diameter, 0.75 * previous) << test::NameOf(kind) << " depth " << depth;
        }
        previous = diameter;
      }
      EXPECT_LT(previous, 1e-5) << test::NameOf(kind);
    });
  }
}

// A flat-on square of a sphere is as thick as the cap that it is, not as the cell is wide.
TEST(SurfaceChartSizeTest, HullsOfCurvedCellsAreThin) {
  const Object sphere = test::ObjectOf(test::Sphere({}, 1));
  const SurfaceChart chart(sphere);
  for (int depth = 1; depth <= 14; ++depth) {
    const uint32_t middle = 1u << (depth - 1);
    const PatchHull hull = chart.HullOf(0, {static_cast<uint8_t>(depth), middle, middle});
    double low = Box3::kInf, high = -Box3::kInf;
    Vec3d c;
    for (const Vec3d& p : hull.points) c = c + p;
    for (const Vec3d& p : hull.points) {
      low = std::min(low, Dot(p, Normalized(c)));
      high = std::max(high, Dot(p, Normalized(c)));
    }
    const double half_diagonal = std::sqrt(2.0) / std::ldexp(1.0, depth) * (std::numbers::pi / 4);
    EXPECT_LT(high - low, half_diagonal * half_diagonal * 0.5 + 3 * chart.Slack()) << depth;
    EXPECT_GE(high, 1);
  }
}

TEST(SurfaceCellTest, ChildrenHoldWhatTheirParentHolds) {
  Random random(13);
  for (int i = 0; i < 2000; ++i) {
    const SurfacePoint point{0, random.Int(0, 9) == 0 ? 1.0 : random.Unit(), random.Unit()};
    SurfaceCell cell = CellAt(point, 0);
    EXPECT_EQ(cell, SurfaceCell{});
    for (int depth = 1; depth <= kMaxSurfaceDepth; ++depth) {
      const SurfaceCell next = CellAt(point, depth);
      const int child = (next.i > 2 * cell.i ? 1 : 0) + (next.j > 2 * cell.j ? 2 : 0);
      ASSERT_EQ(next, cell.Child(child));
      const double width = std::ldexp(1.0, -depth);
      ASSERT_LE(next.i * width, point.u);
      ASSERT_GE((next.i + 1) * width, point.u);
      ASSERT_LE(next.j * width, point.v);
      ASSERT_GE((next.j + 1) * width, point.v);
      cell = next;
    }
  }
}

// Points at which coordinates stop being unique, or exist at all.
TEST(SurfaceChartPointTest, ApexesRimsPolesAndBorders) {
  Random random(14);
  for (const double away : {0.0, 7.0, 1e6}) {
    const Vec3d at{away, -away / 3, away / 7};
    const auto check = [&](Shape shape, int face, const std::vector<Vec3d>& points) {
      const SurfaceChart chart(test::ObjectOf(std::move(shape)));
      for (const Vec3d& p : points) ExpectUnderItsCells(chart, face, at + p, random);
    };
    std::vector<Vec3d> poles, corners;
    for (int i = 0; i < 27; ++i) {
      const Vec3d p{i % 3 - 1.0, i / 3 % 3 - 1.0, i / 9 - 1.0};
      if (i != 13) poles.push_back(Normalized(p));
      if (p.x == 1) corners.push_back(p);
    }
    check(test::Sphere(at, 1), 0, poles);
    check(test::Box(at - Vec3d{1, 1, 1}, at + Vec3d{1, 1, 1}), 1, corners);
    const std::vector<Vec3d> rim = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
    check(test::Disc(at, {0, 0, 1}, 1), 0, rim);
    for (const bool open : {false, true}) {
      const Vec3d top = at + Vec3d{0, 0, 1};
      check(test::Frustum(at, top, 1, 0, open), 0, {{0, 0, 1}});
      check(test::Frustum(at, top, 1, 0, open), 0, rim);
      check(test::Frustum(at, top, 1, 1, open), 0, rim);
    }
    check(test::Frustum(at, at + Vec3d{0, 0, 1}, 1, 0), 1, rim);
    check(test::Frustum(at, at + Vec3d{0, 0, 1}, 1, 0), 2, {{0, 0, 1}});  // a cap of radius 0
    const std::vector<Vec3d> triangle = {{0, 0, 0}, {1, 0, 0}, {0.3, 0.9, 0}};
    std::vector<Vec3d> placed;
    for (const Vec3d& p : triangle) placed.push_back(at + p);
    check(test::Polygon(placed), 0, triangle);
  }
}

// What kSurfaceSlack is for. Nothing that charts promise rests on its size, for IsOn asks every
// hit; a smaller one would leave more of them out.
TEST(SurfaceChartPointTest, HitsFromFarAwayAreOnTheSurface) {
  Random random(19);
  for (const ShapeKind kind : test::kShapeKinds) {
    int hits = 0, on = 0;
    for (int i = 0; i < 400; ++i) {
      Scene scene;
      test::AddMaterial(scene, test::Matte({0.5, 0.5, 0.5}));
      test::AddObject(scene, test::RandomShape(kind, random, 1, random.InCube(3)), 0);
      const Object& object = scene.objects[0];
      const SurfaceChart chart(object);
      const double reach = Length(object.bounds.Extent()) + Length(object.bounds.Center());
      const Tracer tracer(scene);
      const Vec3d eye = object.bounds.Center() + random.Direction() * (0x1p17 * reach);
      const Vec3d target = random.InBox(object.bounds.min, object.bounds.max);
      const Hit hit = tracer.Intersect(eye, Normalized(target - eye), {});
      if (!hit.IsHit()) continue;
      ++hits;
      on += chart.IsOn(hit.face, hit.point) ? 1 : 0;
    }
    std::printf("%d of %d hits are on the surface\n", on, hits);
    EXPECT_GT(on, hits * 9 / 10);
  }
}

TEST(SurfaceChartPointTest, EveryPatchIsUsedAndNumberedAsTheHeaderSays) {
  Random random(15);
  const auto seen = [&](Shape shape) {
    const Object object = test::ObjectOf(std::move(shape));
    const SurfaceChart chart(object);
    std::set<int> patches;
    ForHits(object, random, 600,
            [&](const Hit& hit) { patches.insert(chart.Locate(hit.face, hit.point).patch); });
    EXPECT_EQ(static_cast<int>(patches.size()), chart.patches());
    return chart.patches();
  };
  EXPECT_EQ(seen(test::Sphere({}, 1)), 6);
  EXPECT_EQ(seen(test::Box({0, 0, 0}, {1, 2, 3})), 6);
  EXPECT_EQ(seen(test::Frustum({}, {0, 0, 1}, 1, 0.5)), 6);
  EXPECT_EQ(seen(test::Frustum({}, {0, 0, 1}, 1, 0.5, true)), 4);
  EXPECT_EQ(seen(test::Disc({}, {0, 0, 1}, 1)), 1);

  const SurfaceChart ball(test::ObjectOf(test::Sphere({}, 1)));
  EXPECT_EQ(ball.Locate(0, {0, -1, 0}).patch, 3);
  EXPECT_EQ(ball.Locate(0, {0, -1, 0}).u, 0.5);
  const SurfaceChart can(test::ObjectOf(test::Frustum({}, {0, 0, 1}, 1, 1)));
  EXPECT_EQ(can.Locate(1, {0, 0, 0}).patch, 4);
  EXPECT_EQ(can.Locate(2, {0, 0, 1}).patch, 5);
  EXPECT_EQ(can.Locate(0, {1, 0, 0.25}).v, 0.25);
}

}  // namespace
}  // namespace linetree
