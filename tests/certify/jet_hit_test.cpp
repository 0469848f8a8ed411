// Hits in jets are held against those of single rays in long double: every shape and face, from
// outside and from inside.
#include <gtest/gtest.h>

#include <cstdio>
#include <map>

#include "core/certify/hit_evaluator-inl.h"
#include "core/trace/tracer.h"
#include "tests/support/random_scene.h"

namespace linetree::test {
namespace {

using Wide = long double;
using WideVec = Vec3<Wide>;
using Jet = scalar_jets::CornerJet<4>;
using JetVec = scalar_jets::JetVector<4>;
using Coords = std::array<double, 4>;

// What jets of a shape and its rays may differ by relative to the lengths involved: both are made
// of the same parameters in double, by other formulas.
constexpr double kShapeRounding = 1e-13;

// Rays from a parallelogram to a parallelogram.
struct Rays {
  Vec3d from, from_by[2], to, to_by[2];

  scalar_jets::JetRay<4> Jets() const {
    const auto affine = [&](double Vec3d::*axis, bool difference) {
      Coords by{0, 0, 0, 0};
      for (size_t i = 0; i < 2; ++i) {
        by[i] = difference ? -(from_by[i].*axis) : from_by[i].*axis;
        if (difference) by[i + 2] = to_by[i].*axis;
      }
      return Jet::Affine(difference ? (to - from).*axis : from.*axis, by, {0, 0, 0, 0},
                         {1, 1, 1, 1});
    };
    scalar_jets::JetRay<4> ray;
    ray.origin = {affine(&Vec3d::x, false), affine(&Vec3d::y, false), affine(&Vec3d::z, false)};
    const JetVec way{affine(&Vec3d::x, true), affine(&Vec3d::y, true), affine(&Vec3d::z, true)};
    ray.direction = way * InverseSquareRoot(Jet(LengthSquared(way)));
    return ray;
  }
  void At(const Coords& u, WideVec& origin, WideVec& direction) const {
    origin = CastVec3<Wide>(from) + CastVec3<Wide>(from_by[0]) * Wide(u[0]) +
             CastVec3<Wide>(from_by[1]) * Wide(u[1]);
    const WideVec end = CastVec3<Wide>(to) + CastVec3<Wide>(to_by[0]) * Wide(u[2]) +
                        CastVec3<Wide>(to_by[1]) * Wide(u[3]);
    direction = Normalized(end - origin);
  }
};

// From a place outside of the object to a place at it.
Rays RandomRays(Random& random, const Box3& bounds) {
  const double size = Length(bounds.Extent()), spread = size * random.LogUniform(1e-4, 0.1);
  Rays rays;
  rays.from = bounds.Center() + random.Direction() * (size * random.Uniform(1, 3));
  rays.to = random.InBox(bounds.min, bounds.max);
  for (size_t i = 0; i < 2; ++i) {
    rays.from_by[i] = random.InCube(spread);
    rays.to_by[i] = random.InCube(spread);
  }
  return rays;
}

Coords RandomCoords(Random& random) {
  Coords u;
  for (double& x : u) x = random.Below(2) == 0 ? random.Unit() : random.Below(2);
  return u;
}

// f(u) within the jet's range, and as far from the interpolant as the jet says at most.
void ExpectHolds(const Jet& jet, const Coords& u, Wide f, double tolerance, const char* what) {
  ASSERT_GE(f, jet.lo() - tolerance) << what;
  ASSERT_LE(f, jet.hi() + tolerance) << what;
  double corners[16];
  jet.k.Store(corners);
  Wide sum = 0;
  for (size_t m = 0; m < 16; ++m) {
    Wide weight = 1;
    for (size_t i = 0; i < 4; ++i) weight *= (m >> i & 1) != 0 ? Wide(u[i]) : 1 - Wide(u[i]);
    sum += weight * corners[m];
  }
  ASSERT_LE(std::abs(sum - f), jet.InterpolationError() + tolerance) << what;
}
void ExpectHolds(const JetVec& jets, const Coords& u, const WideVec& v, double tolerance,
                 const char* what) {
  ExpectHolds(jets.x, u, v.x, tolerance, what);
  ExpectHolds(jets.y, u, v.y, tolerance, what);
  ExpectHolds(jets.z, u, v.z, tolerance, what);
}

struct Seen {
  int evaluated = 0, contained = 0, straddling = 0;
};

class JetHitTest : public testing::TestWithParam<ShapeKind> {
 protected:
  void SetShape(const AffineMap& map) {
    AddMaterial(scene_, Matte({1, 1, 1}));
    AddObject(scene_, RandomShape(GetParam(), random_, map));
    shape_ = MakeJetShape(scene_.objects[0]);
    tolerance_ = kShapeRounding * shape_.reach * kMaxStretch;
  }

