// Radiance along paths (core/trace/path.cpp): the formula, Snell's law through solids, ends of
// paths, counts.
#include <gtest/gtest.h>

#include "core/trace/tracer.h"
#include "tests/support/scene_builder.h"

namespace linetree {
namespace {

using test::AddMaterial;
using test::AddObject;

// Rounding of some dozens of operations on numbers of order one.
constexpr double kRounding = 0x1p-46;
constexpr PathLimits kDeep{.max_depth = kMaxPathDepth, .min_weight = 0};

struct Answer {
  Rgb radiance;
  RayCounts counts;
  RayTree tree;
};
Answer Trace(const Scene& scene, const Vec3d& origin, const Vec3d& direction,
             const PathLimits& limits = {}) {
  Answer answer;
  answer.radiance =
      Tracer(scene).Radiance(origin, Normalized(direction), limits, answer.counts, &answer.tree);
  return answer;
}

void ExpectNear(const Rgb& a, const Rgb& b) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], kRounding) << "channel " << i;
}

TEST(Path, MissIsTheBackground) {
  Scene scene;
  scene.background = {0.1, 0.2, 0.3};
  const Answer answer = Trace(scene, {0, 0, 0}, {1, 0, 0});
  EXPECT_EQ(answer.radiance, scene.background);
  EXPECT_EQ(answer.counts, (RayCounts{.eye = 1, .intersect = 1}));
  ASSERT_EQ(answer.tree.nodes.size(), 1u);
  EXPECT_EQ(answer.tree.nodes[0].kind, NodeKind::kBackground);
  EXPECT_EQ(answer.tree.nodes[0].first_light, -1);
  EXPECT_EQ(answer.tree.radiance, scene.background);
}

// Every term once, by hand: ambient, a fading point light, a directional light, a light behind.
TEST(Path, LocalTermsAreTheFormula) {
  Scene scene;
  scene.ambient = {0.2, 0.3, 0.4};
  Material material = test::Matte({0.5, 0.6, 0.7});
  material.ambient = {0.9, 0.8, 0.7};
  material.specular = {0.3, 0.2, 0.1};
  material.exponent = 12;
  AddObject(scene, test::Box({-5, -5, -1}, {5, 5, 0}), AddMaterial(scene, material));
  Light fading = test::PointLight({3, 0, 4}, {2, 2, 1});
  fading.fade_distance = 2.5;
  fading.fade_power = 2;
  scene.lights = {fading, test::DirectionalLight({0, 1, 1}, {0.5, 1, 1.5}),
                  test::PointLight({0, 0, -7})};
  const Vec3d eye{-2, -1, 3};
  const Answer answer = Trace(scene, eye, -eye);

  const Vec3d n{0, 0, 1};
  const Vec3d v = Normalized(eye);
  const Vec3d l[2] = {{0.6, 0, 0.8}, Normalized(Vec3d{0, 1, 1})};
  const double fall_off[2] = {2 / (1 + 4.0), 1};
  Rgb expected = material.ambient * scene.ambient;
  for (size_t i = 0; i < 2; ++i) {
    const double highlight = std::pow(Dot(n, Normalized(l[i] + v)), 12);
    for (int c = 0; c < 3; ++c) {
      expected[c] += scene.lights[i].irradiance[c] * fall_off[i] *
                     (material.diffuse[c] * l[i].z + material.specular[c] * highlight);
    }
  }
  ExpectNear(answer.radiance, expected);
  EXPECT_EQ(answer.counts, (RayCounts{.eye = 1, .shadow = 2, .intersect = 3, .shade = 1}));
  ASSERT_EQ(answer.tree.lights.size(), 3u);
  EXPECT_EQ(answer.tree.lights[0].state, LightState::kLit);
  EXPECT_EQ(answer.tree.lights[2].state, LightState::kFacingAway);
}

TEST(Path, MaterialsWithoutLightTermsCastNoShadowRays) {
  Scene scene;
  Material material;
  material.ambient = {1, 1, 1};
  scene.ambient = {0.5, 0.5, 0.5};
  scene.lights = {test::PointLight({0, 0, 9})};
  AddObject(scene, test::Sphere({}, 1), AddMaterial(scene, material));
  const Answer answer = Trace(scene, {0, 0, 5}, {0, 0, -1});
  EXPECT_EQ(answer.radiance, (Rgb{0.5, 0.5, 0.5}));
  EXPECT_EQ(answer.counts.shadow, 0u);
  ASSERT_EQ(answer.tree.lights.size(), 1u);
  EXPECT_EQ(answer.tree.lights[0].state, LightState::kUnused);
}

