// The tracer against its twins: hierarchy and flat list, double and a wider type, one thread and
// several.
#include <gtest/gtest.h>

#include <iostream>
#include <thread>

#include "core/scene/scene.h"
#include "core/trace/tracer.h"
#include "tests/support/random_scene.h"

namespace linetree {
namespace {

using test::Random;

constexpr PathLimits kLimits{.max_depth = 5, .min_weight = 0.001};
constexpr double kSpread = 3;

// Towards random points near the scene's objects.
std::vector<Ray> RandomRays(Random& random, const Scene& scene, int count) {
  std::vector<Ray> rays;
  for (int i = 0; i < count; ++i) {
    const Vec3d origin = random.Direction() * (3 * kSpread);
    const int object = random.Below(static_cast<int>(scene.objects.size()));
    const Vec3d target =
        scene.objects[static_cast<size_t>(object)].bounds.Center() + random.InCube(0.5);
    rays.push_back({origin, Normalized(target - origin)});
  }
  return rays;
}

struct Record {
  Rgb radiance;
  RayCounts counts;
  RayTree tree;
};
template <class S>
Record Trace(const TracerOf<S>& tracer, const Ray& ray) {
  Record record;
  const RgbOf<S> radiance = tracer.Radiance(CastVec3<S>(ray.origin), CastVec3<S>(ray.direction),
                                            kLimits, record.counts, &record.tree);
  for (int i = 0; i < 3; ++i) record.radiance[i] = static_cast<double>(radiance[i]);
  return record;
}

TEST(Twins, HierarchyAndFlatListAgreeToTheBit) {
  Random random(20261);
  RayCounts total;
  for (int k = 0; k < 20; ++k) {
    const Scene scene = test::RandomScene(random, 10 + 10 * k, kSpread);
    const Tracer flat(scene, Hierarchy::kFlat);
    const Tracer bvh(scene, Hierarchy::kBvh);
    for (const Ray& ray : RandomRays(random, scene, 1000)) {
      const Record a = Trace(flat, ray);
      const Record b = Trace(bvh, ray);
      ASSERT_EQ(a.radiance, b.radiance) << "scene " << k;
      ASSERT_EQ(a.counts, b.counts);
      ASSERT_TRUE(SameTopology(a.tree, b.tree));
      total += a.counts;
    }
  }
  EXPECT_EQ(total.intersect, total.eye + total.reflected + total.refracted + total.shadow);
  EXPECT_GT(total.reflected, 10000u);
  EXPECT_GT(total.refracted, 10000u);
  std::cout << total.intersect << " rays\n";
}

// Axis-parallel rays through axis-parallel boxes that touch: every degenerate case of the slab
// test.
TEST(Twins, DegenerateRaysAgreeToo) {
  Scene scene;
  scene.background = {0.5, 0.5, 0.5};
  Material half = test::Glass({0.5, 0.5, 0.5}, 1, {0.25, 0.25, 0.25});
  half.ambient = {0.1, 0.2, 0.3};
  scene.ambient = {1, 1, 1};
  test::AddMaterial(scene, half);
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      const double x = i, y = j;
      test::AddObject(scene, test::Polygon({{x, y, 0}, {x + 1, y, 0}, {x, y + 1, 0}}));
      test::AddObject(scene, test::Box({x, y, 1}, {x + 1, y + 1, 1.25 + 0.25 * i}));
      test::AddObject(scene, test::Sphere({x + 0.5, y + 0.5, 3}, 0.5));
    }
  }
  const Tracer flat(scene, Hierarchy::kFlat);
  const Tracer bvh(scene, Hierarchy::kBvh);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      for (int i = 0; i <= 16; ++i) {
        for (int j = 0; j <= 16; ++j) {
          Vec3d origin, direction;
          origin[axis] = -sign * 9;
          origin[(axis + 1) % 3] = i * 0.25;
          origin[(axis + 2) % 3] = j * 0.25;
          direction[axis] = sign;
          const Record a = Trace(flat, {origin, direction});
          const Record b = Trace(bvh, {origin, direction});
          ASSERT_EQ(a.radiance, b.radiance);
          ASSERT_EQ(a.counts, b.counts);
        }
      }
    }
  }
}

