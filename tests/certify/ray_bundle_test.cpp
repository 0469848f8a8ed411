#include "core/certify/ray_bundle.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/trace/intersect.h"
#include "tests/support/random_scene.h"

namespace linetree::test {
namespace {

PointCloud RandomCloud(Random& random, const Vec3d& center, double size) {
  PointCloud cloud;
  for (Vec3d& p : cloud.points) p = center + random.InCube(size);
  cloud.slack = random.Below(2) == 0 ? 0 : size * random.LogUniform(1e-9, 0.3);
  return cloud;
}
// A point of the cloud: of the hull of its points, moved by up to its slack.
Vec3d PointOf(Random& random, const PointCloud& cloud) {
  Vec3d sum;
  double weights = 0;
  for (const Vec3d& p : cloud.points) {
    const double weight = random.Below(3) == 0 ? random.LogUniform(1e-3, 1) : 0;
    sum = sum + p * weight;
    weights += weight;
  }
  if (weights == 0) return cloud.points[0];
  return sum * (1 / weights) + random.Direction() * (cloud.slack * random.Unit());
}

TEST(PointCloud, BoundsHoldItsPoints) {
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const PointCloud cloud = RandomCloud(random, random.InCube(3), random.LogUniform(1e-3, 1));
    const Box3 bounds = cloud.Bounds();
    for (int n = 0; n < 50; ++n) {
      const Vec3d p = PointOf(random, cloud);
      for (int axis = 0; axis < 3; ++axis) {
        ASSERT_LE(p[axis], bounds.max[axis] + 1e-14);
        ASSERT_GE(p[axis], bounds.min[axis] - 1e-14);
      }
    }
  }
}

// Solids of all kinds: a cloud that is said to be inside or outside has no point on the other side,
// and both are said often enough.
TEST(RayBundle, InsideAndOutsideAreCertain) {
  Random random(2);
  int inside = 0, outside = 0;
  for (int i = 0; i < 4000; ++i) {
    const ShapeKind kind = kShapeKinds[static_cast<size_t>(random.Below(5))];
    Scene scene;
    AddMaterial(scene, Matte({1, 1, 1}));
    AddObject(scene, RandomShape(kind, random, 1, {}));
    const Tracer tracer(scene);
    const CandidateSearch search(tracer);
    const Shape& shape = scene.objects[0].shape;
    const PointCloud cloud = RandomCloud(random, random.InCube(1), random.LogUniform(1e-3, 0.3));
    const bool is_in = IsCertainlyInside(cloud, shape);
    const bool is_out = IsCertainlyOutside(cloud, shape, search.Surplus(0));
    ASSERT_FALSE(is_in && is_out);
    inside += is_in;
    outside += is_out;
    for (int n = 0; n < 20; ++n) {
      const Vec3d p = PointOf(random, cloud);
      const bool contained = ContainsStrictly(shape, p);
      ASSERT_TRUE(contained || !is_in);
      ASSERT_FALSE(contained && is_out);
    }
  }
  EXPECT_GT(inside, 100);
  EXPECT_GT(outside, 1500);
}

// Whatever a segment of the bundle meets is among the candidates, with a parent's list and without.
TEST(RayBundle, CandidatesHoldAllThatIsMet) {
  Random random(3);
  int met = 0, kept = 0;
  for (int s = 0; s < 60; ++s) {
    const Scene scene = RandomScene(random, 10, 3);
    const Tracer tracer(scene);
    const CandidateSearch search(tracer);
    for (int i = 0; i < 20; ++i) {
      const double size = random.LogUniform(1e-3, 0.5);
      const PointCloud from = RandomCloud(random, random.InCube(4), size);
      const PointCloud to = RandomCloud(random, random.InCube(4), size);
      const RayBundle bundle(scene, search, RayStart(), from, to);
      const std::vector<int32_t> candidates = bundle.Candidates(kNoObject, nullptr);
      ASSERT_TRUE(std::is_sorted(candidates.begin(), candidates.end()));
      const std::span<const int32_t> inherited(candidates);
      EXPECT_EQ(bundle.Candidates(kNoObject, &inherited), candidates);
      kept += static_cast<int>(candidates.size());
      for (int n = 0; n < 30; ++n) {
        const Vec3d begin = PointOf(random, from), segment = PointOf(random, to) - begin;
        const Hit hit = tracer.Intersect(begin, segment, RayStart());
        if (!hit.IsHit() || hit.t > 1) continue;
        ++met;
        ASSERT_TRUE(std::binary_search(candidates.begin(), candidates.end(), hit.object));
      }
      if (candidates.empty()) continue;
      const auto others = bundle.Candidates(candidates[0], nullptr);
      EXPECT_EQ(others.size() + 1, candidates.size());
    }
  }
  EXPECT_GT(met, 1000);
  EXPECT_LT(kept, 60 * 20 * 6);  // not simply everything
}

// Segments in pairs: point m of the one cloud goes to point m of the other, what lies between to
// what lies between.
struct Pairs {
  PointCloud from, to;

