// POV-Ray computes the same model by other means: every pixel away from edges must agree.
//
// An edge pixel is one whose ray tree changes within 0.05 pixel: there the two programs' rounding
// (and POV-Ray's shadow offset of 1e-3) may put it on either side.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>
#include <string>

#include "core/io/load_scene.h"
#include "core/io/pov.h"
#include "core/trace/tracer.h"
#include "tests/oracle/pov_render.h"

namespace linetree {
namespace {

constexpr int kWidth = 160, kHeight = 120;
constexpr double kEdgeOffset = 0.05;  // pixels

// Half a step of 16 bits is 7.7e-6; the rest is POV-Ray's shadow offset and the curvature of what
// happens to lie near an edge.
constexpr double kUsualDifference = 1e-4;
constexpr double kUsualShare = 0.999;
constexpr double kLargestDifference = 1e-3;

// What the compared rays must have met, so that agreement means something.
enum Feature {
  kMirror = 1,
  kRefraction = 2,
  kTotalReflection = 4,
  kFilteredShadow = 8,
  kCutOff = 16,
  kBackgroundSeen = 32,
  kBlockedLight = 64,
  kNestedMedia = 128,
};

struct Case {
  const char* name;
  const char* scene;  // below the source folder
  PathLimits limits;
  int features;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.scene; }

class PovOracle : public testing::TestWithParam<Case> {};

struct Sample {
  RayTree tree;
  bool is_edge = false;
};

Sample SampleAt(const Tracer& tracer, const EyeRays& rays, const PathLimits& limits, int column,
                int row) {
  RayCounts counts;
  const auto trace = [&](double dx, double dy) {
    const Ray ray = rays.Through(column + 0.5 + dx, row + 0.5 + dy);
    RayTree tree;
    tracer.Radiance(ray.origin, ray.direction, limits, counts, &tree);
    return tree;
  };
  Sample sample{trace(0, 0)};
  const double o = kEdgeOffset;
  for (const auto& [dx, dy] :
       {std::pair(-o, -o), std::pair(o, -o), std::pair(-o, o), std::pair(o, o)}) {
    sample.is_edge = sample.is_edge || !SameTopology(sample.tree, trace(dx, dy));
  }
  return sample;
}

// Whether a node of a ray tree lies inside the object of its parent: a medium in a medium.
bool IsNested(const RayTree& tree, const RayTreeNode& node) {
  if (node.parent < 0 || node.branch != Branch::kTransmitted || node.side != Side::kOutside)
    return false;
  const RayTreeNode& parent = tree.nodes[static_cast<size_t>(node.parent)];
  return parent.side == Side::kOutside && parent.object != node.object &&
         parent.kind == NodeKind::kSurface && node.kind == NodeKind::kSurface;
}

int FeaturesOf(const RayTree& tree) {
  int features = 0;
  for (const RayTreeNode& node : tree.nodes) {
    if (node.kind == NodeKind::kCutOff) features |= kCutOff;
    if (node.kind == NodeKind::kBackground) features |= kBackgroundSeen;
    if (node.total_reflection) features |= kTotalReflection;
    if (node.branch == Branch::kReflected) features |= kMirror;
    if (node.branch == Branch::kTransmitted) features |= kRefraction;
    if (IsNested(tree, node)) features |= kNestedMedia;
  }
  for (const LightTerm& light : tree.lights) {
    if (light.state == LightState::kBlocked) features |= kBlockedLight;
    if (light.crossings != 0) features |= kFilteredShadow;
  }
  return features;
}

// What was seen away from edges, summed over a picture.
struct Comparison {
  size_t compared = 0, beyond_usual = 0;
  double largest = 0;
  std::string where;
  int features = 0;
  std::vector<int> pixels_of_object;

