// Rays that leave a convex surface never meet it again: one object alone, through the tracer, over
// twelve decades of size and up to a million sizes from the origin.
#include <gtest/gtest.h>

#include "core/scene/affine_map.h"
#include "core/trace/intersect.h"
#include "core/trace/tracer.h"
#include "tests/stress/hard_rays.h"
#include "tests/stress/stress.h"
#include "tests/support/random_shapes.h"

namespace linetree::stress {
namespace {

constexpr double kTransmit = 0.5;  // its powers are exact: filters count crossings
constexpr int kLights = 3;

struct Spawned {
  uint64_t reflected = 0, refracted = 0, shadow = 0, again = 0;
  uint64_t Sum() const { return reflected + refracted + shadow; }
};

// Glass alone in the world: two lights outside, one of them at infinity, and one in the middle.
Scene OneObject(test::ShapeKind kind, test::Random& random) {
  const double size = random.LogUniform(1e-6, 1e6);
  const double away = random.Below(2) == 0 ? random.Uniform(0, 50) : random.LogUniform(50, 1e6);
  const Vec3d center = random.Direction() * (size * away);
  Scene scene;
  scene.materials = {
      test::Glass({kTransmit, kTransmit, kTransmit}, random.Uniform(0.6, 1.8), {0.5, 0.5, 0.5})};
  scene.materials[0].diffuse = {0.5, 0.5, 0.5};
  scene.objects = {test::ObjectOf(test::RandomShape(kind, random, size, center))};
  scene.lights = {test::PointLight(center + random.Direction() * (size * 20)),
                  test::DirectionalLight(random.Direction()), test::PointLight(center)};
  return scene;
}

bool IsInside(const Scene& scene, const Vec3d& point) {
  return ContainsStrictly(scene.objects[0].shape, point);
}

// What leaves the surface at one node of a ray tree.
class Departure {
 public:
  Departure(const Tracer& tracer, const RayTree& tree, size_t node, Spawned& spawned)
      : tracer_(tracer), tree_(tree), node_(tree.nodes[node]), spawned_(spawned) {
    for (size_t child = node + 1; child < tree.nodes.size(); ++child) {
      if (tree.nodes[child].parent == static_cast<int>(node)) CheckBranch(tree.nodes[child]);
    }
    for (int light = 0; light < kLights; ++light) CheckShadow(light);
  }

 private:
  const Shape& shape() const { return tracer_.scene().objects[0].shape; }

  // Outside: nothing ahead. Inside a solid: the far side, never the flat face that it starts on.
  void CheckBranch(const RayTreeNode& child) {
    if (child.kind == NodeKind::kCutOff) return;
    const bool crosses = child.branch == Branch::kTransmitted && !IsPlanar(shape());
    const bool inside = crosses != (node_.side == Side::kInside);
    ++(child.branch == Branch::kReflected ? spawned_.reflected : spawned_.refracted);
    if (!inside) {
      spawned_.again += child.kind != NodeKind::kBackground;
      return;
    }
    if (!IsSolid(shape())) return;  // open ends let light out
    const bool is_flat = !std::holds_alternative<SphereShape>(shape()) &&
                         !(std::holds_alternative<FrustumShape>(shape()) && node_.face == 0);
    spawned_.again += child.kind != NodeKind::kSurface || child.side != Side::kInside ||
                      (is_flat && child.face == node_.face);
  }

  // From outside nothing is in the way; from inside the surface is crossed once, on the way out.
  void CheckShadow(int light) {
    const LightTerm& term =
        tree_.lights[static_cast<size_t>(node_.first_light) + static_cast<size_t>(light)];
    if (term.state == LightState::kFacingAway) return;
    ++spawned_.shadow;
    const auto shadow = tracer_.CastShadow(node_.point, light, {0, node_.face, node_.side});
    if (node_.side == Side::kOutside) {
      spawned_.again += shadow.filter.r != 1 || term.crossings != 0;
    } else if (IsSolid(shape())) {
      const bool stays = light == 2 && IsInside(tracer_.scene(), MiddleLight());
      spawned_.again += stays ? shadow.filter.r < kTransmit : shadow.filter.r != kTransmit;
    }
  }

  Vec3d MiddleLight() const { return tracer_.scene().lights[2].position; }

  const Tracer& tracer_;
  const RayTree& tree_;
  const RayTreeNode& node_;
  Spawned& spawned_;
};

class SpawnTest : public testing::TestWithParam<test::ShapeKind> {};

TEST_P(SpawnTest, NeverMeetsTheSurfaceAgain) {
  const std::string name(test::NameOf(GetParam()));
  test::Random random = RandomFor("Spawn " + name);
  Spawned spawned;
  PathLimits limits;
  limits.max_depth = 6;
  limits.min_weight = 0;
  RayTree tree;
  RayCounts counts;
  const uint64_t wanted = static_cast<uint64_t>(Times(1'000'000));
  while (spawned.Sum() < wanted && spawned.again == 0) {
    const Scene scene = OneObject(GetParam(), random);
    const Tracer tracer(scene);
    std::vector<Ray> rays;
    AddSpread(scene, 60, random, rays);
    AddTangents(scene, 20, random, rays);
    AddTies(scene, 20, random, rays);
    AddFromWithin(scene, 20, random, rays);
    for (const Ray& ray : rays) {
      tracer.Radiance(ray.origin, Unit(ray.direction), limits, counts, &tree);
      for (size_t i = 0; i < tree.nodes.size(); ++i) {
        if (tree.nodes[i].kind == NodeKind::kSurface) Departure(tracer, tree, i, spawned);
      }
      if (spawned.again == 0) continue;
      ADD_FAILURE() << "seed " << Seed() << ", size " << Length(scene.objects[0].bounds.Extent())
                    << " at " << Length(scene.objects[0].bounds.Center());
      break;
    }
  }
  Largest largest("Spawn " + name, 0, "returns");
  EXPECT_TRUE(largest.Add(static_cast<double>(spawned.again)));
  std::printf("%llu reflected, %llu refracted and %llu shadow rays\n",
              static_cast<unsigned long long>(spawned.reflected),
              static_cast<unsigned long long>(spawned.refracted),
              static_cast<unsigned long long>(spawned.shadow));
}

INSTANTIATE_TEST_SUITE_P(All, SpawnTest, testing::ValuesIn(test::kShapeKinds),
                         [](const auto& kind) {
                           std::string name(test::NameOf(kind.param));
                           std::replace(name.begin(), name.end(), ' ', '_');
                           return name;
                         });

}  // namespace
}  // namespace linetree::stress
