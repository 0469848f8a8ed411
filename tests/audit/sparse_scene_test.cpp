#include "core/audit/sparse_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <variant>

#include "core/audit/random_stream.h"
#include "core/trace/intersect.h"
#include "core/trace/tracer.h"

namespace linetree {
namespace {

constexpr uint64_t kScenes = 300;
constexpr SparseFamily kFamilies[] = {SparseFamily::kEven, SparseFamily::kOpaque};

bool IsGround(const Object& object) { return object.bounds.Extent().x > 11; }

// Shares of materials of a family's solids and of its floors and walls.
struct Census {
  double solids = 0, mirrors = 0, glass = 0, ellipsoids = 0;
  double grounds = 0, mirroring_grounds = 0;
};

Census CensusOf(SparseFamily family) {
  Census census;
  for (uint64_t seed = 0; seed < kScenes; ++seed) {
    const auto scene = MakeSparseScene(family, seed);
    for (size_t i = 0; i < scene->objects.size(); ++i) {
      const Object& object = scene->objects[i];
      const Material& material = scene->MaterialOf(static_cast<int>(i));
      const bool reflects = !IsBlack(material.reflect), transmits = !IsBlack(material.transmit);
      if (IsGround(object)) {
        ++census.grounds;
        census.mirroring_grounds += reflects;
        EXPECT_FALSE(transmits);
      } else if (IsSolid(object.shape)) {
        ++census.solids;
        census.glass += transmits;
        census.mirrors += reflects && !transmits;
        const auto* sphere = std::get_if<SphereShape>(&object.shape);
        const Vec3d extent = object.bounds.Extent();
        census.ellipsoids += sphere != nullptr && std::abs(extent.x - extent.y) > 1e-6;
      } else {
        EXPECT_FALSE(transmits);
      }
    }
  }
  return census;
}

// Five standard deviations of a share of n.
double Spread(double share, double n) { return 5 * std::sqrt(share * (1 - share) / n); }

TEST(SparseSceneTest, MaterialsAreAsFrequentAsTheirFamilySays) {
  const Census even = CensusOf(SparseFamily::kEven);
  EXPECT_NEAR(even.glass / even.solids, 0.25, Spread(0.25, even.solids));
  EXPECT_NEAR(even.mirrors / even.solids, 0.25, Spread(0.25, even.solids));
  EXPECT_NEAR(even.mirroring_grounds / even.grounds, 1 / 3.0, Spread(1 / 3.0, even.grounds));
  EXPECT_EQ(even.ellipsoids, 0);
  const Census opaque = CensusOf(SparseFamily::kOpaque);
  EXPECT_NEAR(opaque.glass / opaque.solids, 0.18, Spread(0.18, opaque.solids));
  EXPECT_NEAR(opaque.mirrors / opaque.solids, 0.22, Spread(0.22, opaque.solids));
  EXPECT_NEAR(opaque.ellipsoids / opaque.solids, 0.2, Spread(0.2, opaque.solids));
}

// Points of surfaces at random, none of which another solid may contain.
TEST(SparseSceneTest, ObjectsKeepApart) {
  uint64_t points = 0;
  for (const SparseFamily family : kFamilies) {
    for (uint64_t seed = 0; seed < 40; ++seed) {
      const auto scene = MakeSparseScene(family, seed);
      const Tracer tracer(*scene);
      RandomStream random(seed);
      const int count = static_cast<int>(scene->objects.size());
      for (int object = 0; object < count; ++object) {
        const Box3& bounds = scene->objects[static_cast<size_t>(object)].bounds;
        for (int i = 0; i < 50; ++i) {
          const Hit hit = tracer.IntersectObjectLine(object, random.InBox(bounds.min, bounds.max),
                                                     random.Direction());
          if (!hit.IsHit()) continue;
          ++points;
          for (int other = 0; other < count; ++other) {
            const Shape& shape = scene->objects[static_cast<size_t>(other)].shape;
            if (other == object || !IsSolid(shape)) continue;
            ASSERT_FALSE(ContainsStrictly(shape, hit.point)) << seed << ": " << object << other;
          }
        }
      }
    }
  }
  EXPECT_GT(points, 10'000u);
}

TEST(SparseSceneTest, TheSeedDecides) {
  for (const SparseFamily family : kFamilies) {
    const auto scene = MakeSparseScene(family, 7), again = MakeSparseScene(family, 7);
    const auto other = MakeSparseScene(family, 8);
    EXPECT_EQ(scene->materials, again->materials);
    EXPECT_EQ(scene->lights, again->lights);
    ASSERT_EQ(scene->objects.size(), again->objects.size());
    for (size_t i = 0; i < scene->objects.size(); ++i) {
      EXPECT_EQ(scene->objects[i].shape, again->objects[i].shape);
    }
    EXPECT_FALSE(scene->lights == other->lights);
  }
}

}  // namespace
}  // namespace linetree
