#include "core/certify/diffuse_summer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <vector>

#include "core/trace/intersect.h"
#include "core/trace/shade.h"
#include "tests/support/climb.h"
#include "tests/support/every_target.h"
#include "tests/support/random_scene.h"

namespace linetree {
namespace {

// One object under many lights, all of them on; `fades`: all of them lamps that fade. `away`: from
// the world's origin.
Scene LitObject(test::ShapeKind kind, test::Random& random, bool fades = false, double away = 3) {
  Scene scene;
  test::AddMaterial(scene, test::Matte({0.5, 0.6, 0.7}));
  test::AddObject(scene, test::RandomShape(kind, random, 1, random.InCube(away)), 0);
  for (int i = 0; i < 12; ++i) {
    scene.lights.push_back(test::PointLight(
        scene.objects[0].bounds.Center() + random.Direction() * random.Uniform(1.5, 9),
        test::RandomRgb(random, 1)));
    if (!fades) continue;
    scene.lights.back().fade_distance = random.LogUniform(0.1, 30);
    scene.lights.back().fade_power = random.Below(2) == 0 ? 2 : random.Uniform(0.3, 8);
  }
  if (fades) return scene;
  scene.lights.push_back(test::DirectionalLight(random.Direction(), {0.3, 0.2, 0.1}));
  return scene;
}

CellLights AllOn(const Scene& scene) {
  CellLights lights;
  lights.lights.resize(scene.lights.size());
  for (LightList& list : lights.lights) list.knowledge = LightKnowledge::kOn;
  return lights;
}

// Of the lights that the cell says are summed.
Rgb ExactSum(const Scene& scene, const CellLights& cell, const Hit& hit) {
  Rgb sum;
  for (size_t i = 0; i < scene.lights.size(); ++i) {
    if (!cell.lights[i].summed) continue;
    const Light& light = scene.lights[i];
    const LightView<double> view = ViewOf(light, hit.point);
    const double cosine = Dot(hit.normal, view.to_light);
    if (cosine > 0) sum += Scaled(light.irradiance, cosine * view.fall_off);
  }
  return sum;
}

struct Seen {
  int sums = 0, points = 0;
  double largest = 0;  // error relative to the bound
};

// A hit moved as far off the surface as charts let it be; false where that is too far.
bool Displace(const Scene& scene, const SurfaceChart& chart, test::Random& random, Hit& hit) {
  const Vec3d facing = hit.normal;
  hit.point = hit.point + random.Direction() * (random.Uniform(0.4, 0.5) * chart.Slack());
  hit.normal = FacingNormal(scene.objects[0].shape, hit.face, hit.point, -facing);
  return chart.IsOn(hit.face, hit.point);
}

// Points of the object that random rays meet, each with the sum of its own cell.
void Check(const Scene& scene, int depth, test::Random& random, Seen& seen,
           bool displaced = false) {
  const Tracer tracer(scene);
  const DiffuseSummer summer(scene);
  const SurfaceChart chart(scene.objects[0]);
  std::map<std::tuple<int, uint32_t, uint32_t>, CellLights> cells;
  for (int i = 0; i < 300; ++i) {
    const Box3& bounds = scene.objects[0].bounds;
    const Vec3d eye = bounds.Center() + random.Direction() * 5;
    Hit hit = tracer.Intersect(eye, random.InBox(bounds.min, bounds.max) - eye, {});
    if (!hit.IsHit() || hit.side != Side::kOutside || !chart.IsOn(hit.face, hit.point)) continue;
    if (displaced && !Displace(scene, chart, random, hit)) continue;
    const SurfacePoint at = chart.Locate(hit.face, hit.point);
    const SurfaceCell cell = CellAt(at, depth);
    const auto [found, is_new] = cells.try_emplace({at.patch, cell.i, cell.j});
    if (is_new) {
      found->second = AllOn(scene);
      summer.AddSums(0, chart, at.patch, cell, found->second);
    }
    const auto& sum = found->second.sums[chart.IsOtherSide(hit.normal) ? 1 : 0];
    if (!sum) continue;
    ++seen.points;
    seen.sums += is_new ? 1 : 0;
    const double scale = std::ldexp(1.0, depth);
    const Rgb answer = sum->At(at.u * scale - cell.i, at.v * scale - cell.j);
    const Rgb exact = ExactSum(scene, found->second, hit);
    for (int c = 0; c < 3; ++c) {
      const double error = std::abs(answer[c] - exact[c]);
      ASSERT_LE(error, sum->spread * exact[c] + 1e-300) << "depth " << depth;
      seen.largest = std::max(seen.largest, error / (sum->spread * exact[c]));
    }
  }
}

TEST(DiffuseSummer, SumsAreWithinTheirBounds) {
  test::Random random(5);
  for (const test::ShapeKind kind : test::kShapeKinds) {
    Seen seen;
    for (int scene = 0; scene < 12; ++scene) {
      Scene lit = LitObject(kind, random);
      // One time in two there are lamps only, which are looked at side by side.
      if (scene % 2 == 1) lit.lights.pop_back();
      for (const int depth : {1, 3, 5}) Check(lit, depth, random, seen);
    }
    RecordProperty("largest_error_over_bound", std::to_string(seen.largest));
    EXPECT_GT(seen.points, 300);
    EXPECT_GT(seen.largest, 0.02) << "a bound that wide says nothing";
  }
}

TEST(DiffuseSummer, SumsOfFadingLightsAreWithinTheirBounds) {
  test::Random random(15);
  for (const test::ShapeKind kind : test::kShapeKinds) {
    Seen seen;
    for (int scene = 0; scene < 12; ++scene) {
      const Scene lit = LitObject(kind, random, true);
      for (const int depth : {1, 2, 3, 5}) Check(lit, depth, random, seen);
    }
    std::printf("%d sums, %d points, largest error / bound %.4f\n", seen.sums, seen.points,
                seen.largest);
    EXPECT_GT(seen.points, 300);
    EXPECT_GT(seen.largest, 0.02) << "a bound that wide says nothing";
  }
}

// Far from the world's origin charts let hits be far off the surface.
TEST(DiffuseSummer, SumsHoldForHitsOffTheSurface) {
  test::Random random(25);
  for (const test::ShapeKind kind : test::kShapeKinds) {
    Seen seen;
    for (int scene = 0; scene < 30; ++scene) {
      const double away = random.LogUniform(1e3, 1e6);
      const Scene lit = LitObject(kind, random, scene % 2 == 0, away);
      for (const int depth : {3, 7}) Check(lit, depth, random, seen, true);
    }
    EXPECT_GT(seen.points, 100);
    std::printf("%d points off the surface, largest error / bound %.4f\n", seen.points,
                seen.largest);
  }
}

// A rectangle 1 by `side` under one lamp, and a place on it.
struct LampCase {
  std::array<double, 6> x;  // side, lamp's x, y and height, place u and v
  double fade_distance = 0;