  // One hit of jets against many of single rays. `trace` gives the hit of the ray at u.
  template <class TraceFn>
  void Compare(const scalar_jets::HitEvaluator<4>& evaluator, const scalar_jets::JetHit<4>& hit,
               const Hit& middle, TraceFn&& trace) {
    const bool contained = evaluator.IsContained(hit);
    Seen& seen = seen_[{middle.face, middle.side == Side::kInside}];
    ++seen.evaluated;
    seen.contained += contained;
    bool misses = false;
    for (int n = 0; n < 40; ++n) {
      const Coords u = RandomCoords(random_);
      WideVec direction;
      const HitOf<Wide> truth = trace(u, direction);
      const bool same = truth.IsHit() && truth.face == middle.face && truth.side == middle.side;
      misses |= !same;
      ASSERT_TRUE(same || !contained) << "face " << middle.face;
      if (!same) continue;
      ExpectHolds(hit.point, u, truth.point, tolerance_, "point");
      // Normals of steep cones turn fast about the apex, which is in no contained cell.
      if (!contained) continue;
      const double sharp = 1e3 * tolerance_;
      ExpectHolds(hit.cosine, u, -Dot(direction, truth.normal), sharp, "cosine");
      if (hit.flat) {
        ASSERT_LE(Length(truth.normal - CastVec3<Wide>(hit.flat_normal)), sharp);
      } else {
        ExpectHolds(hit.normal, u, truth.normal, sharp, "normal");
      }
      if (hit.curved) {
        const WideVec way = CastVec3<Wide>(place_) - truth.point;
        ExpectHolds(hit.CurvedFacing(place_), u, Dot(truth.normal, way), sharp, "facing");
        ExpectHolds(hit.CurvedFacingTo(place_), u, Dot(truth.normal, CastVec3<Wide>(place_)), sharp,
                    "facing to");
      }
      if (testing::Test::HasFatalFailure()) return;
    }
    seen.straddling += misses;
  }

  void TryRays() {
    const Rays rays = RandomRays(random_, scene_.objects[0].bounds);
    const Tracer tracer(scene_);
    const TracerOf<Wide> wide(scene_);
    WideVec o, d;
    rays.At({0.5, 0.5, 0.5, 0.5}, o, d);
    const Hit middle = tracer.Intersect(CastVec3<double>(o), CastVec3<double>(d), RayStart());
    if (!middle.IsHit()) return;
    const scalar_jets::JetRay<4> ray = rays.Jets();
    const scalar_jets::HitEvaluator<4> evaluator(ray);
    scalar_jets::JetHit<4> hit;
    if (!evaluator.Evaluate(shape_, middle.face, middle.side, -1, hit)) return;
    Compare(evaluator, hit, middle, [&](const Coords& u, WideVec& direction) {
      WideVec origin;
      rays.At(u, origin, direction);
      return wide.Intersect(origin, direction, RayStart());
    });
    if (HasFatalFailure() || !IsSolid(scene_.objects[0].shape)) return;
    if (evaluator.IsContained(hit)) TryInside(rays, ray, hit, middle);
  }

  // Straight on, through the solid.
  void TryInside(const Rays& rays, const scalar_jets::JetRay<4>& ray,
                 const scalar_jets::JetHit<4>& hit, const Hit& middle) {
    const Tracer tracer(scene_);
    const TracerOf<Wide> wide(scene_);
    const RayStart inside{0, middle.face, Side::kInside};
    WideVec o, d;
    rays.At({0.5, 0.5, 0.5, 0.5}, o, d);
    const Hit exit = tracer.Intersect(middle.point, CastVec3<double>(d), inside);
    if (!exit.IsHit()) return;
    const scalar_jets::JetRay<4> onward{hit.point, ray.direction, false};
    const scalar_jets::HitEvaluator<4> evaluator(onward);
    scalar_jets::JetHit<4> out;
    if (!evaluator.Evaluate(shape_, exit.face, exit.side, middle.face, out)) return;
    Compare(evaluator, out, exit, [&](const Coords& u, WideVec& direction) {
      WideVec origin;
      rays.At(u, origin, direction);
      const HitOf<Wide> entry = wide.Intersect(origin, direction, RayStart());
      return wide.Intersect(entry.point, direction, inside);
    });
  }

  Random random_{7 + static_cast<uint64_t>(GetParam())};
  Scene scene_;
  JetShape shape_;
  double tolerance_ = 0;
  const Vec3d place_ = random_.InCube(6);
  std::map<std::pair<int, bool>, Seen> seen_;  // by face, and whether from inside
};

TEST_P(JetHitTest, HoldsTheHitsOfItsRays) {
  SetShape(RandomMap(random_, 1, random_.InCube(2)));
  for (int i = 0; i < 1500; ++i) {
    TryRays();
    ASSERT_FALSE(HasFatalFailure()) << "bundle " << i;
  }
  for (const auto& [face, seen] : seen_) {
    std::printf("%s, face %d from %s: %d evaluated, %d contained, %d not all on the face\n",
                std::string(NameOf(GetParam())).c_str(), face.first,
                face.second ? "inside" : "outside", seen.evaluated, seen.contained,
                seen.straddling);
    // Whatever is not contained straddles an edge, or nearly.
    EXPECT_LE(seen.contained + seen.straddling, seen.evaluated);
    EXPECT_TRUE(seen.contained > 0 || seen.evaluated < 50);
  }
  EXPECT_FALSE(seen_.empty());
}

// Of spheres and round frustums more is known.
TEST_P(JetHitTest, HoldsThoseOfShapesThatAreNotSkewed) {
  const double size = random_.Uniform(0.4, 0.8);
  const AffineMap turned =
      Then(Scaling({size, size, size}), Rotation(random_.Direction(), random_.Uniform(0, 360)));
  SetShape(Then(turned, Translation(random_.InCube(2))));
  EXPECT_EQ(shape_.radius > 0, GetParam() == ShapeKind::kSphere);
  EXPECT_EQ(shape_.slant > 0, shape_.kind == JetShape::Kind::kFrustum);
  int contained = 0;
  for (int i = 0; i < 500; ++i) {
    TryRays();
    ASSERT_FALSE(HasFatalFailure()) << "bundle " << i;
  }
  for (const auto& [face, seen] : seen_) contained += seen.contained;
  EXPECT_GT(contained, 50);
}

INSTANTIATE_TEST_SUITE_P(Shapes, JetHitTest, testing::ValuesIn(kShapeKinds), [](const auto& info) {
  std::string name(NameOf(info.param));
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
});

}  // namespace
}  // namespace linetree::test
