#include "core/cache/surface_cache.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "tests/support/demo_scenes.h"

namespace linetree {
namespace {

const ParallelLoop kSerial = [](size_t count, const std::function<void(size_t)>& body) {
  for (size_t i = 0; i < count; ++i) body(i);
};

class SurfaceCacheTest : public testing::Test {
 protected:
  SurfaceCacheTest() : scene_(test::BallsOnFloor(6, 90)), tracer_(*scene_) {}

  // Looks up the hits of random eye rays.
  int Use(const SurfaceCache& cache, uint64_t seed, int rays, uint32_t points = 1) {
    test::Random random(seed);
    const SurfaceCache::Reader lists(cache, 0, points);
    int known = 0;
    for (int i = 0; i < rays; ++i) {
      const Vec3d eye = random.InBox({-5, -9, 1}, {5, -7, 6});
      const Vec3d at = random.InBox({-4, -3, 0}, {4, 4, 2});
      const Hit hit = tracer_.Intersect(eye, at - eye, {});
      if (hit.IsHit() && lists.Find(hit).lists != nullptr) ++known;
    }
    return known;
  }

  // Whether shadow functions answer for lights that planar cells leave undecided (LightCertifier);
  // without them rays are tested against candidates everywhere.
  static constexpr bool kFunctions = true, kTests = false;

  // Cells of a cache of which 500 rays are asked four times, where each use stands for so many.
  uint64_t CellsAt(double weight, bool uses_functions) {
    SurfaceCache cache(tracer_, 10'000'000, kMinSurfaceUses, uses_functions);
    for (int round = 0; round < 4; ++round) {
      Use(cache, 2, 500);
      cache.Refine(weight, kSerial);
    }
    return cache.CellCount();
  }