// A lit floor seen through a coloured film: the film filters the shadow ray and the view.
TEST(Path, ColouredShadows) {
  Scene scene;
  AddObject(scene, test::Box({-5, -5, -1}, {5, 5, 0}),
            AddMaterial(scene, test::Matte({0.5, 0.5, 0.5})));
  AddObject(scene, test::Disc({0, 0, 5}, {0, 0, 1}, 1),
            AddMaterial(scene, test::Glass({0.8, 0.5, 0.25}, 1)));
  scene.lights = {test::DirectionalLight({0, 0, 1})};
  ExpectNear(Trace(scene, {3, 0, 3}, {-3, 0, -3}).radiance, {0.4, 0.25, 0.125});
  ExpectNear(Trace(scene, {0, 0, 8}, {0, 0, -1}).radiance, {0.5 * 0.64, 0.5 * 0.25, 0.5 * 0.0625});
}

TEST(Path, MirrorsMultiply) {
  Scene scene;
  scene.background = {1, 2, 3};
  AddObject(scene, test::Disc({}, {0, 0, 1}, 1),
            AddMaterial(scene, test::Mirror({0.5, 0.25, 0.125})));
  const Answer answer = Trace(scene, {-1, 0, 1}, {1, 0, -1});
  ExpectNear(answer.radiance, {0.5, 0.5, 0.375});
  EXPECT_EQ(answer.counts, (RayCounts{.eye = 1, .reflected = 1, .intersect = 2, .shade = 1}));
  ASSERT_EQ(answer.tree.nodes.size(), 2u);
  EXPECT_EQ(answer.tree.nodes[1].branch, Branch::kReflected);
  EXPECT_EQ(answer.tree.nodes[1].parent, 0);
  EXPECT_LT(Length(answer.tree.nodes[1].direction - Normalized(Vec3d{1, 0, 1})), kRounding);
}

Scene GlassSlab(const Material& glass) {
  Scene scene;
  scene.background = {1, 1, 1};
  AddObject(scene, test::Box({-50, -50, -1}, {50, 50, 0}), AddMaterial(scene, glass));
  return scene;
}

// A slab of thickness 1 shifts a ray sideways and leaves its direction alone.
TEST(Path, SlabRefractsByItsIndexAndBack) {
  const Scene scene = GlassSlab(test::Glass({0.9, 0.8, 0.7}, 1.5));
  const double sine = 0.6;
  const Answer answer = Trace(scene, {-3, 0, 4}, {0.6, 0, -0.8}, kDeep);
  ASSERT_EQ(answer.tree.nodes.size(), 3u);
  const double inner_sine = sine / 1.5;
  const double shift = inner_sine / std::sqrt(1 - inner_sine * inner_sine);
  const RayTreeNode& exit = answer.tree.nodes[1];
  EXPECT_NEAR(exit.direction.x, inner_sine, kRounding);
  EXPECT_LT(Length(exit.point - Vec3d{shift, 0, -1}), kRounding);
  EXPECT_EQ(exit.side, Side::kInside);
  EXPECT_EQ(exit.branch, Branch::kTransmitted);
  EXPECT_FALSE(answer.tree.nodes[0].leaves_denser_medium);
  EXPECT_TRUE(exit.leaves_denser_medium);
  EXPECT_LT(Length(answer.tree.nodes[2].direction - Vec3d{0.6, 0, -0.8}), kRounding);
  ExpectNear(answer.radiance, {0.81, 0.64, 0.49});
  EXPECT_EQ(answer.counts.refracted, 2u);
}

// From inside the slab beyond the critical angle: all is reflected, the surface's own coefficients
// are left out, and no weight is lost, so the path goes on to its depth.
TEST(Path, TotalReflectionIsWhite) {
  const Scene scene = GlassSlab(test::Glass({0.5, 0.5, 0.5}, 1.5, {0.3, 0.3, 0.3}));
  const Answer answer = Trace(scene, {0, 0, -0.5}, {0.8, 0, 0.6}, {.max_depth = 3});
  ASSERT_EQ(answer.tree.nodes.size(), 5u) << "three surfaces, two rays not cast";
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_TRUE(answer.tree.nodes[i].total_reflection);
    EXPECT_TRUE(answer.tree.nodes[i].leaves_denser_medium);
    EXPECT_EQ(answer.tree.nodes[i].side, Side::kInside);
  }
  EXPECT_FALSE(answer.tree.nodes[2].total_reflection) << "depth forbids to ask";
  EXPECT_EQ(answer.counts.reflected, 2u);
  EXPECT_EQ(answer.counts.refracted, 0u);
  EXPECT_EQ(answer.radiance, (Rgb{0, 0, 0}));
}

