// Squares of pixels that are looked at as a whole: no pixel depends on it.
#include <gtest/gtest.h>

#include "core/audit/scene_families.h"
#include "core/packet/packet_tracer.h"
#include "tests/support/random_scene.h"

namespace linetree::test {
namespace {

struct Picture {
  std::vector<float> radiance, depth;
  std::vector<int32_t> object;
  std::vector<uint64_t> topology;
  PacketCounts counts;
};

Picture Render(const PacketTracer& packets, const Camera& camera, int width, int height) {
  const auto pixels = static_cast<size_t>(width * height);
  Picture picture{std::vector<float>(3 * pixels),
                  std::vector<float>(pixels),
                  std::vector<int32_t>(pixels),
                  std::vector<uint64_t>(pixels),
                  {}};
  const PixelTarget target = {picture.radiance.data(), picture.object.data(), picture.depth.data(),
                              picture.topology.data()};
  PacketWorkspace workspace;
  packets.RenderRegion(EyeRays(camera, width, height), {0, 0, width, height}, {},
                       static_cast<size_t>(width), target, workspace, picture.counts);
  return picture;
}

struct Totals {
  uint64_t pixels = 0, seen = 0;
};

// Returns whether the pictures are equal.
bool Compare(const Scene& scene, const Camera& camera, int width, int height, Totals& totals) {
  const Tracer tracer(scene);
  const PacketTracer looking(tracer), searching(tracer, false);
  const Picture a = Render(looking, camera, width, height);
  const Picture b = Render(searching, camera, width, height);
  EXPECT_EQ(b.counts.seen, 0u);
  EXPECT_TRUE(a.counts.rays == b.counts.rays);
  totals.pixels += a.object.size();
  totals.seen += a.counts.seen;
  return a.radiance == b.radiance && a.depth == b.depth && a.object == b.object &&
         a.topology == b.topology;
}

// Eyes near and far, that look at an object's edge as often as at its middle.
Camera RandomCamera(Random& random, double size) {
  Camera camera;
  camera.eye = random.Direction() * (size * random.Uniform(0.2, 4));
  camera.look_at = random.InCube(size);
  camera.up = random.Direction();
  camera.fov_deg = random.Uniform(2, 100);
  return camera;
}

TEST(Sight, OfEveryShapeAlone) {
  for (const ShapeKind kind : kShapeKinds) {
    Totals totals;
    for (uint64_t seed = 0; seed < 60; ++seed) {
      Random random(seed);
      Scene scene = RandomScene(random, 1, 1);
      scene.objects.clear();
      AddObject(scene, RandomShape(kind, random, random.Uniform(0.3, 1), {0, 0, 0}),
                random.Below(6));
      ASSERT_TRUE(Compare(scene, RandomCamera(random, 1), 75, 61, totals))
          << "kind " << static_cast<int>(kind) << " seed " << seed;
    }
    std::printf("kind %d: %.0f %% seen\n", static_cast<int>(kind),
                100 * static_cast<double>(totals.seen) / static_cast<double>(totals.pixels));
    EXPECT_GT(totals.seen, totals.pixels / 4);
  }
}

// Seen from above, a frustum's lateral face surrounds its cap, or the hole in its place, which may
// be too small to lie on any of the rays that are looked at.
TEST(Sight, OfFacesWithAHoleInTheMiddle) {
  Totals totals;
  for (uint64_t seed = 0; seed < 120; ++seed) {
    Random random(seed);
    Scene scene = RandomScene(random, 1, 1);
    scene.objects.clear();
    const double top = random.LogUniform(0.01, 0.3);
    AddObject(scene, Frustum({0, 0, 0}, {0, 0, random.Uniform(0.3, 2)}, 1, top, seed % 2 == 0), 0);
    Camera camera;
    camera.eye = random.InBox({-0.3, -0.3, 3}, {0.3, 0.3, 6});
    camera.look_at = random.InBox({-0.3, -0.3, 0}, {0.3, 0.3, 0});
    camera.up = {0, 1, 0};
    camera.fov_deg = random.Uniform(5, 40);
    ASSERT_TRUE(Compare(scene, camera, 75, 61, totals)) << "seed " << seed;
  }
}

TEST(Sight, OfRandomScenes) {
  Totals totals;
  for (uint64_t seed = 0; seed < 80; ++seed) {
    Random random(seed);
    const Scene scene = RandomScene(random, 2 + static_cast<int>(seed), 2);
    ASSERT_TRUE(Compare(scene, RandomCamera(random, 3), 75, 61, totals)) << "seed " << seed;
  }
  EXPECT_GT(totals.seen, totals.pixels / 10);
}

TEST(Sight, OfEveryFamily) {
  Totals totals;
  for (int family = 0; family < kSceneFamilies; ++family) {
    for (uint64_t seed = 1; seed <= 8; ++seed) {
      const auto scene = MakeFamilyScene(static_cast<SceneFamily>(family), seed);
      for (const Camera& camera : scene->cameras) {
        ASSERT_TRUE(Compare(*scene, camera, 96, 70, totals))
            << kSceneFamilyNames[static_cast<size_t>(family)] << " seed " << seed;
      }
    }
  }
  EXPECT_GT(totals.seen, totals.pixels / 10);
}

}  // namespace
}  // namespace linetree::test