  // The sum's error relative to its bound, where that is one of interpolation and not of rounding.
  double ErrorOverBound() const {
    Scene scene;
    test::AddMaterial(scene, test::Matte({0.5, 0.5, 0.5}));
    const double side = std::abs(x[0]), height = std::abs(x[3]);
    test::AddObject(scene, test::Polygon({{0, 0, 0}, {1, 0, 0}, {1, side, 0}, {0, side, 0}}), 0);
    scene.lights.push_back(test::PointLight({x[1], x[2], height}));
    scene.lights[0].fade_distance = fade_distance;
    const SurfaceChart chart(scene.objects[0]);
    CellLights lights = AllOn(scene);
    DiffuseSummer(scene).AddSums(0, chart, 0, {}, lights);
    const int above = chart.IsOtherSide({0, 0, 1}) ? 1 : 0;
    const auto& sum = lights.sums[static_cast<size_t>(above)];
    if (!sum || !(sum->spread > 1e-4)) return 0;
    const auto plane = chart.PlanarCellOf(0, {});
    const double u = std::clamp(x[4], 0.0, 1.0), v = std::clamp(x[5], 0.0, 1.0);
    const Vec3d place = plane->corner + plane->eu * u + plane->ev * v;
    const LightView<double> view = ViewOf(scene.lights[0], place);
    const double exact = view.to_light.z * view.fall_off;
    return std::abs(sum->At(u, v).r - exact) / (sum->spread * exact);
  }
};

// The place where a bound is used up most, by climbing from random ones.
double WorstLampCase(double fade_distance, test::Random& random) {
  double worst = 0;
  for (int start = 0; start < 20; ++start) {
    LampCase best{{random.LogUniform(0.01, 2), random.Uniform(-6, 6), random.Uniform(-6, 6),
                   random.LogUniform(0.05, 6), random.Unit(), random.Unit()},
                  fade_distance};
    worst = std::max(worst, test::Climb(best, 1000, 1e-3, random,
                                        [](const LampCase& of) { return of.ErrorOverBound(); }));
  }
  EXPECT_LE(worst, 1);
  return worst;
}

// What interpolation adds to a bound cannot shrink to less than half before an answer breaks it.
// The rest is what cells have to be given that are neither square to the light nor narrow: the
// nearest distance for all of the cell (to the fifth power), and kLebesgue for the second axis.
TEST(DiffuseSummer, BoundsOnPlanesAreUsedUp) {
  test::Random random(21);
  for (const double fade_distance : {0.0, 0.3, 3.0}) {
    const double worst = WorstLampCase(fade_distance, random);
    std::printf("fade distance %.1f: largest error / bound %.3f\n", fade_distance, worst);
    EXPECT_GT(worst, 0.4);
  }
}

// The sums of some cells of the object, all of whose lights are on.
std::vector<DiffuseSum> SumsOf(const Scene& scene, DiffuseSummer::Lanes lanes) {
  const DiffuseSummer summer(scene, lanes);
  const SurfaceChart chart(scene.objects[0]);
  std::vector<DiffuseSum> sums;
  for (int patch = 0; patch < std::min(4, chart.patches()); ++patch) {
    for (uint32_t i = 0; i < 32; ++i) {
      CellLights lights = AllOn(scene);
      summer.AddSums(0, chart, patch, {5, i, 31 - i}, lights);
      sums.push_back(lights.sums[0] ? *lights.sums[0] : DiffuseSum{});
      if (lights.sums[0] == nullptr) sums.back().spread = -1;
    }
  }
  return sums;
}

TEST(DiffuseSummer, SumsOnCurvesAreTheSameOnEveryTarget) {
  test::Random random(6);
  for (const test::ShapeKind kind :
       {test::ShapeKind::kSphere, test::ShapeKind::kFrustum, test::ShapeKind::kSmoothTriangle}) {
    Scene scene = LitObject(kind, random);
    scene.lights[0].fade_distance = scene.lights[1].fade_distance = 3;
    scene.lights[1].fade_power = 1.5;
    const auto scalar = SumsOf(scene, DiffuseSummer::Lanes::kScalar);
    EXPECT_GT(std::count_if(scalar.begin(), scalar.end(),
                            [](const DiffuseSum& sum) { return sum.spread >= 0; }),
              8);
    test::ForEveryTarget([&](const char* target) {
      const auto simd = SumsOf(scene, DiffuseSummer::Lanes::kSimd);
      for (size_t i = 0; i < scalar.size(); ++i) {
        EXPECT_EQ(simd[i].spread, scalar[i].spread) << target;
        EXPECT_EQ(simd[i].value, scalar[i].value) << target;
      }
    });
  }
}

TEST(DiffuseSummer, AFloorUnderALampIsSummedByTheMetre) {
  Scene scene;
  test::AddMaterial(scene, test::Matte({0.5, 0.5, 0.5}));
  test::AddObject(scene, test::Polygon({{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}), 0);
  for (int i = 0; i < 4; ++i) scene.lights.push_back(test::PointLight({0.4 * i, 0.3 * i, 2.5}));
  CellLights lights = AllOn(scene);
  const SurfaceChart chart(scene.objects[0]);
  DiffuseSummer(scene).AddSums(0, chart, 0, {1, 1, 1}, lights);
  const auto& above = lights.sums[chart.IsOtherSide({0, 0, 1}) ? 1 : 0];
  ASSERT_TRUE(above);
  EXPECT_LT(above->spread, 0.03);
  EXPECT_TRUE(lights.lights[0].summed);
}

// The tracer gives a cone's apex a normal of its own.
TEST(DiffuseSummer, NoSumReachesAnApex) {
  Scene scene;
  test::AddMaterial(scene, test::Matte({0.5, 0.5, 0.5}));
  test::AddObject(scene, test::Frustum({0, 0, 0}, {0, 0, 1}, 1, 0), 0);
  for (int i = 0; i < 5; ++i) scene.lights.push_back(test::PointLight({3.0 + i, 1, 8}));
  const SurfaceChart chart(scene.objects[0]);
  const auto has_sum = [&](uint32_t row) {
    CellLights lights = AllOn(scene);
    DiffuseSummer(scene).AddSums(0, chart, 0, {3, 2, row}, lights);
    return lights.sums[0] != nullptr;
  };
  EXPECT_TRUE(has_sum(6));
  EXPECT_FALSE(has_sum(7));
}

TEST(DiffuseSummer, WhatItCannotBoundIsLeftAlone) {
  Scene scene;
  test::AddMaterial(scene, test::Matte({0.5, 0.5, 0.5}));
  test::AddObject(scene, test::Polygon({{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}), 0);
  const SurfaceChart chart(scene.objects[0]);
  const auto summed = [&] {
    CellLights lights = AllOn(scene);
    DiffuseSummer(scene).AddSums(0, chart, 0, {}, lights);
    return lights.sums[chart.IsOtherSide({0, 0, 1}) ? 1 : 0] != nullptr;
  };
  for (int i = 0; i < kMinSummedLights; ++i) {
    scene.lights.push_back(test::PointLight({0, 0, 4.0 + i}));
  }
  EXPECT_TRUE(summed());
  scene.lights.pop_back();
  EXPECT_FALSE(summed()) << "few are evaluated one by one";
  scene.lights.push_back(test::PointLight({0.1, 0, 0}));
  EXPECT_FALSE(summed()) << "a light in the plane itself";
  scene.lights.back() = test::PointLight({0, 0, 0.01});
  EXPECT_FALSE(summed()) << "a light so near that the bound is useless";
  scene.lights.back() = test::PointLight({0, 0, 9});
  scene.lights.back().fade_distance = 30;
  EXPECT_TRUE(summed());
  scene.lights.back() = test::PointLight({0, 0, 2.5});
  scene.lights.back().fade_power = 8;
  scene.lights.back().fade_distance = 1;
  EXPECT_FALSE(summed()) << "a fall-off so steep that the bound is useless";
}

}  // namespace
}  // namespace linetree
