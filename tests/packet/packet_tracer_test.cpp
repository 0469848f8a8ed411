// Packets decide as the scalar tracer does: on random scenes, every kind of shape, every family of
// the audit.
#include "core/packet/packet_tracer.h"

#include "core/audit/query_rays.h"
#include "core/audit/scene_families.h"
#include "tests/packet/packet_check.h"
#include "tests/support/random_scene.h"

namespace linetree::test {
namespace {

// Packets of rays that run close to each other.
std::vector<Ray> Bundles(Random& random, int bundles, double spread) {
  std::vector<Ray> rays;
  for (int i = 0; i < bundles; ++i) {
    const Vec3d eye = random.Direction() * random.Uniform(0.1 * spread, 4 * spread);
    const Vec3d target = random.InCube(spread);
    for (int lane = 0; lane < kPacketLanes; ++lane) {
      const Vec3d to = target + random.InCube(random.Uniform(0, 0.3));
      rays.push_back({eye, Normalized(to - eye)});
    }
  }
  return rays;
}

TEST(PacketTracer, EveryShapeAlone) {
  for (const ShapeKind kind : kShapeKinds) {
    CheckTotals totals;
    for (int i = 0; i < 40; ++i) {
      Random random(static_cast<uint64_t>(i));
      Scene scene = RandomScene(random, 1, 1);
      scene.objects.clear();
      AddObject(scene, RandomShape(kind, random, random.Uniform(0.3, 1), {0, 0, 0}),
                random.Below(6));
      const Tracer tracer(scene);
      const PacketTracer packets(tracer);
      ASSERT_TRUE(packets.IsWide());
      const std::vector<Ray> rays = Bundles(random, 20, 1);
      CheckPackets(packets, WithSpawned(tracer, rays, {}), {}, "shape", totals);
    }
    Print(std::to_string(static_cast<int>(kind)).c_str(), totals);
    EXPECT_EQ(totals.wrong, 0u);
  }
}

// Along one axis or within one of the planes of the axes, where a component is 0 with either sign.
std::vector<Ray> Parallel(Random& random, int count) {
  std::vector<Ray> rays;
  for (int i = 0; i < count; ++i) {
    Vec3d direction = random.Direction();
    const int axis = random.Below(3);
    direction[axis] = random.Below(2) == 0 ? 0.0 : -0.0;
    if (random.Below(3) == 0) direction[(axis + 1) % 3] = -0.0;
    const Vec3d unit = Normalized(direction);
    rays.push_back({random.InCube(0.9) - unit * 3, unit});
  }
  return rays;
}

TEST(PacketTracer, RaysParallelToFaces) {
  for (const ShapeKind kind : kShapeKinds) {
    CheckTotals totals;
    for (int i = 0; i < 40; ++i) {
      Random random(static_cast<uint64_t>(i));
      Scene scene = RandomScene(random, 1, 1);
      scene.objects.clear();
      if (kind == ShapeKind::kPolyhedron) {
        AddObject(scene, RandomPolyhedron(random, AffineMap()), 0);
      } else {
        AddObject(scene, RandomShape(kind, random, random.Uniform(0.3, 1), {0, 0, 0}), 0);
      }
      const Tracer tracer(scene);
      const PacketTracer packets(tracer);
      CheckPackets(packets, Free(Parallel(random, 320)), {}, "shape", totals);
    }
    EXPECT_EQ(totals.wrong, 0u) << static_cast<int>(kind);
  }
}

TEST(PacketTracer, RandomScenes) {
  CheckTotals totals;
  for (int i = 0; i < 40; ++i) {
    Random random(static_cast<uint64_t>(i));
    const Scene scene = RandomScene(random, 3 + 3 * i, 3);
    const Tracer tracer(scene);
    const PacketTracer packets(tracer);
    ASSERT_TRUE(packets.IsWide());
    PathLimits limits;
    limits.max_depth = 6;
    const std::vector<Ray> rays = Bundles(random, 10, 3);
    CheckPackets(packets, WithSpawned(tracer, rays, limits), limits, "scene", totals);
  }
  Print("random scenes", totals);
  EXPECT_EQ(totals.wrong, 0u);
}

TEST(PacketTracer, EveryFamily) {
  for (int family = 0; family < kSceneFamilies; ++family) {
    CheckTotals totals;
    const std::string name(kSceneFamilyNames[static_cast<size_t>(family)]);
    for (uint64_t seed = 1; seed <= 8; ++seed) {
      const auto scene = MakeFamilyScene(static_cast<SceneFamily>(family), seed);
      const Tracer tracer(*scene);
      const PacketTracer packets(tracer);
      const QueryRays queries(tracer, scene->cameras);
      RandomStream random(seed);
      std::vector<Ray> rays;
      for (int i = 0; i < 320; ++i) {
        rays.push_back(i % 2 == 0 ? queries.Random(random) : queries.Lattice(random));
      }
      CheckPackets(packets, WithSpawned(tracer, rays, {}), {}, name, totals);
      for (const Camera& camera : scene->cameras) {
        CheckPicture(packets, camera, 45, 34, {}, name, totals);
      }
    }
    Print(name.c_str(), totals);
    EXPECT_EQ(totals.wrong, 0u);
  }
}

}  // namespace
}  // namespace linetree::test
