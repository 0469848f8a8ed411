// The same question asked in another way. What may be expected of the classical tracer's bits, and
// so of certified answers at e = 0:
//   scale by 2^k      equal: the tracer's formulas are homogeneous, so every intermediate number is
//                     the old one times a power of two, and nothing is near overflow
//   order of objects  equal in general position, with filters whose products are exact: the nearest
//                     hit does not depend on the order of search unless two are equally far, light
//                     terms are summed in the order of lights, and filters are multiplied in the
//                     order of objects, which rounds differently in another order
//   rigid motion      not equal: coordinates round anew. The promise holds in the moved scene, and
//                     the pictures agree but for rays that rounding takes across an edge
//   order and size of requests, state of the cache, threads
//                     equal: an answer is a function of scene, ray and options
#include <gtest/gtest.h>

#include <numeric>

#include "tests/stress/hard_rays.h"
#include "tests/stress/hard_scenes.h"
#include "tests/stress/moved_scene.h"
#include "tests/stress/promise.h"
#include "tests/support/random_scene.h"

namespace linetree::stress {
namespace {

ScenePtr Shared(Scene scene) { return std::make_shared<const Scene>(std::move(scene)); }

// Every shape, material and light, in general position; powers of two as filters.
Scene GeneralScene(test::Random& random) {
  const int count = random.Below(2) == 0 ? 22 : 60;  // with and without a hierarchy
  Scene scene = test::RandomScene(random, count, 3);
  for (Material& material : scene.materials) {
    if (!IsBlack(material.transmit)) material.transmit = {0.5, 1, 0.25};
  }
  return scene;
}

std::vector<Ray> GeneralRays(const Scene& scene, int count, test::Random& random) {
  std::vector<Ray> rays;
  AddSpread(scene, count / 2, random, rays);
  AddClusters(scene, 4, count / 2, random, rays);
  return rays;
}

// Not aimed at edges, as others are.
std::vector<Ray> RaysIntoBoxes(const Scene& scene, int count, test::Random& random) {
  std::vector<Ray> rays;
  while (static_cast<int>(rays.size()) < count) {
    const Box3& box = scene.objects[rays.size() % scene.objects.size()].bounds;
    const Vec3d origin = random.Direction() * 12;
    rays.push_back({origin, random.InBox(box.min, box.max) - origin});
  }
  return rays;
}

// Certified, second time round: at e = 0.
std::vector<Rgb> WarmAnswers(const ScenePtr& scene, const std::vector<Ray>& rays) {
  WorkerPool pool(2);
  SceneHost host(scene);
  Certified(host, rays, 0, {}, pool);
  std::vector<Rgb> radiances;
  for (const RayAnswer& answer : Certified(host, rays, 0, {}, pool)) {
    radiances.push_back(answer.radiance);
  }
  return radiances;
}

// Number of rays whose answers differ by more than `tolerance` of them or of the floor.
int CountDifferent(const std::vector<Rgb>& a, const std::vector<Rgb>& b, double tolerance,
                   double floor) {
  int different = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    different += ErrorOverBound(a[i], b[i], tolerance, floor) <= 1 ? 0 : 1;
  }
  return different;
}

TEST(MetamorphicTest, ScalingByPowersOfTwoKeepsBits) {
  test::Random random = RandomFor("Scaling");
  Largest largest("Scaling", 0, "different answers");
  for (int i = 0; i < Times(6); ++i) {
    const Scene scene = i % 2 == 0 ? GeneralScene(random) : Crowded(random);
    const std::vector<Ray> rays = GeneralRays(scene, 3000, random);
    const std::vector<Rgb> before = WarmAnswers(Shared(scene), rays);
    for (const int k : {-40, -1, 3, 30}) {
      const Motion motion = ScaledBy(std::ldexp(1.0, k));
      std::vector<Ray> moved;
      for (const Ray& ray : rays) moved.push_back(Moved(ray, motion));
      const auto after = WarmAnswers(Shared(Moved(scene, motion)), moved);
      EXPECT_TRUE(largest.Add(CountDifferent(before, after, 0, 0)))
          << "seed " << Seed() << " " << k;
    }
  }
}

TEST(MetamorphicTest, OrderOfObjectsKeepsBitsInGeneralPosition) {
  test::Random random = RandomFor("Permuting");
  Largest largest("Permuting", 0, "different answers");
  for (int i = 0; i < Times(8); ++i) {
    const Scene scene = GeneralScene(random);
    const std::vector<Ray> rays = GeneralRays(scene, 3000, random);
    const auto before = WarmAnswers(Shared(scene), rays);
    const auto after = WarmAnswers(Shared(Permuted(scene, random)), rays);
    EXPECT_TRUE(largest.Add(CountDifferent(before, after, 0, 0))) << "seed " << Seed() << " " << i;
  }
}

// A ray may end elsewhere when rounding takes it across an edge, within some 2^-40 of it here.
TEST(MetamorphicTest, RigidMotionsKeepPictures) {
  test::Random random = RandomFor("Moving");
  Largest promise("Moving, in the moved scene", 1, "of the promise");
  Largest largest("Moving, share of different answers", 1e-4);
  PromiseOptions options;
  options.bounds = {0, 0.05};
  int64_t different = 0, all = 0;
  for (int i = 0; i < Times(6); ++i) {
    const Scene scene = GeneralScene(random);
    const std::vector<Ray> rays = RaysIntoBoxes(scene, 3000, random);
    const Motion motion = Rigid(random, i % 3 == 0 ? 0 : 10);
    std::vector<Ray> moved;
    for (const Ray& ray : rays) moved.push_back(Moved(ray, motion));
    const Scene after = Moved(scene, motion);
    ExpectPromise(Shared(after), moved, promise, options);
    different += CountDifferent(Classical(scene, rays, {}), Classical(after, moved, {}), 0x1p-24,
                                RadianceFloor(scene));
    all += static_cast<int64_t>(rays.size());
  }
  EXPECT_TRUE(largest.Add(static_cast<double>(different) / static_cast<double>(all)));
}

std::vector<std::vector<Ray>> Shuffled(std::vector<Ray> rays, size_t batch, test::Random& random) {
  for (int i = static_cast<int>(rays.size()) - 1; i > 0; --i) {
    std::swap(rays[static_cast<size_t>(i)], rays[static_cast<size_t>(random.Int(0, i))]);
  }
  std::vector<std::vector<Ray>> batches;
  for (size_t begin = 0; begin < rays.size(); begin += batch) {
    const size_t end = std::min(rays.size(), begin + batch);
    batches.emplace_back(rays.begin() + static_cast<std::ptrdiff_t>(begin),
                         rays.begin() + static_cast<std::ptrdiff_t>(end));
  }
  return batches;
}

TEST(MetamorphicTest, OrderAndSizeOfRequestsKeepThePromise) {
  test::Random random = RandomFor("Requests");
  Largest largest("Order of requests", 1, "of the promise");
  WorkerPool pool(2);
  for (int i = 0; i < Times(4); ++i) {
    const ScenePtr scene = Shared(i % 2 == 0 ? Touching(random) : GeneralScene(random));
    const double floor = RadianceFloor(*scene);
    std::vector<Ray> rays = HardRays(*scene, 4000, random);
    for (const double bound : Bounds()) {
      SceneHost host(scene);
      for (const size_t size : {size_t{1000}, size_t{37}, rays.size(), size_t{250}}) {
        for (const auto& batch : Shuffled(rays, size, random)) {
          const auto classical = Classical(*scene, batch, {});
          const auto answers = Certified(host, batch, bound, {}, pool);
          for (size_t k = 0; k < batch.size(); ++k) {
            const double error = ErrorOverBound(answers[k].radiance, classical[k], bound, floor);
            ASSERT_TRUE(largest.Add(error)) << "seed " << Seed() << ", batches of " << size;
          }
        }
      }
    }
  }
}

TEST(MetamorphicTest, TinyBudgetsKeepThePromise) {
  test::Random random = RandomFor("Budgets");
  Largest largest("Tiny budgets", 1, "of the promise");
  for (int i = 0; i < Times(4); ++i) {
    const ScenePtr scene = Shared(i % 2 == 0 ? Touching(random) : Crowded(random));
    const std::vector<Ray> rays = HardRays(*scene, 4000, random);
    for (const uint64_t bytes : {0, 1, 5'000, 50'000, 200'000, 2'000'000}) {
      PromiseOptions options;
      options.memory_bytes = bytes;
      options.rounds = 4;
      ExpectPromise(scene, rays, largest, options);
    }
  }
}

// One client: rounds see the cache only between builds, so threads change nothing at any bound.
TEST(MetamorphicTest, ThreadsKeepBits) {
  test::Random random = RandomFor("Threads");
  Largest largest("Threads", 0, "different answers");
  for (int i = 0; i < Times(4); ++i) {
    const ScenePtr scene = Shared(i % 2 == 0 ? Nested(random) : GeneralScene(random));
    const std::vector<Ray> rays = HardRays(*scene, 4000, random);
    for (const double bound : Bounds()) {
      std::vector<Rgb> first;
      for (const int threads : {1, 2, 5}) {
        WorkerPool pool(threads);
        CacheOptions cache;
        cache.memory_bytes = i < 2 ? uint64_t{64} << 20 : 100'000;
        cache.always_ask = true;  // small caches would pause
        SceneHost host(scene, cache);
        std::vector<Rgb> radiances;
        for (int round = 0; round < 3; ++round) {
          for (const RayAnswer& answer : Certified(host, rays, bound, {}, pool)) {
            radiances.push_back(answer.radiance);
          }
        }
        if (threads == 1) first = radiances;
        EXPECT_TRUE(largest.Add(CountDifferent(first, radiances, 0, 0)))
            << "seed " << Seed() << ", " << threads << " threads, bound " << bound;
      }
    }
  }
}

}  // namespace
}  // namespace linetree::stress
