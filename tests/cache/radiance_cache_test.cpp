#include "core/cache/radiance_cache.h"

#include <gtest/gtest.h>

#include <thread>

#include "tests/support/demo_scenes.h"

namespace linetree {
namespace {

const ParallelLoop kSerial = [](size_t count, const std::function<void(size_t)>& body) {
  for (size_t i = 0; i < count; ++i) body(i);
};

class RadianceCacheTest : public testing::Test {
 protected:
  RadianceCacheTest() : scene_(test::BallsOnFloor(5, 40)), tracer_(*scene_) {}

  // A random eye ray's query, or none.
  std::optional<CellQuery> RandomQuery(const RadianceCache& cache, test::Random& random) const {
    const Vec3d eye = random.InBox({-5, -9, 1}, {5, -7, 6});
    const Vec3d at = random.InBox({-4, -3, 0}, {4, 4, 2});
    const Ray ray{eye, Normalized(at - eye)};
    return cache.QueryFor(tracer_.Intersect(ray.origin, ray.direction, {}), ray);
  }

  // Looks rays up and builds every cell that is missing, `rounds` times.
  void Exercise(RadianceCache& cache, uint64_t seed, int rounds, const PathLimits& limits = {}) {
    test::Random random(seed);
    for (int round = 0; round < rounds; ++round) {
      const auto session = cache.Open(limits);
      std::vector<CellRef> cells;
      for (int i = 0; i < 40; ++i) {
        const auto query = RandomQuery(cache, random);
        if (!query) continue;
        CellAnswer answer;
        cache.Find(session, 0.1, {&*query, 1}, {&answer, 1});
        const CellRef ref{query->object, query->pair, answer.cell};
        const bool known = std::find(cells.begin(), cells.end(), ref) != cells.end();
        if (answer.kind == Lookup::Kind::kUnbuilt && !known) cells.push_back(ref);
      }
      cache.Build(session, cells, kSerial);
      ASSERT_LE(cache.ByteSize(), cache.options().memory_bytes);
      ASSERT_EQ(cache.ByteSize(), cache.CountBytes());
    }
  }

