// Diffuse light on triangles with vertex normals; that on other curved cells is in
// diffuse_summer_test.cpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>

#include "core/certify/curved_cell-inl.h"
#include "core/certify/diffuse_summer.h"
#include "core/trace/intersect.h"
#include "core/trace/shade.h"
#include "tests/support/climb.h"
#include "tests/support/random_scene.h"

namespace linetree {
namespace {

CellLights LitByAll(const Scene& scene) {
  CellLights lights;
  lights.lights.resize(scene.lights.size());
  for (LightList& list : lights.lights) list.knowledge = LightKnowledge::kOn;
  return lights;
}

using Wide = long double;

// A triangle with vertex normals under one lamp or the sun, and a place on it.
struct SmoothCase {
  std::array<double, 14> x;  // two numbers a vertex normal, lamp, fade distance, vertex, place
  bool is_sun = false, fades = false;

  Scene Build() const {
    Scene scene;
    test::AddMaterial(scene, test::Matte({0.5, 0.5, 0.5}));
    const std::vector<Vec3d> normals{{x[0], x[1], 1}, {x[2], x[3], 1}, {x[4], x[5], 1}};
    const std::vector<Vec3d> vertices{{0, 0, 0}, {1, 0, 0}, {x[10], 0.1 + std::abs(x[11]), 0}};
    test::AddObject(scene, test::SmoothTriangle(vertices, normals), 0);
    const Vec3d to_light{x[6], x[7], 0.2 + std::abs(x[8])};
    scene.lights.push_back(is_sun ? test::DirectionalLight(Normalized(to_light))
                                  : test::PointLight(to_light));
    if (fades) scene.lights[0].fade_distance = 0.05 + std::abs(x[9]);
    return scene;
  }
  // The sum's error relative to its bound, where that is one of interpolation and not of rounding.
  double ErrorOverBound() const {
    const Scene scene = Build();
    const auto& triangle = std::get<TriangleShape>(scene.objects[0].shape);
    const SurfaceChart chart(scene.objects[0]);
    const double b = std::clamp(x[12], 0.0, 1.0), c = std::clamp(x[13], 0.0, 1.0) * (1 - b);
    const auto& corner = triangle.polygon.vertices;
    const Vec3d place = corner[0] + (corner[1] - corner[0]) * b + (corner[2] - corner[0]) * c;
    const SurfacePoint at = chart.Locate(0, place);
    const SurfaceCell cell = CellAt(at, 2);
    CellLights lights = LitByAll(scene);
    DiffuseSummer(scene).AddSums(0, chart, 0, cell, lights);
    const auto& sum = lights.sums[chart.IsOtherSide({0, 0, 1}) ? 1 : 0];
    if (!sum || !(sum->spread > 1e-4)) return 0;
    const auto point = CastVec3<Wide>(place);
    const auto normal = OutwardNormal(triangle, 0, point);
    const LightView<Wide> view = ViewOf(scene.lights[0], point);
    const double exact =
        static_cast<double>(Dot(normal, view.to_light) / Length(normal) * view.fall_off);
    const double answer = sum->At(at.u * 4 - cell.i, at.v * 4 - cell.j).r;
    return std::abs(answer - std::abs(exact)) / (sum->spread * std::abs(exact));
  }
};

// The place where a bound is used up most, by climbing from random ones.
double WorstSmoothCase(bool is_sun, bool fades, test::Random& random) {
  double worst = 0;
  for (int start = 0; start < 20; ++start) {
    SmoothCase best{{}, is_sun, fades};
    for (double& x : best.x) x = random.Uniform(-0.6, 0.6);
    best.x[8] = random.Uniform(1, 4);
    best.x[9] = random.Uniform(0.3, 3);
    best.x[11] = random.Uniform(0.2, 1);
    best.x[12] = random.Unit();
    best.x[13] = random.Unit();
    worst = std::max(worst, test::Climb(best, 600, 1e-3, random,
                                        [](const SmoothCase& of) { return of.ErrorOverBound(); }));
  }
  EXPECT_LE(worst, 1);
  return worst;
}

TEST(CurvedCell, BoundsOnSmoothTrianglesAreUsedUp) {
  test::Random random(22);
  for (const auto& [is_sun, fades] : {std::pair{true, false}, {false, false}, {false, true}}) {
    const double worst = WorstSmoothCase(is_sun, fades, random);
    std::printf("largest error / bound %.3f\n", worst);
    EXPECT_GT(worst, 0.9);
  }
}

// The side that a ray sees is not the plane's then.
TEST(CurvedCell, NormalsOnBothSidesOfTheirTriangleAreLeftAlone) {
  const auto has_sums = [](const Vec3d& last) {
    Scene scene;
    test::AddMaterial(scene, test::Matte({0.5, 0.5, 0.5}));
    const Vec3d up{0, 0, 1};
    test::AddObject(scene, test::SmoothTriangle({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {up, up, last}),
                    0);
    scene.lights.push_back(test::DirectionalLight(up));
    const SurfaceChart chart(scene.objects[0]);
    CellLights lights = LitByAll(scene);
    DiffuseSummer(scene).AddSums(0, chart, 0, {6, 31, 1}, lights);
    return lights.sums[0] != nullptr && lights.sums[0]->nodes == 2;
  };
  EXPECT_TRUE(has_sums({0.2, 0, 1}));
  EXPECT_FALSE(has_sums({0.2, 0, -1}));
  EXPECT_FALSE(has_sums({1, 0, 1e-5}));
}

}  // namespace
}  // namespace linetree