TEST(Path, TotalReflectionCarriesAllOfTheLight) {
  Scene scene;
  scene.background = {1, 1, 1};
  // Face +z is beyond the critical angle for the ray; face +x is not.
  AddObject(scene, test::Box({-1, -1, -1}, {1, 1, 1}),
            AddMaterial(scene, test::Glass({0.5, 0.5, 0.5}, 2)));
  const Answer answer = Trace(scene, {0.2, 0, 0.9}, {0.98, 0, 0.2}, kDeep);
  ASSERT_EQ(answer.tree.nodes.size(), 3u);
  EXPECT_TRUE(answer.tree.nodes[0].total_reflection);
  EXPECT_EQ(answer.tree.nodes[0].face, 5);
  EXPECT_EQ(answer.tree.nodes[1].face, 1);
  ExpectNear(answer.radiance, {0.5, 0.5, 0.5});
}

// A bubble of index 1.1 in a block of 1.6: at its surface both indices count, on the way in and
// out.
TEST(Path, NestedMediaRefractAgainstEachOther) {
  Scene scene;
  scene.background = {1, 1, 1};
  AddObject(scene, test::Box({-9, -9, -9}, {9, 9, 9}),
            AddMaterial(scene, test::Glass({1, 1, 1}, 1.6)));
  AddObject(scene, test::Box({-2, -9.5, -1}, {2, 9.5, 1}),
            AddMaterial(scene, test::Glass({1, 1, 1}, 1.1)));
  const double sine = 0.3;
  const Answer answer =
      Trace(scene, {0, 0, 5}, {sine * 0.1, 0, -std::sqrt(1 - sine * sine * 0.01)}, kDeep);
  ASSERT_EQ(answer.tree.nodes.size(), 4u);
  EXPECT_NEAR(answer.tree.nodes[1].direction.x * 1.1, sine * 0.1 * 1.6, kRounding);
  EXPECT_TRUE(answer.tree.nodes[0].leaves_denser_medium);
  EXPECT_NEAR(answer.tree.nodes[2].direction.x, sine * 0.1, kRounding);
  EXPECT_FALSE(answer.tree.nodes[1].leaves_denser_medium);
  EXPECT_NEAR(answer.tree.nodes[3].direction.x, sine * 0.1 * 1.6, kRounding);
}

TEST(Path, SurfacesTransmitStraightOn) {
  Scene scene;
  scene.background = {1, 1, 1};
  const int film = AddMaterial(scene, test::Glass({0.5, 0.5, 0.5}, 1.5));
  AddObject(scene, test::Disc({0, 0, 3}, {0, 0, 1}, 3), film);
  AddObject(scene, test::Frustum({0, -5, 0}, {0, 5, 0}, 1, 1, true), film);
  const Answer answer = Trace(scene, {0, 0, 4}, {0.1, 0.2, -1}, kDeep);
  ASSERT_EQ(answer.tree.nodes.size(), 4u);
  for (const RayTreeNode& node : answer.tree.nodes) {
    EXPECT_EQ(node.direction, answer.tree.nodes[0].direction);
  }
  EXPECT_EQ(answer.tree.nodes[1].side, Side::kOutside);
  EXPECT_EQ(answer.tree.nodes[2].side, Side::kInside);
  EXPECT_EQ(answer.tree.nodes[2].object, 1);
  ExpectNear(answer.radiance, {0.125, 0.125, 0.125});
}

// Two mirrors face to face: as many rays as the limits say, and a node for the ray not cast.
Scene FacingMirrors(double reflect) {
  Scene scene;
  scene.background = {1, 1, 1};
  const int mirror = AddMaterial(scene, test::Mirror({reflect, reflect / 2, 0}));
  AddObject(scene, test::Disc({0, 0, 0}, {0, 0, 1}, 10), mirror);
  AddObject(scene, test::Disc({0, 0, 1}, {0, 0, 1}, 10), mirror);
  return scene;
}

TEST(Path, DepthCountsTheEyeRay) {
  const Scene scene = FacingMirrors(1);
  for (int depth = 1; depth <= kMaxPathDepth; ++depth) {
    const Answer answer = Trace(scene, {0, 0, 0.5}, {0, 0, -1}, {.max_depth = depth});
    EXPECT_EQ(answer.counts.reflected, static_cast<uint64_t>(depth - 1));
    EXPECT_EQ(answer.counts.shade, static_cast<uint64_t>(depth));
    EXPECT_EQ(answer.radiance, (Rgb{0, 0, 0}));
    ASSERT_EQ(answer.tree.nodes.size(), static_cast<size_t>(depth + 1));
    EXPECT_EQ(answer.tree.nodes.back().kind, NodeKind::kCutOff);
    EXPECT_EQ(answer.tree.nodes.back().branch, Branch::kReflected);
    EXPECT_EQ(answer.tree.nodes.back().parent, depth - 1);
  }
}

