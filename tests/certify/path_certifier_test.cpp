// What a certified cell says is held against the classical tracer.
#include "core/certify/path_certifier.h"

#include <gtest/gtest.h>

#include <cstdio>

#include "tests/certify/random_cells.h"

namespace linetree::test {
namespace {

PathLimits Deep() {
  PathLimits limits;
  limits.max_depth = 6;
  return limits;
}

// What was seen of the cells of some scenes.
struct Seen {
  int cells = 0, certified = 0, followed = 0, rays = 0;
  double worst = 0;  // largest error / spread
};

// Holds one cell against rays through it; a cell that is not certified has its steps tested.
void Check(const Tracer& tracer, const ObjectChart& chart, const RandomCell& cell,
           const CellPaths& paths, Random& random, int rays, Seen& seen) {
  ++seen.cells;
  if (paths.steps.empty()) return;
  ++seen.followed;
  const bool certified = paths.verdict == Verdict::kCertified;
  seen.certified += certified;
  ASSERT_EQ(paths.interpolant != nullptr, certified);
  const double floor = RadianceFloor(tracer.scene());
  for (int i = 0; i < rays; ++i) {
    const RayCoords u = RandomCoords(random);
    const Ray ray = cell.At(chart, u);
    const Hit hit = tracer.IntersectObjectLine(cell.object, ray.origin, ray.direction);
    if (!hit.IsHit() || !paths.steps[0].EndsAt(hit)) {
      // Charts of planar objects are wider than the object.
      const auto& shape = tracer.scene().objects[static_cast<size_t>(cell.object)].shape;
      ASSERT_TRUE(!certified || IsPlanar(shape));
      continue;
    }
    ++seen.rays;
    RayCounts counts;
    const Rgb truth = tracer.RadianceFromHit(hit, ray.origin, ray.direction, Deep(), counts);
    const OneCell lists(paths);
    const Rgb replayed =
        tracer.RadianceFromHit(hit, ray.origin, ray.direction, Deep(), NoLights(), &lists, counts);
    ASSERT_EQ(replayed, truth);
    if (!certified) continue;
    const Rgb answer = Evaluate(*paths.interpolant, u);
    for (int c = 0; c < 3; ++c) {
      const double error = std::abs(answer[c] - truth[c]) / std::max(truth[c], floor);
      ASSERT_LE(error, paths.spread);
      seen.worst = std::max(seen.worst, error / paths.spread);
    }
  }
}

Seen CheckCellsOf(const Scene& scene, uint64_t seed, int cells, double edge_from, double edge_to,
                  int rays = 25) {
  Seen seen;
  const Tracer tracer(scene);
  const PathCertifier certifier(tracer);
  Random random(seed);
  for (int i = 0; i < cells; ++i) {
    const int object = random.Below(static_cast<int>(scene.objects.size()));
    const ObjectChart chart(scene.objects[static_cast<size_t>(object)]);
    const double edge = random.LogUniform(edge_from, edge_to);
    const auto cell = CellOf(tracer, chart, object, edge, random);
    if (!cell) continue;
    const CellPaths paths =
        certifier.Certify(object, chart, cell->pair, cell->box, Deep(), nullptr);
    Check(tracer, chart, *cell, paths, random, rays, seen);
    if (testing::Test::HasFatalFailure()) break;
  }
  return seen;
}

TEST(PathCertifier, AnswersAreWithinTheirSpreadInRandomScenes) {
  Seen all;
  for (int s = 0; s < 60; ++s) {
    Random random(static_cast<uint64_t>(100 + s));
    const Scene scene = RandomScene(random, 2 + s % 10, 3.5);
    const Seen seen = CheckCellsOf(scene, static_cast<uint64_t>(s), 100, 0.002, 0.15);
    ASSERT_FALSE(testing::Test::HasFatalFailure()) << "scene " << s;
    all.cells += seen.cells;
    all.certified += seen.certified;
    all.rays += seen.rays;
    all.worst = std::max(all.worst, seen.worst);
  }
  std::printf("%d cells, %d certified, %d rays, worst error / spread %.4f\n", all.cells,
              all.certified, all.rays, all.worst);
  EXPECT_GT(all.certified, 700);
  EXPECT_LE(all.worst, 1);
}

// Down to boxes whose sides are one ulp, or nothing at all along some axes.
TEST(PathCertifier, CellsAreDividedToTheLastUlp) {
  Seen all;
  for (int s = 0; s < 30; ++s) {
    Random random(static_cast<uint64_t>(300 + s));
    const Scene scene = RandomScene(random, 2 + s % 6, 3);
    const Seen seen = CheckCellsOf(scene, static_cast<uint64_t>(s), 100, 0x1p-54, 1e-9, 8);
    ASSERT_FALSE(testing::Test::HasFatalFailure()) << "scene " << s;
    all.cells += seen.cells;
    all.certified += seen.certified;
    all.followed += seen.followed;
  }
  std::printf("%d cells, %d followed, %d certified\n", all.cells, all.followed, all.certified);
  EXPECT_GT(all.certified, 500);
}

// A white disc straight below a light that fades with the square of the distance: radiance is
// curved to one side about the disc's middle, along both axes, and the bound is attained.
TEST(PathCertifier, SpreadIsAttained) {
  Scene scene;
  AddMaterial(scene, Matte({1, 1, 1}));
  AddObject(scene, Disc({0, 0, 0}, {0, 0, 1}, 1));
  scene.lights.push_back(PointLight({0.05, -0.03, 6}));
  const Seen seen = CheckCellsOf(scene, 5, 300, 0.02, 0.1, 60);
  std::printf("worst error / spread %.4f\n", seen.worst);
  EXPECT_GT(seen.certified, 100);
  EXPECT_GT(seen.worst, 0.9);
  EXPECT_LE(seen.worst, 1);
}

// The floor lies in the shadow of a ball, which rays to the light cross twice, and of a pane, which
// they cross once: what is left of the light is the same everywhere.
TEST(PathCertifier, LightThroughGlassIsCertain) {
  Scene scene;
  const int glass = AddMaterial(scene, Glass({0.7, 0.8, 0.9}, 1.5));
  Material floor = Matte({0.6, 0.5, 0.4});
  floor.specular = {0.3, 0.3, 0.3};
  floor.exponent = 20;
  AddObject(scene, Disc({0, 0, 0}, {0, 0, 1}, 0.3), AddMaterial(scene, floor));
  AddObject(scene, Sphere({0, 0, 2}, 1), glass);
  AddObject(scene, Disc({0, 0, 4}, {0.1, 0, 1}, 2), glass);
  scene.lights.push_back(PointLight({0, 0, 6}));
  const Tracer tracer(scene);
  const PathCertifier certifier(tracer);
  const ObjectChart chart(scene.objects[0]);
  Random random(9);
  Seen seen;
  for (int i = 0; i < 200; ++i) {
    const auto cell = CellOf(tracer, chart, 0, 0.02, random);
    if (!cell) continue;
    const CellPaths paths = certifier.Certify(0, chart, cell->pair, cell->box, Deep(), nullptr);
    Check(tracer, chart, *cell, paths, random, 25, seen);
    ASSERT_FALSE(testing::Test::HasFatalFailure());
  }
  EXPECT_GT(seen.certified, 0.95 * seen.followed);
  EXPECT_GT(seen.certified, 100);
}

// Where the light sets on a glossy ball, cosines have a kink and the highlight breaks off.
TEST(PathCertifier, TerminatorsAreBounded) {
  Scene scene;
  Material gloss = Matte({0.6, 0.5, 0.4});
  gloss.specular = {0.5, 0.5, 0.5};
  gloss.exponent = 10;
  gloss.ambient = {0.2, 0.2, 0.2};
  scene.ambient = {1, 1, 1};
  AddObject(scene, Sphere({0, 0, 0}, 1), AddMaterial(scene, gloss));
  const Vec3d light{0, 0, 6};
  scene.lights.push_back(PointLight(light));
  const Tracer tracer(scene);
  const PathCertifier certifier(tracer);
  const ObjectChart chart(scene.objects[0]);
  Random random(10);
  Seen seen;
  for (int i = 0; i < 4000; ++i) {
    const auto cell = CellOf(tracer, chart, 0, 0.05, random);
    if (!cell) continue;
    int facing = 0, rays = 0;
    for (int m = 0; m < 16; ++m) {
      RayCoords u;
      for (int k = 0; k < 4; ++k) u[static_cast<size_t>(k)] = m >> k & 1;
      const Ray ray = cell->At(chart, u);
      const Hit hit = tracer.IntersectObjectLine(0, ray.origin, ray.direction);
      if (!hit.IsHit()) continue;
      ++rays;
      facing += Dot(hit.normal, light - hit.point) > 0;
    }
    if (facing == 0 || facing == rays) continue;
    const CellPaths paths = certifier.Certify(0, chart, cell->pair, cell->box, Deep(), nullptr);
    Check(tracer, chart, *cell, paths, random, 40, seen);
    ASSERT_FALSE(testing::Test::HasFatalFailure());
  }
  std::printf("%d of %d certified, worst error / spread %.4f\n", seen.certified, seen.cells,
              seen.worst);
  EXPECT_GT(seen.certified, 100);
  EXPECT_GT(seen.worst, 0.5);
}

TEST(PathCertifier, ThinShapesAndOpenFrustums) {
  Scene scene;
  scene.background = {0.2, 0.3, 0.4};
  const int mirror = AddMaterial(scene, Mirror({0.8, 0.8, 0.8}));
  const int pane = AddMaterial(scene, Glass({0.7, 0.8, 0.9}, 1));
  const int matte = AddMaterial(scene, Matte({0.6, 0.5, 0.4}));
  AddObject(scene, Frustum({0, 0, -1}, {0, 0, 1}, 1, 0.8, true), mirror);
  AddObject(scene, Disc({3, 0, 0}, {1, 0, 0.3}, 1), pane);
  AddObject(scene, Polygon({{-3, -1, -1}, {-3, 1, -1}, {-3, 1, 1}, {-3, -1, 1}}), mirror);
  AddObject(scene, Frustum({0, 4, -1}, {0, 4, 1}, 1, 1, true), matte);
  AddObject(scene,
            SmoothTriangle({{-1, -3, -1}, {1, -3, -1}, {0, -3, 1}},
                           {{0.3, 1, 0}, {-0.2, 1, 0.1}, {0, 1, -0.3}}),
            matte);
  scene.lights.push_back(PointLight({2, 3, 5}));
  const Seen seen = CheckCellsOf(scene, 6, 1500, 0.002, 0.1);
  std::printf("%d of %d certified\n", seen.certified, seen.cells);
  EXPECT_GT(seen.certified, 300);
}

// Rays leave glass at all angles; those that are reflected totally are told from those that leave.
TEST(PathCertifier, GlassWithTotalReflection) {
  Scene scene;
  scene.background = {0.2, 0.3, 0.4};
  const int glass = AddMaterial(scene, Glass({0.9, 0.9, 0.9}, 1.6, {0.1, 0.1, 0.1}));
  AddObject(scene, Box({-1, -1, -1}, {1, 1, 1}), glass);
  AddObject(scene, Sphere({3.5, 0, 0}, 1), glass);
  AddObject(scene, Frustum({0, 3, -1}, {0, 3, 1}, 1, 0.5), glass);
  scene.lights.push_back(DirectionalLight({1, 2, 3}));
  const Seen seen = CheckCellsOf(scene, 7, 1500, 0.001, 0.05);
  std::printf("%d of %d certified\n", seen.certified, seen.cells);
  EXPECT_GT(seen.certified, 200);
}

// A cell whose rays pass a ball on both sides of its silhouette.
TEST(PathCertifier, SilhouettesAreRefused) {
  Scene scene;
  AddMaterial(scene, Matte({1, 1, 1}));
  AddObject(scene, Sphere({0, 0, 0}, 1));
  scene.lights.push_back(PointLight({0, 0, 6}));
  const Tracer tracer(scene);
  const PathCertifier certifier(tracer);
  const ObjectChart chart(scene.objects[0]);
  Random random(8);
  for (int i = 0; i < 200; ++i) {
    const Vec3d edge = random.Direction();
    const Vec3d along = Normalized(Cross(edge, random.Direction()));
    // Just inside the silhouette.
    const Vec3d point = edge * random.Uniform(0.995, 0.999);
    const int pair = chart.PairOf(along);
    const auto coords = chart.CoordsOf(pair, point, along);
    ASSERT_TRUE(coords);
    CellBox box;
    for (size_t k = 0; k < 4; ++k) {
      box.from[k] = std::max(0.0, (*coords)[k] - 0.02);
      box.to[k] = std::min(1.0, (*coords)[k] + 0.02);
    }
    const CellPaths paths = certifier.Certify(0, chart, pair, box, Deep(), nullptr);
    EXPECT_EQ(paths.verdict, Verdict::kGap);
    EXPECT_TRUE(paths.steps.empty());
  }
}

// With a parent's lists a child looks at fewer objects and says the same or more; its candidates
// are the parent's.
TEST(PathCertifier, ChildrenFilterTheListsOfTheirParents) {
  int listed = 0;
  for (int s = 0; s < 20; ++s) {
    Random random(static_cast<uint64_t>(200 + s));
    const Scene scene = RandomScene(random, 12, 3);
    const Tracer tracer(scene);
    const PathCertifier certifier(tracer);
    Seen seen;
    for (int i = 0; i < 100; ++i) {
      const int object = random.Below(12);
      const ObjectChart chart(scene.objects[static_cast<size_t>(object)]);
      const auto parent = CellOf(tracer, chart, object, random.LogUniform(0.01, 0.1), random);
      if (!parent) continue;
      const CellPaths above =
          certifier.Certify(object, chart, parent->pair, parent->box, Deep(), nullptr);
      RandomCell child = *parent;
      for (size_t k = 0; k < 4; ++k) {
        const double middle = (child.box.from[k] + child.box.to[k]) / 2;
        (random.Below(2) == 0 ? child.box.from : child.box.to)[k] = middle;
      }
      const CellPaths with =
          certifier.Certify(object, chart, child.pair, child.box, Deep(), &above);
      const CellPaths without =
          certifier.Certify(object, chart, child.pair, child.box, Deep(), nullptr);
      EXPECT_EQ(with.verdict, without.verdict);
      Check(tracer, chart, child, with, random, 10, seen);
      ASSERT_FALSE(testing::Test::HasFatalFailure());
      if (with.steps.empty() || above.steps.empty()) continue;
      if (with.steps[0].object != above.steps[0].object ||
          with.steps[0].face != above.steps[0].face || with.steps[0].side != above.steps[0].side ||
          with.steps[0].reflected == 0 || above.steps[0].reflected == 0) {
        continue;
      }
      const PathStep& ours = with.steps[static_cast<size_t>(with.steps[0].reflected)];
      const PathStep& theirs = above.steps[static_cast<size_t>(above.steps[0].reflected)];
      if (!ours.listed || !theirs.listed) continue;
      ++listed;
      EXPECT_TRUE(std::includes(theirs.candidates.begin(), theirs.candidates.end(),
                                ours.candidates.begin(), ours.candidates.end()));
    }
  }
  EXPECT_GT(listed, 50);
}

}  // namespace
}  // namespace linetree::test
