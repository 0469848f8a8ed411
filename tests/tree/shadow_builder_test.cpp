#include "core/tree/shadow_builder.h"

#include <gtest/gtest.h>

#include <random>

#include "core/trace/tracer.h"
#include "core/tree/candidate_search.h"
#include "core/tree/separation.h"
#include "tests/support/sanitizer_share.h"
#include "tests/support/scene_builder.h"

namespace linetree {
namespace {

using Rng = std::mt19937_64;

double Uniform(Rng& rng, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(rng);
}
Vec3d InBox(Rng& rng, double half) {
  return {Uniform(rng, -half, half), Uniform(rng, -half, half), Uniform(rng, -half, half)};
}
Vec3d UnitVector(Rng& rng) {
  for (;;) {
    const Vec3d v = InBox(rng, 1);
    if (LengthSquared(v) > 0.01 && LengthSquared(v) < 1) return Normalized(v);
  }
}

enum class Kind { kBox, kPolyhedron, kPolygon, kDisc, kBall, kCylinder, kCone };

Shape RandomPolygon(Rng& rng) {
  const Vec3d n = UnitVector(rng), x = Normalized(Cross(n, UnitVector(rng))), y = Cross(n, x);
  const Vec3d middle = InBox(rng, 0.5);
  const int count = 3 + static_cast<int>(rng() % 5);
  const double radius = Uniform(rng, 0.2, 1);
  std::vector<Vec3d> vertices;
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * 3.14159265358979 * (i + Uniform(rng, 0, 0.5)) / count;
    vertices.push_back(middle + (x * std::cos(angle) + y * std::sin(angle)) * radius);
  }
  return test::Polygon(vertices);
}

Shape RandomPolyhedron(Rng& rng) {
  std::vector<HalfSpace> faces;
  const Vec3d middle = InBox(rng, 0.5);
  for (int i = 0; i < 3; ++i) {
    Vec3d axis;
    axis[i] = 1;
    for (const double sign : {1.0, -1.0}) {
      const Vec3d n = Normalized(axis * sign + InBox(rng, 0.3));
      faces.push_back({n, Dot(n, middle) + Uniform(rng, 0.2, 0.6)});
    }
  }
  return test::Polyhedron(faces);
}

Shape RandomShape(Kind kind, Rng& rng) {
  const Vec3d p = InBox(rng, 0.6), q = p + UnitVector(rng) * Uniform(rng, 0.3, 1.2);
  const double r = Uniform(rng, 0.02, 0.5);
  switch (kind) {
    case Kind::kBox:
      return test::Box(
          p, p + Vec3d{Uniform(rng, 0.01, 1), Uniform(rng, 0.01, 1), Uniform(rng, 0.01, 1)});
    case Kind::kPolyhedron:
      return RandomPolyhedron(rng);
    case Kind::kPolygon:
      return RandomPolygon(rng);
    case Kind::kDisc:
      return test::Disc(p, UnitVector(rng), 2 * r);
    case Kind::kBall:
      return test::Sphere(p, r);
    case Kind::kCylinder:
      return test::Frustum(p, q, r, r);
    case Kind::kCone:
      return test::Frustum(p, q, r, rng() % 4 == 0 ? 0 : Uniform(rng, 0, 0.5));
  }
  return test::Sphere(p, r);
}

// A receiver, an occluder and a light, and what the tracer says about points of one cell.
class Case {
 public:
  Case(Kind kind, Rng& rng) {
    const Shape shape = RandomShape(kind, rng);
    Vec3d n = UnitVector(rng);
    Vec3d middle = n * Uniform(rng, -1.2, 1.2);
    if (rng() % 3 == 0) {  // the occluder stands on the receiver, or nearly so
      n = {0, 0, 1};
      middle = {0, 0, Bounds(shape).min.z + (rng() % 2 ? 0 : Uniform(rng, -1e-7, 1e-7))};
    }
    const Vec3d x = Normalized(Cross(n, UnitVector(rng))), y = Cross(n, x);
    scene_.materials = {test::Matte({1, 1, 1})};
    scene_.objects.push_back(
        test::ObjectOf(test::Polygon({middle - x * 2 - y * 2, middle + x * 2 - y * 2,
                                      middle + x * 2 + y * 2, middle - x * 2 + y * 2})));
    scene_.objects.push_back(test::ObjectOf(shape));
    scene_.lights.push_back(rng() % 3 == 0 ? test::DirectionalLight(UnitVector(rng))
                                           : test::PointLight(InBox(rng, rng() % 2 ? 2.5 : 40)));
    tracer_.emplace(scene_);
    const SurfaceChart chart(scene_.objects[0]);
    const auto depth = static_cast<int>(rng() % 6);
    const SurfaceCell where = CellAt({0, Uniform(rng, 0, 1), Uniform(rng, 0, 1)}, depth);
    cell_ = *chart.PlanarCellOf(0, where);
    const PatchHull hull = chart.HullOf(0, where);
    // All lengths are below 200.
    const double clearance = kFunctionClearance * 200;
    if (ShadowBuilder::MustBeOutside(shape) && !CertainlyApart(hull.points, shape, clearance)) {
      return;
    }
    everywhere_ = ShadowBuilder(cell_, scene_.lights[0])
                      .Build(shape, FacePlanesOf(shape), clearance, coefficients_, function_);
  }

