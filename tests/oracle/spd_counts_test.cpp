// The SPD's Readme publishes how many rays of each kind its scenes cost at 513 x 513 eye rays, five
// rays deep and without a weight limit. It shot them through a grid that includes the picture's
// borders; our pixel centres see a picture that is 0.2 % narrower.
#include <gtest/gtest.h>

#include "core/io/load_scene.h"
#include "core/trace/tracer.h"

namespace linetree {
namespace {

constexpr int kSide = 513;
constexpr double kTolerance = 0.015;

struct Published {
  const char* scene;
  double eye_hits, reflected, refracted, shadow;
};

class SpdCounts : public testing::TestWithParam<Published> {};

TEST_P(SpdCounts, AreThoseOfTheReadme) {
  const Published& published = GetParam();
  const auto scene =
      LoadSceneFile(std::string(LINETREE_SOURCE_DIR "/scenes/spd/") + published.scene + ".nff");
  ASSERT_TRUE(scene.ok()) << scene.status();
  const Tracer tracer(**scene);
  const EyeRays rays((*scene)->cameras.at(0), kSide, kSide);
  const PathLimits limits{.max_depth = 5, .min_weight = 0};
  RayCounts counts;
  double eye_hits = 0;
  for (int row = 0; row < kSide; ++row) {
    for (int column = 0; column < kSide; ++column) {
      const Ray ray = rays.ThroughPixel(column, row);
      const Hit hit = tracer.Intersect(ray.origin, ray.direction, RayStart{});
      if (!hit.IsHit()) continue;
      ++eye_hits;
      tracer.RadianceFromHit(hit, ray.origin, ray.direction, limits, counts);
    }
  }
  EXPECT_NEAR(eye_hits, published.eye_hits, kTolerance * published.eye_hits);
  EXPECT_NEAR(static_cast<double>(counts.reflected), published.reflected,
              kTolerance * published.reflected);
  EXPECT_NEAR(static_cast<double>(counts.refracted), published.refracted,
              kTolerance * published.refracted);
  EXPECT_NEAR(static_cast<double>(counts.shadow), published.shadow, kTolerance * published.shadow);
}

INSTANTIATE_TEST_SUITE_P(Readme, SpdCounts,
                         testing::Values(Published{"balls_4", 263169, 175095, 0, 954368},
                                         Published{"mount_6", 173125, 354769, 354769, 412922},
                                         Published{"tetra_6", 49788, 0, 0, 46112},
                                         Published{"tree_11", 169836, 0, 0, 1097419}),
                         [](const auto& info) { return std::string(info.param.scene); });

}  // namespace
}  // namespace linetree
