// Whole frames by packets are one picture on every instruction set: equal ray trees, which are the
// scalar tracer's, and radiance within the published constant.
#include <filesystem>

#include "core/io/load_scene.h"
#include "tests/packet/packet_check.h"
#include "tests/support/every_target.h"

namespace linetree::test {
namespace {

constexpr int kWidth = 83, kHeight = 61;  // not made of whole packets
constexpr size_t kPixels = size_t{kWidth} * kHeight;

struct Picture {
  std::vector<float> radiance = std::vector<float>(3 * kPixels),
                     depth = std::vector<float>(kPixels);
  std::vector<int32_t> object = std::vector<int32_t>(kPixels);
  std::vector<uint64_t> topology = std::vector<uint64_t>(kPixels);
  RayCounts counts;

  // Of all but radiance: decisions, and what is finished in double.
  uint64_t Digest() const {
    uint64_t digest = 0;
    for (size_t p = 0; p < kPixels; ++p) {
      digest = MixedBits(digest + topology[p]);
      digest = MixedBits(digest + static_cast<uint32_t>(object[p]));
      digest = MixedBits(digest + std::bit_cast<uint32_t>(depth[p]));
    }
    return digest;
  }
};

Picture ByPackets(const PacketTracer& packets, const EyeRays& eye_rays) {
  Picture picture;
  PacketWorkspace workspace;
  PacketCounts counts;
  packets.RenderRegion(eye_rays, {0, 0, kWidth, kHeight}, {}, kWidth,
                       {picture.radiance.data(), picture.object.data(), picture.depth.data(),
                        picture.topology.data()},
                       workspace, counts);
  picture.counts = counts.rays;
  return picture;
}

Picture ByTracer(const Tracer& tracer, const EyeRays& eye_rays, std::vector<Rgb>& radiance) {
  Picture picture;
  RayTree tree;
  for (size_t p = 0; p < kPixels; ++p) {
    const Ray ray =
        eye_rays.ThroughPixel(static_cast<int>(p) % kWidth, static_cast<int>(p) / kWidth);
    radiance[p] = tracer.Radiance(ray.origin, ray.direction, {}, picture.counts, &tree);
    picture.topology[p] = TopologyDigest(tree);
    picture.object[p] = tree.nodes[0].object;
  }
  return picture;
}

class FrameDigest : public testing::TestWithParam<const char*> {};

TEST_P(FrameDigest, IsTheSameOnEveryTarget) {
  const auto scene = LoadSceneFile(std::string(LINETREE_SOURCE_DIR "/scenes/") + GetParam());
  ASSERT_TRUE(scene.ok()) << scene.status();
  const Tracer tracer(**scene);
  const PacketTracer packets(tracer);
  ASSERT_TRUE(packets.IsWide());
  for (const Camera& camera : (*scene)->cameras) {
    const EyeRays eye_rays(camera, kWidth, kHeight);
    std::vector<Rgb> exact(kPixels);
    const Picture expected = ByTracer(tracer, eye_rays, exact);
    std::vector<uint64_t> digests;
    ForEveryTarget([&](const char* name) {
      const Picture picture = ByPackets(packets, eye_rays);
      EXPECT_EQ(picture.topology, expected.topology) << name;
      EXPECT_EQ(picture.object, expected.object) << name;
      EXPECT_TRUE(picture.counts == expected.counts) << name;
      double share = 0;
      for (size_t p = 0; p < kPixels; ++p) {
        const float* rgb = &picture.radiance[3 * p];
        share = std::max(share, ShareOfRounding(**scene, {rgb[0], rgb[1], rgb[2]}, exact[p]));
      }
      EXPECT_LE(share, 1) << name;
      digests.push_back(picture.Digest());
      std::printf("%s, %s: digest %016llx, radiance within %.2f of its bound\n", GetParam(), name,
                  static_cast<unsigned long long>(digests.back()), share);
    });
    EXPECT_EQ(std::count(digests.begin(), digests.end(), digests[0]),
              static_cast<std::ptrdiff_t>(digests.size()));
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, FrameDigest,
                         testing::Values("room.textproto", "glass.textproto", "face.textproto",
                                         "many_lights.textproto", "spd/balls_3.nff",
                                         "spd/mount_4.nff", "spd/tree_8.nff"),
                         [](const auto& info) {
                           return std::filesystem::path(info.param).stem().string();
                         });

}  // namespace
}  // namespace linetree::test