  PointCloud At(double share) const {
    PointCloud cloud;
    for (size_t m = 0; m < 16; ++m) {
      cloud.points[m] = from.points[m] * (1 - share) + to.points[m] * share;
    }
    cloud.slack = from.slack * (1 - share) + to.slack * share;
    return cloud;
  }
};
Pairs RandomPairs(Random& random) {
  const double size = random.LogUniform(1e-2, 1);
  Pairs pairs{RandomCloud(random, random.InCube(4), size),
              RandomCloud(random, random.InCube(4), size)};
  // Crossing on their way, or all alike.
  const double turn = random.Below(2) == 0 ? -1 : 1;
  for (size_t m = 0; m < 16; ++m) {
    pairs.to.points[m] = pairs.to.points[0] + (pairs.from.points[m] - pairs.from.points[0]) * turn;
  }
  return pairs;
}

// Whatever segments meet is among the candidates; those that no segment can meet are fewer than
// without sections.
TEST(RayBundle, SectionsTakeAwayOnlyWhatIsNotMet) {
  Random random(4);
  int met = 0, kept = 0, kept_without = 0;
  for (int s = 0; s < 100; ++s) {
    const Scene scene = RandomScene(random, 14, 3);
    const Tracer tracer(scene);
    const CandidateSearch search(tracer);
    for (int i = 0; i < 20; ++i) {
      const Pairs pairs = RandomPairs(random);
      const auto at = [&](double share) { return pairs.At(share); };
      const RayBundle bundle(scene, search, RayStart(), pairs.from, pairs.to, at);
      const RayBundle plain(scene, search, RayStart(), pairs.from, pairs.to);
      const std::vector<int32_t> candidates = bundle.Candidates(kNoObject, nullptr);
      const std::vector<int32_t> all = plain.Candidates(kNoObject, nullptr);
      ASSERT_TRUE(std::includes(all.begin(), all.end(), candidates.begin(), candidates.end()));
      kept += static_cast<int>(candidates.size());
      kept_without += static_cast<int>(all.size());
      for (int n = 0; n < 60; ++n) {
        std::array<double, 16> weights{};
        double sum = 0;
        for (double& w : weights) sum += w = random.Below(3) == 0 ? random.LogUniform(1e-3, 1) : 0;
        if (sum == 0) continue;
        Vec3d begin, end;
        for (size_t m = 0; m < 16; ++m) {
          begin = begin + pairs.from.points[m] * (weights[m] / sum);
          end = end + pairs.to.points[m] * (weights[m] / sum);
        }
        begin = begin + random.Direction() * (pairs.from.slack * random.Unit());
        end = end + random.Direction() * (pairs.to.slack * random.Unit());
        const Hit hit = tracer.Intersect(begin, end - begin, RayStart());
        if (!hit.IsHit() || hit.t > 1) continue;
        ++met;
        ASSERT_TRUE(std::binary_search(candidates.begin(), candidates.end(), hit.object));
      }
    }
  }
  EXPECT_GT(met, 2000);
  EXPECT_LT(kept, kept_without - kept_without / 50);
}

}  // namespace
}  // namespace linetree::test