  std::shared_ptr<const Scene> scene_;
  Tracer tracer_;
};

TEST_F(SurfaceCacheTest, KnowsNothingUntilItIsRefined) {
  SurfaceCache cache(tracer_, 10'000'000);
  EXPECT_EQ(Use(cache, 1, 100), 0);
  EXPECT_EQ(cache.Refine(1, kSerial), 0u) << "plants trees where hits asked for them";
  EXPECT_EQ(Use(cache, 1, 100), 0);
  EXPECT_GT(cache.Refine(1, kSerial), 0u);
  EXPECT_GT(Use(cache, 1, 100), 60);
}

TEST_F(SurfaceCacheTest, UndecidedCellsAreDividedWhereTheyAreUsedMuch) {
  EXPECT_GT(CellsAt(100, kTests), 10 * CellsAt(0.01, kTests));
  EXPECT_GT(CellsAt(1000, kFunctions), 10 * CellsAt(0.01, kFunctions));
}

// What shadow functions answer costs little: it takes several times as many points, no more.
TEST_F(SurfaceCacheTest, WhatFunctionsAnswerIsDividedLater) {
  EXPECT_EQ(CellsAt(0.01, kFunctions), CellsAt(0.01, kTests));
  EXPECT_LT(3 * CellsAt(100, kFunctions), 2 * CellsAt(100, kTests));
  EXPECT_GT(CellsAt(600, kFunctions), CellsAt(100, kTests));
}

// A reader whose uses stand for many points leaves those of others, which stand for themselves, as
// they are.
TEST_F(SurfaceCacheTest, EachUseCountsAsManyPointsAsItsReaderSays) {
  // Without functions one threshold is that of all cells.
  SurfaceCache plain(tracer_, 10'000'000, kMinSurfaceUses, kTests);
  SurfaceCache weighted(tracer_, 10'000'000, kMinSurfaceUses, kTests);
  SurfaceCache mixed(tracer_, 10'000'000, kMinSurfaceUses, kTests);
  for (int round = 0; round < 4; ++round) {
    Use(plain, 2, 500);
    plain.Refine(100, kSerial);
    Use(weighted, 2, 500, 100);
    weighted.Refine(1, kSerial);
    Use(mixed, 2, 500);
    Use(mixed, 2, 5, 100);
    mixed.Refine(1, kSerial);
  }
  EXPECT_EQ(weighted.CellCount(), plain.CellCount());
  EXPECT_LT(10 * mixed.CellCount(), plain.CellCount());
}

TEST_F(SurfaceCacheTest, BytesAreExactAndWithinTheBudget) {
  for (const uint64_t budget : {uint64_t{0}, uint64_t{20'000}, uint64_t{200'000}}) {
    SurfaceCache cache(tracer_, budget);
    for (uint64_t round = 0; round < 20; ++round) {
      Use(cache, round, 300);
      cache.Refine(50, kSerial);
      ASSERT_LE(cache.ByteSize(), budget);
      ASSERT_EQ(cache.ByteSize(), cache.CountBytes());
      TreeSize all;
      for (const TreeSize& size : cache.TreeSizes()) {
        all.cells += size.cells;
        all.bytes += size.bytes;
      }
      ASSERT_EQ(all.cells, cache.CellCount());
      // And the table of trees.
      const uint64_t table = scene_->objects.size() * (sizeof(void*) + sizeof(bool));
      ASSERT_EQ(all.bytes + (cache.ByteSize() > 0 ? table : 0), cache.ByteSize());
    }
  }
}

TEST_F(SurfaceCacheTest, WhatIsHeldForEveryObjectCounts) {
  const uint64_t least = scene_->objects.size() * (sizeof(void*) + sizeof(bool));
  SurfaceCache cache(tracer_, least);
  EXPECT_EQ(cache.ByteSize(), least);
  EXPECT_EQ(cache.CountBytes(), least);
  cache.SetMemoryBytes(least - 1);
  EXPECT_EQ(cache.ByteSize(), 0u);
  SurfaceCache without(tracer_, least - 1);
  EXPECT_EQ(without.ByteSize(), 0u);
  Use(without, 1, 100);
  without.Refine(1, kSerial);
  EXPECT_EQ(without.ByteSize(), 0u) << "no room for what a tree takes beside itself";
  // With room again it grows as a new one does.
  without.SetMemoryBytes(10'000'000);
  for (int round = 0; round < 3; ++round) {
    Use(without, 1, 100);
    without.Refine(1, kSerial);
  }
  EXPECT_GT(without.CellCount(), 0u);
  EXPECT_EQ(without.ByteSize(), without.CountBytes());
}

TEST_F(SurfaceCacheTest, ASmallerBudgetEvictsAndALargerOneGrowsAgain) {
  SurfaceCache cache(tracer_, 4'000'000);
  const auto work = [&] {
    for (uint64_t round = 0; round < 5; ++round) {
      Use(cache, round, 1000);
      cache.Refine(100, kSerial);
    }
  };
  work();
  const uint64_t large = cache.ByteSize();
  cache.SetMemoryBytes(large / 2);
  EXPECT_LE(cache.ByteSize(), large / 2);
  EXPECT_EQ(cache.ByteSize(), cache.CountBytes());
  cache.SetMemoryBytes(4'000'000);
  work();
  EXPECT_GT(cache.ByteSize(), large / 2);
  cache.Clear();
  EXPECT_EQ(cache.ByteSize(), 0u);
  EXPECT_EQ(cache.CellCount(), 0u);
}

TEST_F(SurfaceCacheTest, ATinyBudgetDropsWholeTrees) {
  SurfaceCache cache(tracer_, 4'000'000);
  for (uint64_t round = 0; round < 3; ++round) {
    Use(cache, round, 500);
    cache.Refine(100, kSerial);
  }
  ASSERT_GT(cache.CellCount(), 0u);
  cache.SetMemoryBytes(500);
  EXPECT_EQ(cache.CellCount(), 0u);
  EXPECT_LE(cache.ByteSize(), 500u);
  EXPECT_EQ(cache.ByteSize(), cache.CountBytes());
  EXPECT_EQ(Use(cache, 1, 100), 0);
}

TEST_F(SurfaceCacheTest, ACancelledRefinementKeepsWhatItBuilt) {
  SurfaceCache cache(tracer_, 10'000'000);
  Use(cache, 1, 500);
  cache.Refine(100, kSerial);
  Use(cache, 1, 500);
  int left = 2;
  const ParallelLoop cut_short = [&](size_t count, const std::function<void(size_t)>& body) {
    for (size_t i = 0; i < count && left > 0; ++i, --left) body(i);
  };
  EXPECT_EQ(cache.Refine(100, cut_short), 2u);
  EXPECT_EQ(cache.CellCount(), 2u);
  EXPECT_EQ(cache.ByteSize(), cache.CountBytes());
  Use(cache, 1, 500);
  EXPECT_GT(cache.Refine(100, kSerial), 2u);
}

// Spheres cost more than planes.
double PriceOf(size_t object, const CellLights*) { return object < 2 ? 7 : 30; }

TEST_F(SurfaceCacheTest, WorkStaysWithinItsBudget) {
  const SurfaceCache::Thrift::Price price = PriceOf;
  double largest = 0;
  for (const double budget : {0.0, 6.9, 7.0, 50.0, 400.0, 3000.0}) {
    for (const double weight : {0.01, 100.0}) {
      SurfaceCache cache(tracer_, 10'000'000);
      for (uint64_t round = 0; round < 6; ++round) {
        Use(cache, round, 500);
        const std::vector<TreeSize> before = cache.TreeSizes();
        SurfaceCache::Thrift thrift;
        thrift.price = &price;
        thrift.most_work = budget;
        const SurfaceCache::Grown grown = cache.Refine(weight, kSerial, thrift);
        const std::vector<TreeSize> after = cache.TreeSizes();
        double work = 0;
        uint64_t cells = 0;
        for (size_t object = 0; object < after.size(); ++object) {
          const uint64_t old = object < before.size() ? before[object].cells : 0;
          work += static_cast<double>(after[object].cells - old) * PriceOf(object, nullptr);
          cells += after[object].cells - old;
        }
        ASSERT_LE(work, budget) << "round " << round << ", weight " << weight;
        ASSERT_EQ(cells, grown.cells);
        ASSERT_NEAR(work, grown.work, 1e-6);
        largest = std::max(largest, budget > 0 ? work / budget : 0);
      }
    }
  }
  EXPECT_GT(largest, 0.9) << "divisions spend what there is";
}

// A cell is dear where nothing is known of the one around it, and cheap below.
TEST_F(SurfaceCacheTest, PricesGoByWhatIsKnownAlready) {
  const SurfaceCache::Thrift::Price price = [](size_t, const CellLights* parent) {
    return parent == nullptr ? 100.0 : 1.0 + static_cast<double>(parent->objects.size());
  };
  SurfaceCache cache(tracer_, 10'000'000);
  Use(cache, 1, 500);
  cache.Refine(1, kSerial);
  Use(cache, 1, 500);
  SurfaceCache::Thrift thrift;
  thrift.price = &price;
  thrift.most_work = 100;
  const SurfaceCache::Grown root = cache.Refine(100, kSerial, thrift);
  EXPECT_EQ(root.cells, 1u);
  EXPECT_DOUBLE_EQ(root.work, 100);
  Use(cache, 1, 500);
  const SurfaceCache::Grown parts = cache.Refine(100, kSerial, thrift);
  EXPECT_GT(parts.cells, 1u) << "a root costs 100, parts of the floor do not";
  EXPECT_LE(parts.work, 100);
}

TEST_F(SurfaceCacheTest, TheBudgetGoesToTheCellsThatMostPointsAskFor) {
  const SurfaceCache::Thrift::Price price = [](size_t, const CellLights*) { return 1.0; };
  SurfaceCache cache(tracer_, 10'000'000);
  Use(cache, 1, 500);
  cache.Refine(1, kSerial);
  // By far the most hits are on the floor, which is one cell.
  Use(cache, 1, 500);
  SurfaceCache::Thrift thrift;
  thrift.price = &price;
  thrift.most_work = 1;
  EXPECT_EQ(cache.Refine(100, kSerial, thrift).cells, 1u);
  EXPECT_EQ(cache.TreeSizes()[0].cells, 1u);
}

TEST_F(SurfaceCacheTest, WithoutAPriceOrALimitThereIsNoBudget) {
  const SurfaceCache::Thrift::Price price = PriceOf;
  SurfaceCache::Thrift free, unlimited;
  free.most_work = 0;
  unlimited.price = &price;
  SurfaceCache plain(tracer_, 10'000'000),
      caches[2] = {{tracer_, 10'000'000}, {tracer_, 10'000'000}};
  for (uint64_t round = 0; round < 4; ++round) {
    Use(plain, round, 500);
    const uint64_t certified = plain.Refine(100, kSerial);
    EXPECT_EQ(certified > 0, round > 0);
    for (SurfaceCache& cache : caches) {
      Use(cache, round, 500);
      EXPECT_EQ(cache.Refine(100, kSerial, &cache == &caches[0] ? free : unlimited).cells,
                certified);
    }
  }
  EXPECT_GT(plain.CellCount(), 100u) << "divisions among them";
}

std::vector<std::string> PoliciesAndNone() {
  std::vector<std::string> names = {""};
  for (const PolicyNote& note : AllPolicies()) names.emplace_back(note.name);
  return names;
}

TEST_F(SurfaceCacheTest, EveryPolicyKeepsTheBudgetAndCountsWhatGoes) {
  for (const std::string& policy : PoliciesAndNone()) {
    constexpr uint64_t kBudget = 150'000;
    SurfaceCache cache(tracer_, kBudget);
    cache.SetPolicy(policy);
    uint64_t certified = 0;
    for (uint64_t round = 0; round < 24; ++round) {
      Use(cache, round % 7, 300);
      certified += cache.Refine(50, kSerial);
      ASSERT_LE(cache.ByteSize(), kBudget) << policy;
      ASSERT_LE(cache.ByteSize() + cache.LedgerBytes(), kBudget) << policy;
      if (round % 3 != 2) cache.EndFrame({});
      if (round == 15) cache.SetPolicy("lru");
      if (round == 18) cache.SetMemoryBytes(kBudget / 2);
      if (round == 21) cache.SetMemoryBytes(kBudget);
      ASSERT_EQ(cache.ByteSize(), cache.CountBytes()) << policy;
      ASSERT_EQ(cache.CellCount() + cache.evicted().cells, certified) << policy;
    }
    EXPECT_GT(cache.evicted().cells, 50u) << policy;
    EXPECT_GT(cache.evicted().bytes, 50 * cache.evicted().cells) << policy;
    cache.Clear();
    EXPECT_EQ(cache.ByteSize(), cache.CountBytes());
  }
}

// What has to go first is what only former frames have used.
TEST_F(SurfaceCacheTest, WhatTheLastFrameUsedStays) {
  constexpr int kLast = 30;
  for (const std::string& policy : PoliciesAndNone()) {
    SurfaceCache cache(tracer_, 10'000'000);
    cache.SetPolicy(policy);
    for (uint64_t round = 0; round < 20; ++round) {
      Use(cache, 2 + round % 5, 200);
      cache.Refine(60, kSerial);
    }
    cache.EndFrame({});
    const int known = Use(cache, 1, kLast);
    cache.EndFrame({});
    const uint64_t all = cache.ByteSize();
    for (uint64_t budget = 2 * all; cache.ByteSize() == all; budget -= all / 32) {
      cache.SetMemoryBytes(budget);
    }
    EXPECT_GT(known, kLast / 2);
    EXPECT_EQ(Use(cache, 1, kLast), known) << policy;
  }
}

TEST_F(SurfaceCacheTest, RecordsWhatFramesUse) {
  SurfaceCache cache(tracer_, 10'000'000);
  TraceRecorder recorder;
  const auto end_frame = [&] { cache.EndFrame({&recorder, recorder.BeginFrame(), 0}); };
  for (uint64_t round = 0; round < 4; ++round) {
    Use(cache, 1, 500);
    cache.Refine(100, kSerial);
    end_frame();
  }
  const uint64_t busy = recorder.event_count();
  EXPECT_GT(busy, 100u);
  end_frame();
  EXPECT_EQ(recorder.event_count(), busy) << "a frame that asks for nothing";
  Use(cache, 1, 500);
  end_frame();
  const Trace trace = recorder.Take();
  std::set<std::pair<uint32_t, uint64_t>> uses;
  for (const TraceEvent& event : trace) {
    EXPECT_TRUE(uses.emplace(event.time, event.id).second) << "once a frame";
    EXPECT_GT(event.bytes, 0u);
  }
  const WorkingSet set = WorkingSetOf(trace);
  EXPECT_EQ(set.frames, 5u) << "but for the idle one";
  EXPECT_LE(set.bytes, cache.ByteSize());
  EXPECT_GT(set.bytes, cache.ByteSize() / 2);
  EXPECT_GT(set.rebuild_ns, 100 * static_cast<double>(cache.CellCount()));
}

TEST_F(SurfaceCacheTest, NothingIsCertifiedThatFindsNoRoom) {
  // Who certifies without looking for room does so again and again.
  const auto work_in = [&](uint64_t memory_bytes, uint64_t& kept, uint64_t& unkept) {
    SurfaceCache cache(tracer_, memory_bytes);
    uint64_t tried = 0;
    const ParallelLoop counted = [&](size_t count, const std::function<void(size_t)>& body) {
      tried += count;
      kSerial(count, body);
    };
    for (uint64_t round = 0; round < 6; ++round) {
      Use(cache, 3, 2000);
      const SurfaceCache::Grown grown = cache.Refine(100, counted, {});
      kept += grown.cells;
      unkept += grown.unkept;
      cache.EndFrame({});
    }
    return tried;
  };
  uint64_t all_kept = 0, all_unkept = 0, kept = 0, unkept = 0;
  const uint64_t all_tried = work_in(100'000'000, all_kept, all_unkept);
  EXPECT_EQ(all_unkept, 0u);
  const uint64_t tried = work_in(30'000, kept, unkept);
  EXPECT_GT(kept, 0u);
  EXPECT_LT(kept, all_kept / 2);
  EXPECT_LT(tried, all_tried / 2);
  EXPECT_LT(tried, 2 * kept) << "those that are to be divided are looked at, too";
  EXPECT_GT(unkept, 0u);
}

}  // namespace
}  // namespace linetree