// Weights 1/2, 1/4, ...: a ray of weight exactly min_weight is cast, a lighter one is not. The
// largest channel decides.
TEST(Path, WeightEndsPaths) {
  const Scene scene = FacingMirrors(0.5);
  const auto reflected = [&](double min_weight) {
    return Trace(scene, {0, 0, 0.5}, {0, 0, -1}, {.max_depth = 16, .min_weight = min_weight})
        .counts.reflected;
  };
  EXPECT_EQ(reflected(0.125), 3u);
  EXPECT_EQ(reflected(std::nextafter(0.125, 1)), 2u);
  EXPECT_EQ(reflected(0), 15u);
  EXPECT_EQ(reflected(1), 0u);
}

// Rays, nodes and terms agree with each other on a scene with everything in it.
TEST(Path, CountsAndTreeAddUp) {
  Scene scene = GlassSlab(test::Glass({0.9, 0.8, 0.7}, 1.5, {0.2, 0.2, 0.2}));
  Material floor = test::Matte({0.5, 0.5, 0.5});
  floor.reflect = {0.3, 0.3, 0.3};
  AddObject(scene, test::Box({-50, -50, -5}, {50, 50, -4}), AddMaterial(scene, floor));
  scene.lights = {test::PointLight({0, 0, 9}), test::PointLight({0, 0, -3})};
  const Answer answer = Trace(scene, {-3, 0, 4}, {0.6, 0, -0.8}, {.max_depth = 6});
  const RayCounts& n = answer.counts;
  EXPECT_EQ(n.intersect, n.eye + n.reflected + n.refracted + n.shadow);
  uint64_t surfaces = 0, branches = 0, cut_off = 0;
  for (size_t i = 0; i < answer.tree.nodes.size(); ++i) {
    const RayTreeNode& node = answer.tree.nodes[i];
    EXPECT_LT(node.parent, static_cast<int>(i));
    surfaces += node.kind == NodeKind::kSurface;
    cut_off += node.kind == NodeKind::kCutOff;
    branches += node.kind != NodeKind::kCutOff && node.branch != Branch::kEye;
  }
  EXPECT_EQ(surfaces, n.shade);
  EXPECT_EQ(branches, n.reflected + n.refracted);
  EXPECT_GT(cut_off, 0u);
  EXPECT_EQ(answer.tree.lights.size(), surfaces * scene.lights.size());
  uint64_t shadow_rays = 0;
  for (const LightTerm& term : answer.tree.lights) {
    shadow_rays += term.state == LightState::kLit || term.state == LightState::kBlocked;
  }
  EXPECT_EQ(shadow_rays, n.shadow);
}

TEST(Path, RecordingChangesNothingAndReusesMemory) {
  const Scene scene = GlassSlab(test::Glass({0.9, 0.8, 0.7}, 1.5, {0.2, 0.2, 0.2}));
  const Tracer tracer(scene);
  const Vec3d direction = Normalized(Vec3d{0.6, 0, -0.8});
  RayCounts plain_counts, recorded_counts;
  RayTree tree;
  const Rgb plain = tracer.Radiance({-3, 0, 4}, direction, {}, plain_counts);
  EXPECT_EQ(tracer.Radiance({-3, 0, 4}, direction, {}, recorded_counts, &tree), plain);
  EXPECT_EQ(recorded_counts, plain_counts);
  EXPECT_EQ(tree.radiance, plain);
  const RayTreeNode* nodes = tree.nodes.data();
  const size_t size = tree.nodes.size();
  tracer.Radiance({-3, 0, 4}, direction, {}, recorded_counts, &tree);
  EXPECT_EQ(tree.nodes.data(), nodes);
  EXPECT_EQ(tree.nodes.size(), size);
}

TEST(Path, RadianceFromHitIsTheRest) {
  const Scene scene = GlassSlab(test::Glass({0.9, 0.8, 0.7}, 1.5, {0.2, 0.2, 0.2}));
  const Tracer tracer(scene);
  for (const Vec3d& towards : {Vec3d{0.6, 0, -0.8}, Vec3d{0.6, 0, 0.8}}) {
    RayCounts whole, rest;
    const Rgb radiance = tracer.Radiance({-3, 0, 4}, towards, {}, whole);
    const Hit hit = tracer.Intersect({-3, 0, 4}, towards, {});
    EXPECT_EQ(tracer.RadianceFromHit(hit, {-3, 0, 4}, towards, {}, rest), radiance);
    rest += RayCounts{.eye = 1, .intersect = 1};
    EXPECT_EQ(rest, whole);
  }
}

}  // namespace
}  // namespace linetree
