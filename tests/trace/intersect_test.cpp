// Properties of every shape, under random affine maps and over twelve decades of size.
#include "core/trace/intersect.h"

#include <gtest/gtest.h>

#include <iostream>
#include <optional>

#include "tests/support/random.h"
#include "tests/support/random_shapes.h"

namespace linetree {
namespace {

using test::kShapeKinds;
using test::NameOf;
using test::Random;
using test::ShapeKind;
using Wide = long double;

constexpr uint64_t kSeed = 20260;
constexpr double kMinSize = 1e-6, kMaxSize = 1e6;
constexpr int kRaysPerKind = 100'000;
constexpr int kRaysPerShape = 100;
constexpr double kMaxDistance = 50;  // of centres and origins, in sizes

// How far, in sizes, a computed point may lie off its surface: some 30 roundings of coordinates of
// at most 2 * kMaxDistance sizes, magnified by the map's stretch.
constexpr double kOffSurface = 30 * 0x1p-53 * 2 * kMaxDistance * test::kMaxStretch;
// Where a line meets a surface at a smaller cosine it grazes: the distance along it is then not
// bounded by kOffSurface / cosine.
constexpr double kGrazing = 1e-2;

struct Sample {
  ShapeKind kind;
  Shape shape;
  double size;
  Vec3d center;
};

template <class Fn>
void ForEachSample(Fn&& fn) {
  for (const ShapeKind kind : kShapeKinds) {
    Random random(kSeed + static_cast<uint64_t>(kind));
    SCOPED_TRACE(testing::Message() << NameOf(kind) << ", seed " << kSeed);
    for (int i = 0; i < kRaysPerKind / kRaysPerShape; ++i) {
      const double size = random.LogUniform(kMinSize, kMaxSize);
      const Vec3d center = random.Direction() * (size * random.Uniform(0, kMaxDistance));
      const Sample sample{kind, RandomShape(kind, random, size, center), size, center};
      for (int k = 0; k < kRaysPerShape; ++k) fn(sample, random);
      if (testing::Test::HasFailure()) return;
    }
  }
}

// A ray from outside towards the shape, unit direction.
Ray RayTowards(const Sample& sample, Random& random) {
  const Vec3d origin =
      sample.center + random.Direction() * (sample.size * random.Uniform(2, kMaxDistance));
  const Vec3d target = sample.center + random.InCube(0.6 * sample.size);
  return {origin, Normalized(target - origin)};
}

Vec3d OnTheSideOf(const Vec3d& normal, const Vec3d& direction) {
  return Dot(direction, normal) < 0 ? -direction : direction;
}

// The solid is convex and the line leaves it, so what lies ahead in truth is rounding.
void ExpectNothingAhead(const Sample& sample, const Vec3d& point, const Vec3d& direction,
                        double cosine) {
  if (cosine < kGrazing) return;
  for (const auto& crossing :
       LineCrossings(sample.shape, CastVec3<Wide>(point), CastVec3<Wide>(direction))) {
    EXPECT_LT(static_cast<double>(crossing.t), kOffSurface * sample.size / cosine);
  }
}

// A ray that leaves a convex surface never meets it again.
TEST(Spawn, LeavingTheOutsideNeverReturns) {
  int hits = 0;
  ForEachSample([&](const Sample& sample, Random& random) {
    const Ray ray = RayTowards(sample, random);
    const auto crossings = RayCrossings(sample.shape, 0, ray.origin, ray.direction, {});
    if (crossings.count == 0 || crossings.at[0].side == Side::kInside) return;
    ++hits;
    const Vec3d point = ray.origin + ray.direction * crossings.at[0].t;
    const int face = crossings.at[0].face;
    const Vec3d normal = FacingNormal(sample.shape, face, point, ray.direction);
    const Vec3d away = OnTheSideOf(normal, random.Direction());
    const RayStart start{0, face, Side::kOutside};
    EXPECT_EQ(RayCrossings(sample.shape, 0, point, away, start).count, 0);
    if (sample.kind != ShapeKind::kSmoothTriangle) {
      ExpectNothingAhead(sample, point, away, Dot(away, normal));
    }
  });
  EXPECT_GT(hits, kRaysPerKind * 3);
}

// Whether a solid's face is plane: a ray inside cannot leave through the face that it starts on.
bool IsFlat(const Sample& sample, int face) {
  if (std::holds_alternative<FrustumShape>(sample.shape)) return face != kLateralFace;
  return !std::holds_alternative<SphereShape>(sample.shape);
}

// From a start on the inside there is exactly one exit, and it is where a wider type finds the far
// side; and so on, bounce after bounce, through grazing directions too.
TEST(Spawn, InsideStartsAlwaysExit) {
  int exits = 0, compared = 0;
  double worst = 0;
  ForEachSample([&](const Sample& sample, Random& random) {
    if (!IsSolid(sample.shape)) return;
    const Ray ray = RayTowards(sample, random);
    const auto entry = RayCrossings(sample.shape, 0, ray.origin, ray.direction, {});
    if (entry.count == 0) return;
    Vec3d point = ray.origin + ray.direction * entry.at[0].t;
    int face = entry.at[0].face;
    for (int bounce = 0; bounce < 3; ++bounce) {
      const Vec3d outward = FacingNormal(sample.shape, face, point, random.Direction());
      const Vec3d normal = Dot(outward, point - sample.center) > 0 ? -outward : outward;
      Vec3d inwards = OnTheSideOf(normal, random.Direction());
      // Every fourth grazes to within rounding.
      if (random.Below(4) == 0) inwards = Normalized(inwards - normal * Dot(inwards, normal));
      const auto exit = RayCrossings(sample.shape, 0, point, inwards, {0, face, Side::kInside});
      ASSERT_EQ(exit.count, 1);
      ASSERT_GE(exit.at[0].t, 0);
      ASSERT_EQ(exit.at[0].side, Side::kInside);
      ASSERT_FALSE(exit.at[0].first_on_line);
      if (IsFlat(sample, face)) {
        ASSERT_NE(exit.at[0].face, face);
      }
      ++exits;
      const auto truth =
          LineCrossings(sample.shape, CastVec3<Wide>(point), CastVec3<Wide>(inwards));
      const Vec3d end = point + inwards * exit.at[0].t;
      const double cosine =
          std::abs(Dot(FacingNormal(sample.shape, exit.at[0].face, end, inwards), inwards));
      if (Dot(inwards, normal) > kGrazing && cosine > kGrazing) {
        // At an edge the true line from the rounded point may miss the solid: it leaves at once.
        const Wide true_exit = truth.count == 2 ? truth.at[1].t : Wide(0);
        const double error = static_cast<double>(std::abs(true_exit - exit.at[0].t)) / sample.size;
        const double bound = kOffSurface / (cosine * Dot(inwards, normal));
        EXPECT_LT(error, bound);
        worst = std::max(worst, error / bound);
        ++compared;
      }
      point = end;
      face = exit.at[0].face;
    }
  });
  std::cout << exits << " exits, " << compared << " compared, largest error / bound " << worst
            << "\n";
  EXPECT_GT(compared, kRaysPerKind);
}

// Where on a line through an inner point the solid begins (sign = -1) or ends (+1): by bisection on
// the definition of "inside", in a wider type.
Wide Boundary(const Sample& sample, const Ray& ray, Wide inner, double sign) {
  const Vec3<Wide> origin = CastVec3<Wide>(ray.origin);
  const Vec3<Wide> direction = CastVec3<Wide>(ray.direction);
  Wide in = inner;
  Wide out = inner + Wide(sign) * 10 * sample.size;
  for (int i = 0; i < 70; ++i) {
    const Wide middle = (in + out) / 2;
    const bool inside = ContainsStrictly(sample.shape, Vec3<Wide>(origin + direction * middle));
    (inside ? in : out) = middle;
  }
  return (in + out) / 2;
}

// LineCrossings against the definition: lines through inner points are met at both ends of the
// chord, and every chord's middle is an inner point.
TEST(LineCrossings, AgreeWithTheDefinitionOfInside) {
  int through = 0, chords = 0;
  double worst = 0;
  ForEachSample([&](const Sample& sample, Random& random) {
    if (!IsSolid(sample.shape) || random.Below(4) != 0) return;
    const Ray ray = RayTowards(sample, random);
    const auto crossings = LineCrossings(sample.shape, ray.origin, ray.direction);
    const Vec3d inner = sample.center + random.InCube(0.5 * sample.size);
    if (crossings.count == 2 && crossings.at[1].t - crossings.at[0].t > 1e-3 * sample.size) {
      ++chords;
      const double middle = (crossings.at[0].t + crossings.at[1].t) / 2;
      EXPECT_TRUE(ContainsStrictly(sample.shape, Vec3d(ray.origin + ray.direction * middle)));
    }
    if (!ContainsStrictly(sample.shape, inner)) return;
    ++through;
    const Ray aimed{ray.origin, Normalized(inner - ray.origin)};
    const auto met = LineCrossings(sample.shape, aimed.origin, aimed.direction);
    const Wide t = Length(CastVec3<Wide>(inner) - CastVec3<Wide>(aimed.origin));
    if (!ContainsStrictly(sample.shape, Vec3<Wide>(CastVec3<Wide>(aimed.origin) +
                                                   CastVec3<Wide>(aimed.direction) * t))) {
      return;  // rounding of the aim left the solid
    }
    ASSERT_EQ(met.count, 2);
    for (int i = 0; i < 2; ++i) {
      const Wide truth = Boundary(sample, aimed, t, i == 0 ? -1 : 1);
      const Vec3d point = aimed.origin + aimed.direction * met.at[i].t;
      const double cosine = std::abs(
          Dot(FacingNormal(sample.shape, met.at[i].face, point, aimed.direction), aimed.direction));
      if (cosine < kGrazing) continue;
      const double error = static_cast<double>(std::abs(truth - met.at[i].t)) / sample.size;
      EXPECT_LT(error, kOffSurface / cosine);
      worst = std::max(worst, error * cosine / kOffSurface);
    }
  });
  std::cout << through << " through inner points, " << chords << " chords, largest error / bound "
            << worst << "\n";
  EXPECT_GT(through, 10000);
  EXPECT_GT(chords, 10000);
}

// Normals are unit, face the ray, and point along the gradient: a step against the normal is
// inside, a step along it outside.
TEST(FacingNormal, PointsOutOfTheSolid) {
  ForEachSample([&](const Sample& sample, Random& random) {
    if (random.Below(4) != 0) return;
    const Ray ray = RayTowards(sample, random);
    const auto crossings = RayCrossings(sample.shape, 0, ray.origin, ray.direction, {});
    if (crossings.count == 0) return;
    const Vec3d point = ray.origin + ray.direction * crossings.at[0].t;
    const Vec3d normal = FacingNormal(sample.shape, crossings.at[0].face, point, ray.direction);
    EXPECT_NEAR(Length(normal), 1, 0x1p-50);
    EXPECT_LE(Dot(normal, ray.direction), 0);
    if (!IsSolid(sample.shape) || -Dot(normal, ray.direction) < kGrazing) return;
    const double step = 1e-9 * sample.size;
    EXPECT_FALSE(ContainsStrictly(sample.shape, Vec3d(point + normal * step)));
  });
}

// A ray that starts inside a solid without being on it (an eye in glass) meets the far side.
TEST(RayCrossings, FreeStartInsideMeetsTheFarSide) {
  int inside = 0;
  ForEachSample([&](const Sample& sample, Random& random) {
    if (!IsSolid(sample.shape) || random.Below(8) != 0) return;
    const Vec3d origin = sample.center + random.InCube(0.5 * sample.size);
    if (!ContainsStrictly(sample.shape, origin)) return;
    ++inside;
    const auto crossings = RayCrossings(sample.shape, 0, origin, random.Direction(), {});
    ASSERT_EQ(crossings.count, 1);
    EXPECT_EQ(crossings.at[0].side, Side::kInside);
    EXPECT_FALSE(crossings.at[0].first_on_line);
  });
  EXPECT_GT(inside, 10000);
}

TEST(ContainsStrictly, IsFalseForSurfaces) {
  EXPECT_FALSE(ContainsStrictly(test::Disc({}, {0, 0, 1}, 1), Vec3d{}));
  EXPECT_FALSE(ContainsStrictly(test::Frustum({}, {0, 0, 1}, 1, 1, true), Vec3d{0, 0, 0.5}));
  EXPECT_TRUE(ContainsStrictly(test::Frustum({}, {0, 0, 1}, 1, 1), Vec3d{0, 0, 0.5}));
}

}  // namespace
}  // namespace linetree
