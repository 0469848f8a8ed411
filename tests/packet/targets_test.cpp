// Every instruction set of this machine finds the same hits, light states and ray trees.
#include <map>

#include "tests/packet/packet_check.h"
#include "tests/support/demo_scenes.h"
#include "tests/support/every_target.h"
#include "tests/support/random_scene.h"

namespace linetree::test {
namespace {

TEST(Targets, DecideAlike) {
  const int targets = ForEveryTarget([](const char* name) {
    CheckTotals totals;
    for (int i = 0; i < 6; ++i) {
      Random random(static_cast<uint64_t>(i));
      const Scene scene = RandomScene(random, 11 + 11 * i, 3);
      const Tracer tracer(scene);
      const PacketTracer packets(tracer);
      std::vector<Ray> rays;
      for (int k = 0; k < 20 * kPacketLanes; ++k) {
        const Vec3d eye = random.Direction() * 6;
        rays.push_back({eye, Normalized(random.InCube(3) - eye)});
      }
      CheckPackets(packets, WithSpawned(tracer, rays, {}), {}, name, totals);
    }
    const auto balls = BallsOnFloor(60, 1);
    const Tracer tracer(*balls);
    const PacketTracer packets(tracer);
    PathLimits limits;
    limits.max_depth = 7;
    CheckPicture(packets, balls->cameras[0], 61, 43, limits, name, totals);
    Print(name, totals);
    EXPECT_EQ(totals.wrong, 0u);
  });
  EXPECT_GE(targets, 1);
}

// The first packet of pixels, lane by lane.
TEST(Targets, EyeRaysAreTheCameras) {
  Camera camera;
  camera.eye = {0.3, -2, 7};
  camera.look_at = {1, 0.2, -0.1};
  ForEveryTarget([&](const char* name) {
    const EyeRays eye_rays(camera, 19, 10);
    const auto balls = BallsOnFloor(1, 1);
    const Tracer tracer(*balls);
    const PacketTracer packets(tracer);
    for (const auto& [column, row] : {std::pair(0, 0), std::pair(16, 8)}) {
      PacketRays rays;
      packets.EyePacket(eye_rays, column, row, rays);
      for (int lane = 0; lane < kPacketLanes; ++lane) {
        const int x = column + lane % 4, y = row + lane / 4;
        EXPECT_EQ((rays.active >> lane & 1) != 0, x < 19 && y < 10) << name;
        const Ray ray = eye_rays.ThroughPixel(x, y);
        EXPECT_TRUE(SameBits(rays.origin.At(lane), ray.origin)) << name;
        EXPECT_TRUE(SameBits(rays.direction.At(lane), ray.direction)) << name;
      }
    }
  });
}

}  // namespace
}  // namespace linetree::test