  Shadowing Says(double s, double t) const {
    if (everywhere_ != Shadowing::kUnknown) return everywhere_;
    return ShadowingAt(function_, coefficients_.data(), static_cast<float>(s),
                       static_cast<float>(t));
  }
  bool IsBlocked(double s, double t, const Vec3d& off = {}) const {
    return tracer_->ObjectBlocks(1, cell_.corner + cell_.eu * s + cell_.ev * t + off, 0,
                                 {0, 0, Side::kOutside});
  }
  bool HasFunction() const { return everywhere_ != Shadowing::kUnknown || function_.pieces > 0; }
  Shadowing everywhere() const { return everywhere_; }
  double pad() const { return cell_.pad; }

 private:
  Scene scene_;
  std::optional<Tracer> tracer_;
  SurfaceChart::PlanarCell cell_;
  Shadowing everywhere_ = Shadowing::kUnknown;
  ShadowFunction function_;
  std::vector<float> coefficients_;
};

struct Tally {
  int cases = 0, functions = 0, decided = 0, border = 0, wrong = 0;
  int points = 0, unknown = 0;  // random points
};

bool Check(const Case& c, double s, double t, Rng& rng, Tally& tally) {
  const Shadowing says = c.Says(s, t);
  if (says == Shadowing::kUnknown) return false;
  const bool blocked = says == Shadowing::kBlocks;
  // Hits are off the plane by rounding, up to the pad.
  const bool is_wrong = c.IsBlocked(s, t) != blocked ||
                        c.IsBlocked(s, t, UnitVector(rng) * (0.5 * c.pad())) != blocked;
  tally.wrong += is_wrong ? 1 : 0;
  return true;
}

// Random points, and points about the shadow's border on a line between two of them.
Tally Compare(Kind kind, int cases, uint64_t seed) {
  Rng rng(seed);
  Tally tally;
  for (int i = 0; i < cases / test::kSanitizerShare; ++i) {
    const Case c(kind, rng);
    ++tally.cases;
    if (!c.HasFunction()) continue;
    ++tally.functions;
    tally.decided += c.everywhere() != Shadowing::kUnknown ? 1 : 0;
    for (int k = 0; k < 16; ++k) {
      double s[2] = {Uniform(rng, 0, 1), Uniform(rng, 0, 1)};
      double t[2] = {Uniform(rng, 0, 1), Uniform(rng, 0, 1)};
      ++tally.points;
      tally.unknown += Check(c, s[0], t[0], rng, tally) ? 0 : 1;
      if (c.IsBlocked(s[0], t[0]) == c.IsBlocked(s[1], t[1])) continue;
      ++tally.border;
      for (int bisection = 0; bisection < 50; ++bisection) {
        const double ms = (s[0] + s[1]) / 2, mt = (t[0] + t[1]) / 2;
        Check(c, ms, mt, rng, tally);
        const size_t side = c.IsBlocked(ms, mt) == c.IsBlocked(s[0], t[0]) ? 0 : 1;
        s[side] = ms;
        t[side] = mt;
      }
    }
  }
  return tally;
}

class ShadowBuilderTest : public testing::TestWithParam<Kind> {};

TEST_P(ShadowBuilderTest, NeverContradictsTheTracer) {
  const Tally tally = Compare(GetParam(), 20'000, 7);
  EXPECT_EQ(tally.wrong, 0);
  std::cout << tally.functions << " of " << tally.cases << " have a function, " << tally.decided
            << " are decided; " << tally.points << " points, " << tally.unknown
            << " of them unknown, " << tally.border << " borders\n";
  EXPECT_GT(tally.functions, tally.cases / 4);
  EXPECT_GT(tally.decided, tally.cases / 10);
  EXPECT_GT(tally.border, 1'000 / test::kSanitizerShare);
  EXPECT_LT(tally.unknown, tally.points / 200);
}

INSTANTIATE_TEST_SUITE_P(Shapes, ShadowBuilderTest,
                         testing::Values(Kind::kBox, Kind::kPolyhedron, Kind::kPolygon, Kind::kDisc,
                                         Kind::kBall, Kind::kCylinder, Kind::kCone));

}  // namespace
}  // namespace linetree
