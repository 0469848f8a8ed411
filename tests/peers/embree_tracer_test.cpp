// The tracer on Embree against the classical one, on every scene that ships: the same formulas on
// hits that were found in float.
#include "peers/embree/embree_tracer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "core/io/load_scene.h"
#include "peers/peer.h"
#include "peers/picture_difference.h"

namespace linetree {
namespace {

namespace fs = std::filesystem;

constexpr int kSide = 96;

// Pixels whose ray, or one that it spawns, passes an edge within float's rounding; every mirror
// ball on the way magnifies that (balls_4 has most such pixels, 2 in 1000). Elsewhere the two
// differ by the rounding of hit points, which no picture shows.
constexpr double kShareAtEdges = 0.005;

std::vector<fs::path> ShippedScenes() {
  const fs::path folder = fs::path(LINETREE_SOURCE_DIR) / "scenes";
  std::vector<fs::path> files;
  for (const fs::path& part : {folder, folder / "spd"}) {
    for (const auto& entry : fs::directory_iterator(part)) {
      const std::string extension = entry.path().extension();
      if (extension == ".textproto" || extension == ".nff") files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

class EmbreeTracerOn : public testing::TestWithParam<fs::path> {};

TEST_P(EmbreeTracerOn, AgreesWithTheClassicalTracer) {
  const auto scene = LoadSceneFile(GetParam());
  ASSERT_TRUE(scene.ok()) << scene.status();
  const Tracer classical(**scene);
  const EmbreeTracer embree(**scene);
  const EyeRays rays((*scene)->cameras.at(0), kSide, kSide);
  std::vector<float> expected, found;
  RayCounts counts;
  for (int row = 0; row < kSide; ++row) {
    for (int column = 0; column < kSide; ++column) {
      const Ray ray = rays.ThroughPixel(column, row);
      const Rgb a = classical.Radiance(ray.origin, ray.direction, PathLimits{}, counts);
      const Rgb b = embree.Radiance(ray, PathLimits{});
      for (int i = 0; i < 3; ++i) {
        expected.push_back(static_cast<float>(a[i]));
        found.push_back(static_cast<float>(b[i]));
      }
    }
  }
  const PictureDifference difference = DifferenceOf(found, expected);
  std::printf("%s: %.3f %% of the pixels differ, rms %.2g\n", GetParam().stem().c_str(),
              100 * difference.share_beyond_code, difference.rms);
  EXPECT_LE(difference.share_beyond_code, kShareAtEdges);
}

INSTANTIATE_TEST_SUITE_P(Shipped, EmbreeTracerOn, testing::ValuesIn(ShippedScenes()),
                         [](const auto& info) { return info.param.stem().string(); });

TEST(EmbreeTracer, AnEmptySceneIsBackground) {
  Scene scene;
  scene.background = {0.25, 0.5, 0.75};
  const EmbreeTracer tracer(scene);
  EXPECT_EQ(tracer.Radiance({{0, 0, 5}, {0, 0, -1}}, PathLimits{}), scene.background);
  EXPECT_THAT(tracer.Version(), testing::MatchesRegex("3\\.[0-9]+\\.[0-9]+"));
}

TEST(EmbreePeer, PicturesDoNotDependOnThreads) {
  const auto scene = LoadSceneFile(LINETREE_SOURCE_DIR "/scenes/glass.textproto");
  ASSERT_TRUE(scene.ok());
  std::vector<std::vector<float>> pictures;
  for (const PeerKind& kind : AllPeers()) {
    if (kind.name != "embree") continue;
    for (const int threads : {1, 3}) {
      const auto peer = kind.make({*scene, PathLimits{}, threads});
      ASSERT_TRUE(peer.ok()) << peer.status();
      const auto picture = (*peer)->Render((*scene)->cameras[0], 64, 48);
      ASSERT_TRUE(picture.ok()) << picture.status();
      EXPECT_GT(picture->seconds, 0);
      pictures.push_back(picture->radiance);
    }
  }
  ASSERT_EQ(pictures.size(), 2u);
  EXPECT_EQ(pictures[0].size(), 3u * 64 * 48);
  EXPECT_EQ(pictures[0], pictures[1]);
}

}  // namespace
}  // namespace linetree
