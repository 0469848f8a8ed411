#include "core/certify/solid_interiors.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/certify/random_cells.h"
#include "tests/support/random.h"
#include "tests/support/scene_builder.h"

namespace linetree {
namespace {

class OnlyInteriors : public PathLists {
 public:
  explicit OnlyInteriors(const Tracer& tracer) : interiors_(tracer) {}
  const PathStep* Find(const Hit&, const Vec3d&) const override { return nullptr; }
  const SolidInterior* Inside(int object) const override { return interiors_.Find(object); }

 private:
  const SolidInteriors interiors_;
};

// Glass balls in a heap, some inside others, with matte ones between them and in them.
Scene GlassHeap(test::Random& random, double scale = 1) {
  Scene scene;
  scene.background = {0.3, 0.4, 0.5};
  scene.ambient = {0.2, 0.2, 0.2};
  test::AddMaterial(scene, test::Glass({0.8, 0.9, 0.7}, 1.5, {0.1, 0.1, 0.1}));
  test::AddMaterial(scene, test::Matte({0.5, 0.5, 0.5}));
  for (int i = 0; i < 12; ++i) {
    const double r = random.LogUniform(0.05, 1);
    test::AddObject(scene, test::Sphere(random.InCube(2) * scale, r * scale), i % 3 == 0 ? 1 : 0);
  }
  test::AddObject(scene, test::Box(Vec3d{-6, -6, -2.1} * scale, Vec3d{6, 6, -2} * scale), 1);
  scene.lights.push_back(test::PointLight(Vec3d{3, -5, 8} * scale));
  return scene;
}

struct Searches {
  RayCounts plain, listed;
};

// Rays at the heap from `distance` away: no answer may change by a bit.
Searches CompareAnswers(const Scene& scene, test::Random& random, double distance, double scale) {
  Searches searches;
  const Tracer tracer(scene);
  const OnlyInteriors interiors(tracer);
  for (int i = 0; i < 500; ++i) {
    const Vec3d eye = random.Direction() * distance, at = random.InCube(2) * scale;
    const Vec3d direction = Normalized(at - eye);
    const Hit hit = tracer.Intersect(eye, direction, {});
    if (!hit.IsHit()) continue;
    const Rgb classical = tracer.RadianceFromHit(hit, eye, direction, {}, searches.plain);
    EXPECT_EQ(tracer.RadianceFromHit(hit, eye, direction, {}, test::NoLights(), &interiors,
                                     searches.listed),
              classical);
  }
  return searches;
}

TEST(SolidInteriorsTest, RaysInsideFindTheirFarSideWithoutASearch) {
  test::Random random(5);
  uint64_t listed = 0, refracted = 0;
  for (int s = 0; s < 20; ++s) {
    const Searches searches = CompareAnswers(GlassHeap(random), random, 8, 1);
    EXPECT_EQ(searches.listed.intersect + searches.listed.listed_branches,
              searches.plain.intersect);
    listed += searches.listed.listed_branches;
    refracted += searches.plain.refracted;
  }
  EXPECT_GT(listed, refracted / 5);
}

// From far away hits lie anywhere, and so do the rays that leave them.
TEST(SolidInteriorsTest, RaysFromFarAwayChangeNoAnswer) {
  test::Random random(6);
  for (const double distance : {1e6, 1e12, 1e16, 1e100, 1e290}) {
    for (int s = 0; s < 4; ++s) CompareAnswers(GlassHeap(random), random, distance, 1);
  }
}

TEST(SolidInteriorsTest, ScalesChangeNoAnswer) {
  test::Random random(7);
  for (const double scale : {1e-20, 1e-9, 1e9, 1e20}) {
    CompareAnswers(GlassHeap(random, scale), random, 8 * scale, scale);
  }
}

TEST(SolidInteriorsTest, ListsAllThatOverlapsTheSolid) {
  test::Random random(8);
  int lists = 0;
  for (int s = 0; s < 50; ++s) {
    const Scene scene = GlassHeap(random);
    const Tracer tracer(scene);
    const SolidInteriors interiors(tracer);
    for (int i = 0; i < static_cast<int>(scene.objects.size()); ++i) {
      const SolidInterior* interior = interiors.Find(i);
      ASSERT_EQ(interior != nullptr, !IsBlack(scene.MaterialOf(i).transmit));
      if (interior == nullptr) continue;
      ++lists;
      for (int other = 0; other < static_cast<int>(scene.objects.size()); ++other) {
        const Box3& bounds = scene.objects[static_cast<size_t>(other)].bounds;
        EXPECT_EQ(std::ranges::binary_search(interior->candidates, other),
                  interior->room.Overlaps(bounds));
      }
    }
  }
  EXPECT_GT(lists, 300);
}

TEST(SolidInteriorsTest, CrowdedSolidsHaveNoList) {
  test::Random random(9);
  Scene scene = GlassHeap(random);
  const int solid = test::AddObject(scene, test::Sphere({0, 0, 0}, 5), 0);
  for (size_t i = 0; i < kMaxCandidates; ++i) {
    test::AddObject(scene, test::Sphere(random.InCube(2), 0.1), 1);
  }
  EXPECT_EQ(SolidInteriors(Tracer(scene)).Find(solid), nullptr);
}

}  // namespace
}  // namespace linetree