  std::shared_ptr<const Scene> scene_;
  Tracer tracer_;
};

TEST_F(RadianceCacheTest, BytesAreExactAndWithinTheBudget) {
  for (const uint64_t budget : {0, 5'000, 60'000, 300'000, 4'000'000}) {
    CacheOptions options;
    options.memory_bytes = budget;
    RadianceCache cache(tracer_, options);
    Exercise(cache, 41, 60);
  }
}

TEST_F(RadianceCacheTest, ASmallerBudgetTakesEffectAtOnce) {
  RadianceCache cache(tracer_, {});
  Exercise(cache, 46, 60);
  ASSERT_GT(cache.ByteSize(), 100'000u);
  cache.SetMemoryBytes(100'000);
  EXPECT_LE(cache.ByteSize(), 100'000u);
  EXPECT_EQ(cache.ByteSize(), cache.CountBytes());
  EXPECT_GT(cache.CellCount(), 0u);
  Exercise(cache, 47, 20);
  EXPECT_LE(cache.ByteSize(), 100'000u);
}

TEST_F(RadianceCacheTest, EvictionTakesWhatWasUsedLongestAgo) {
  CacheOptions options;
  options.memory_bytes = 200'000;
  RadianceCache cache(tracer_, options);
  // One cell that is asked for in every round survives all others.
  test::Random random(42);
  std::optional<CellQuery> pinned;
  while (!pinned) pinned = RandomQuery(cache, random);
  const CellRef root{pinned->object, pinned->pair, CellId{}};
  cache.Build(cache.Open({}), {&root, 1}, kSerial);
  uint64_t cells_before = 0;
  bool evicted = false;
  for (int i = 0; i < 60; ++i) {
    const auto session = cache.Open({});
    CellAnswer answer;
    cache.Find(session, 0.1, {&*pinned, 1}, {&answer, 1});
    ASSERT_NE(answer.verdict, Verdict::kUntried) << "round " << i;
    Exercise(cache, 100 + static_cast<uint64_t>(i), 1);
    evicted |= cache.CellCount() < cells_before;
    cells_before = cache.CellCount();
  }
  EXPECT_TRUE(evicted) << "the budget was too large for the test to mean anything";
}

TEST_F(RadianceCacheTest, ACancelledBuildKeepsTheCellsThatAreDone) {
  RadianceCache whole(tracer_, {});
  test::Random random(44);
  std::vector<CellRef> roots;
  while (roots.size() < 12) {
    const auto query = RandomQuery(whole, random);
    if (!query) continue;
    const CellRef root{query->object, query->pair, CellId{}};
    if (std::find(roots.begin(), roots.end(), root) == roots.end()) roots.push_back(root);
  }
  const uint64_t all = whole.Build(whole.Open({}), roots, kSerial).cells_tried;
  EXPECT_EQ(all, roots.size());
  uint64_t kept_some = 0;
  for (int bodies = 0; bodies < 250; bodies += 3) {
    RadianceCache cache(tracer_, {});
    int left = bodies;
    const ParallelLoop cut_short = [&](size_t count, const std::function<void(size_t)>& body) {
      for (size_t i = 0; i < count && left > 0; ++i, --left) body(i);
    };
    const BuildStats built = cache.Build(cache.Open({}), roots, cut_short);
    EXPECT_EQ(cache.CellCount(), built.cells_tried) << bodies;
    EXPECT_EQ(cache.ByteSize(), cache.CountBytes());
    kept_some += built.cells_tried > 0 && built.cells_tried < all ? 1 : 0;
  }
  EXPECT_GT(kept_some, 0u) << "always all or nothing";
}

TEST_F(RadianceCacheTest, CellsBelongToTheirPathLimits) {
  RadianceCache cache(tracer_, {});
  test::Random random(43);
  std::optional<CellQuery> query;
  while (!query) query = RandomQuery(cache, random);
  const CellRef root{query->object, query->pair, CellId{}};
  const auto deep = cache.Open({4, 0.01}), shallow = cache.Open({1, 0.01});
  EXPECT_EQ(cache.Build(deep, {&root, 1}, kSerial).cells_tried, 1u);
  CellAnswer answer;
  cache.Find(shallow, 0.1, {&*query, 1}, {&answer, 1});
  EXPECT_EQ(answer.cell, CellId{});
  EXPECT_EQ(answer.kind, Lookup::Kind::kUnbuilt);
}

TEST_F(RadianceCacheTest, TheSeventeenthPathLimitTakesTheOldestOnesPlace) {
  RadianceCache cache(tracer_, {});
  for (int depth = 1; depth <= 16; ++depth) Exercise(cache, 44, 2, {depth, 0.01});
  const uint64_t cells = cache.CellCount();
  Exercise(cache, 44, 2, {4, 0.5});
  EXPECT_LE(cache.CellCount(), cells + 80);
  EXPECT_EQ(cache.ByteSize(), cache.CountBytes());
}

TEST_F(RadianceCacheTest, ConstantObjectsAreNotLookedUp) {
  auto plain = std::make_shared<Scene>(*scene_);
  plain->lights.clear();
  for (Material& m : plain->materials) m.reflect = m.transmit = {};
  const Tracer tracer(*plain);
  const RadianceCache cache(tracer, {});
  const Ray down{{0, 0, 9}, {0, 0, -1}};
  const Hit hit = tracer.Intersect(down.origin, down.direction, {});
  ASSERT_TRUE(hit.IsHit());
  EXPECT_FALSE(cache.QueryFor(hit, down));
}

TEST_F(RadianceCacheTest, VerdictsCountEveryCell) {
  RadianceCache cache(tracer_, {});
  Exercise(cache, 45, 30);
  uint64_t sum = 0;
  for (const auto& object : cache.CellVerdicts()) {
    EXPECT_EQ(object[static_cast<size_t>(Verdict::kUntried)], 0u);
    for (const uint64_t n : object) sum += n;
  }
  EXPECT_EQ(sum, cache.CellCount());
  EXPECT_GT(sum, 100u);
  cache.Clear();
  EXPECT_EQ(cache.CellCount(), 0u);
  EXPECT_EQ(cache.ByteSize(), cache.CountBytes());
}

TEST_F(RadianceCacheTest, ManyThreadsMayBuildEvictAndAsk) {
  CacheOptions options;
  options.memory_bytes = 250'000;
  RadianceCache cache(tracer_, options);
  std::vector<std::thread> threads;
  for (uint64_t t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      test::Random random(50 + t);
      for (int round = 0; round < 40; ++round) {
        const auto session = cache.Open({random.Int(2, 4), 0.01});
        for (int i = 0; i < 20; ++i) {
          const auto query = RandomQuery(cache, random);
          if (!query) continue;
          CellAnswer answer;
          cache.Find(session, 0.1, {&*query, 1}, {&answer, 1});
          if (answer.kind != Lookup::Kind::kUnbuilt) continue;
          const CellRef ref{query->object, query->pair, answer.cell};
          cache.Build(session, {&ref, 1}, kSerial);
        }
        ASSERT_LE(cache.ByteSize(), options.memory_bytes);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(cache.ByteSize(), cache.CountBytes());
}

// Interpolants come and go in the same memory: nobody reads one that is another's by now.
TEST_F(RadianceCacheTest, ReadersSeeNothingOfWhatIsEvictedUnderThem) {
  CacheOptions options;
  options.memory_bytes = 60'000;
  RadianceCache cache(tracer_, options);
  test::Random random(60);
  std::vector<CellQuery> queries;
  while (queries.size() < 400) {
    if (const auto query = RandomQuery(cache, random)) queries.push_back(*query);
  }
  std::atomic<bool> stops{false};
  std::atomic<uint64_t> answers{0}, odd{0};
  std::vector<std::thread> readers;
  for (int t = 0; t < 2; ++t) {
    readers.emplace_back([&] {
      std::vector<CellAnswer> found(queries.size());
      while (!stops) {
        cache.Find(cache.Open({}), 0.5, queries, found);
        for (const CellAnswer& answer : found) {
          if (answer.kind != Lookup::Kind::kAnswer) continue;
          ++answers;
          for (int c = 0; c < 3; ++c) {
            if (!(answer.radiance[c] >= 0 && answer.radiance[c] < 10)) ++odd;
          }
        }
      }
    });
  }
  uint64_t evicted = 0;
  std::vector<CellAnswer> found(queries.size());
  for (int round = 0; round < 150 || answers < 1000; ++round) {
    const auto session = cache.Open({});
    const size_t first = queries.size() / 8 * static_cast<size_t>(round % 8);
    cache.Find(session, 0.5, queries, found);
    for (size_t i = first; i < first + queries.size() / 8; ++i) {
      if (found[i].kind != Lookup::Kind::kUnbuilt) continue;
      const CellRef ref{queries[i].object, queries[i].pair, found[i].cell};
      evicted += cache.Build(session, {&ref, 1}, kSerial).cells_evicted;
    }
  }
  stops = true;
  for (std::thread& reader : readers) reader.join();
  EXPECT_EQ(odd, 0u);
  EXPECT_GT(evicted, 100u);
  EXPECT_EQ(cache.ByteSize(), cache.CountBytes());
}

}  // namespace
}  // namespace linetree