// Rays from far away that touch turned ellipsoids where these touch their boxes, in the plane of
// the box's side: whether they hit is decided by rounding, and the hierarchy may not decide it
// otherwise.
TEST(Twins, GrazingRaysFromAfarAgree) {
  Random random(20265);
  Scene scene;
  test::AddMaterial(scene, test::Matte({1, 1, 1}));
  constexpr int kObjects = 100;
  for (int i = 0; i < kObjects; ++i) {
    test::AddObject(scene,
                    test::RandomShape(test::ShapeKind::kSphere, random, 1, random.InCube(9)));
  }
  const Tracer flat(scene, Hierarchy::kFlat);
  const Tracer bvh(scene, Hierarchy::kBvh);
  int hits = 0;
  for (int k = 0; k < 20000; ++k) {
    const int object = random.Below(kObjects);
    const AffineFrame& frame =
        std::get<SphereShape>(scene.objects[static_cast<size_t>(object)].shape).frame;
    const int axis = random.Below(3);
    const Vec3d contact = frame.world_from_object *
                          Normalized(frame.world_from_object.row[static_cast<size_t>(axis)]);
    Vec3d target = frame.center + (random.Below(2) == 0 ? contact : -contact);
    const double distance = random.LogUniform(1e3, 1e6);
    target[axis] += random.Uniform(-1, 1) * 0x1p-52 * distance;
    Vec3d direction = random.Direction();
    direction[axis] = 0;
    const Vec3d origin = target - direction * distance;
    const Hit a = flat.Intersect(origin, direction, {});
    const Hit b = bvh.Intersect(origin, direction, {});
    ASSERT_EQ(a.object, b.object) << "ray " << k;
    ASSERT_EQ(a.t, b.t);
    hits += a.object == object;
  }
  EXPECT_GT(hits, 2000);
  EXPECT_LT(hits, 18000);
}

// Rounding of double, seen through up to five curved mirrors and lenses, each of which magnifies
// it.
constexpr double kMaxRoundingError = 1e-8;
// Share of rays whose ray tree is decided by rounding.
constexpr double kMaxUndecided = 2e-4;

TEST(Twins, DoubleAgreesWithAWiderType) {
  Random random(20262);
  int rays = 0, undecided = 0;
  double worst = 0;
  for (int k = 0; k < 20; ++k) {
    const Scene scene = test::RandomScene(random, 40, kSpread);
    const Tracer tracer(scene);
    const TracerOf<long double> wide(scene);
    for (const Ray& ray : RandomRays(random, scene, 2000)) {
      const Record a = Trace(tracer, ray);
      const Record b = Trace(wide, ray);
      ++rays;
      if (!SameTopology(a.tree, b.tree)) {
        ++undecided;
        continue;
      }
      ASSERT_EQ(a.counts, b.counts);
      for (int i = 0; i < 3; ++i) {
        const double error = std::abs(a.radiance[i] - b.radiance[i]) /
                             std::max(std::abs(b.radiance[i]), RadianceFloor(scene));
        worst = std::max(worst, error);
      }
    }
  }
  std::cout << rays << " rays, " << undecided << " undecided, largest relative error " << worst
            << "\n";
  EXPECT_LT(worst, kMaxRoundingError);
  EXPECT_LE(undecided, kMaxUndecided * rays);
}

TEST(Twins, ThreadsDoNotMatter) {
  Random random(20263);
  const Scene scene = test::RandomScene(random, 60, kSpread);
  const Tracer tracer(scene);
  const std::vector<Ray> rays = RandomRays(random, scene, 2000);
  const auto trace_all = [&](std::vector<Rgb>& radiance) {
    RayCounts counts;
    for (const Ray& ray : rays) {
      radiance.push_back(tracer.Radiance(ray.origin, ray.direction, kLimits, counts));
    }
  };
  std::vector<Rgb> alone;
  trace_all(alone);
  std::vector<std::vector<Rgb>> together(4);
  std::vector<std::thread> threads;
  for (auto& radiance : together) threads.emplace_back([&] { trace_all(radiance); });
  for (std::thread& thread : threads) thread.join();
  for (const auto& radiance : together) EXPECT_EQ(radiance, alone);
}

}  // namespace
}  // namespace linetree