  void Add(const RayTree& tree, const Rgb& pov, int column, int row) {
    features |= FeaturesOf(tree);
    std::set<int> objects;
    for (const RayTreeNode& node : tree.nodes) {
      if (node.kind == NodeKind::kSurface) objects.insert(node.object);
    }
    for (int object : objects) ++pixels_of_object[static_cast<size_t>(object)];
    double difference = 0;
    for (int channel = 0; channel < 3; ++channel) {
      difference = std::max(difference, std::abs(tree.radiance[channel] - pov[channel]));
    }
    ++compared;
    if (difference > kUsualDifference) ++beyond_usual;
    if (difference <= largest) return;
    largest = difference;
    std::ostringstream text;
    text << "column " << column << " row " << row << ": traced (" << tree.radiance.r << ", "
         << tree.radiance.g << ", " << tree.radiance.b << "), POV-Ray (" << pov.r << ", " << pov.g
         << ", " << pov.b << ")";
    where = text.str();
  }
};

TEST_P(PovOracle, AgreesAwayFromEdges) {
  const Case& c = GetParam();
  const auto scene = LoadSceneFile(std::string(LINETREE_SOURCE_DIR "/") + c.scene);
  ASSERT_TRUE(scene.ok()) << scene.status();
  const Camera& camera = (*scene)->cameras.at(0);
  const auto text = WritePov(**scene, camera, kWidth, kHeight, c.limits);
  ASSERT_TRUE(text.ok()) << text.status();
  const auto picture = RenderWithPov(*text, c.name, kWidth, kHeight);
  ASSERT_TRUE(picture.ok()) << picture.status();
  ASSERT_EQ(picture->width, kWidth);
  ASSERT_EQ(picture->height, kHeight);

  const Tracer tracer(**scene);
  const EyeRays rays(camera, kWidth, kHeight);
  Comparison comparison;
  comparison.pixels_of_object.resize((*scene)->objects.size());
  for (int row = 0; row < kHeight; ++row) {
    for (int column = 0; column < kWidth; ++column) {
      const Sample sample = SampleAt(tracer, rays, c.limits, column, row);
      ASSERT_LT(MaxChannel(sample.tree.radiance), 1) << "POV-Ray clips there";
      if (sample.is_edge) continue;
      comparison.Add(sample.tree, picture->pixels[static_cast<size_t>(row * kWidth + column)],
                     column, row);
    }
  }
  const double share =
      1 - static_cast<double>(comparison.beyond_usual) / static_cast<double>(comparison.compared);
  std::printf("%s: %zu of %d pixels compared, %zu beyond %g, largest difference %.2g\n", c.name,
              comparison.compared, kWidth * kHeight, comparison.beyond_usual, kUsualDifference,
              comparison.largest);
  EXPECT_GE(share, kUsualShare) << comparison.where;
  EXPECT_LE(comparison.largest, kLargestDifference) << comparison.where;
  EXPECT_GE(comparison.compared, static_cast<size_t>(kWidth * kHeight) / 2) << "too many edges";
  EXPECT_EQ(comparison.features & c.features, c.features);
  constexpr int kSeen = 20;
  for (size_t i = 0; i < comparison.pixels_of_object.size(); ++i) {
    EXPECT_GE(comparison.pixels_of_object[i], kSeen)
        << (*scene)->objects[i].name << " is hardly seen";
  }
}

constexpr PathLimits Deep(int depth) { return {.max_depth = depth, .min_weight = 1e-6}; }

INSTANTIATE_TEST_SUITE_P(
    Scenes, PovOracle,
    testing::Values(
        Case{"solids", "tests/oracle/scenes/solids.textproto", Deep(4),
             kBackgroundSeen | kBlockedLight},
        Case{"surfaces", "tests/oracle/scenes/surfaces.textproto", Deep(4), kBlockedLight},
        Case{"lights", "tests/oracle/scenes/lights.textproto", Deep(4), kBlockedLight},
        Case{"maps", "tests/oracle/scenes/maps.textproto", Deep(6), kMirror | kBlockedLight},
        Case{"mirrors", "tests/oracle/scenes/mirrors.textproto", Deep(8),
             kMirror | kBackgroundSeen | kBlockedLight},
        Case{"glass", "tests/oracle/scenes/glass.textproto", Deep(12),
             kMirror | kRefraction | kTotalReflection | kNestedMedia | kFilteredShadow},
        Case{"films", "tests/oracle/scenes/films.textproto", Deep(16),
             kRefraction | kFilteredShadow},
        Case{"depth", "tests/oracle/scenes/hall.textproto", Deep(3),
             kMirror | kRefraction | kCutOff},
        Case{"weight", "tests/oracle/scenes/hall.textproto",
             PathLimits{.max_depth = 16, .min_weight = 0.05}, kMirror | kRefraction | kCutOff}),
    [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace linetree
