// Many threads on one cache: nobody waits for those who build, every cell is built once, what is
// counted is what is there, and what readers see holds.
#include <gtest/gtest.h>

#include <atomic>
#include <barrier>
#include <latch>
#include <set>
#include <thread>
#include <vector>

#include "core/cache/path_cache.h"
#include "core/cache/radiance_cache.h"
#include "core/cache/surface_cache.h"
#include "tests/support/demo_scenes.h"
#include "tests/support/sanitizer_share.h"

namespace linetree {
namespace {

constexpr uint64_t kPlenty = 50'000'000;
constexpr int kDepth = 8;
const ParallelLoop kInTurn = [](size_t count, const std::function<void(size_t)>& body) {
  for (size_t i = 0; i < count; ++i) body(i);
};

class CacheThreads : public testing::TestWithParam<EpochKind> {
 protected:
  CacheThreads() : scene_(test::BallsOnFloor(6, 90)), tracer_(*scene_) {
    SetEpochKind(GetParam());
    test::Random random(7);
    while (rays_.size() < 600) {
      const Vec3d eye = random.InBox({-5, -9, 1}, {5, -7, 6});
      const Ray ray{eye, Normalized(random.InBox({-4, -3, 0}, {4, 4, 2}) - eye)};
      const Hit hit = tracer_.Intersect(ray.origin, ray.direction, {});
      if (!hit.IsHit()) continue;
      rays_.push_back(ray);
      hits_.push_back(hit);
    }
  }
  ~CacheThreads() override { SetEpochKind(EpochKind::kRcu); }

  // Asks for what is known of all hits; checks that it is whole.
  void Use(const SurfaceCache& cache) {
    const SurfaceCache::Reader reader(cache, 0.1);
    for (const Hit& hit : hits_) {
      const KnownLights known = reader.Find(hit);
      if (known.lists == nullptr) continue;
      for (size_t l = 0; l < scene_->lights.size(); ++l) {
        const LightList& list = known.lists[l];
        if (list.knowledge == LightKnowledge::kListed) {
          ASSERT_FALSE(list.candidates.empty());
          for (const int32_t object : list.candidates) {
            ASSERT_LT(static_cast<size_t>(object), scene_->objects.size());
          }
        }
        if (list.knowledge == LightKnowledge::kOff) {
          ASSERT_LT(static_cast<size_t>(list.occluder), scene_->objects.size());
        }
      }
    }
  }
  // Asks for the paper's cells of all hits, and builds those that are missing; false when none is.
  // Who has `together` publishes when the others do.
  bool Build(RadianceCache& cache, std::barrier<>* together = nullptr) {
    const auto session = cache.Open({});
    std::set<CellRef> missing;
    for (size_t i = 0; i < rays_.size(); ++i) {
      const auto query = cache.QueryFor(hits_[i], rays_[i]);
      if (!query) continue;
      CellAnswer answer;
      cache.Find(session, 0.1, {&*query, 1}, {&answer, 1});
      if (answer.kind == Lookup::Kind::kAnswer) {
        EXPECT_GE(MaxChannel(answer.radiance), 0);
      }
      if (answer.kind != Lookup::Kind::kUnbuilt) continue;
      missing.insert({query->object, query->pair, answer.cell});
    }
    const std::vector<CellRef> cells(missing.begin(), missing.end());
    int loops = 0;  // three that trace, one that judges
    cache.Build(session, cells, [&](size_t count, const std::function<void(size_t)>& body) {
      kInTurn(count, body);
      if (++loops == 4 && together != nullptr) together->arrive_and_wait();
    });
    EXPECT_EQ(loops, 4);
    return !cells.empty();
  }
  std::vector<PathCache::Sample> Use(const PathCache& cache) {
    std::vector<PathCache::Sample> samples;
    const PathCache::Reader reader(cache, {}, &samples);
    for (size_t i = 0; i < rays_.size(); ++i) {
      const PathStep* step = reader.Find(hits_[i], rays_[i].direction);
      if (step == nullptr) continue;
      EXPECT_TRUE(step->EndsAt(hits_[i]));
      for (const int32_t object : step->candidates) {
        EXPECT_LT(static_cast<size_t>(object), scene_->objects.size());
      }
    }
    return samples;
  }

  std::shared_ptr<const Scene> scene_;
  Tracer tracer_;
  std::vector<Ray> rays_;
  std::vector<Hit> hits_;
};

// Runs `body` in the middle of the first loop that has anything to do, while the cells that it
// certifies belong to who runs it.
class Interrupted {
 public:
  explicit Interrupted(std::function<void()> body) : body_(std::move(body)) {}
  ParallelLoop loop() {
    return [this](size_t count, const std::function<void(size_t)>& body) {
      for (size_t i = 0; i < count; ++i) {
        body(i);
        if (std::exchange(is_done_, true)) continue;
        std::thread(body_).join();
      }
    };
  }
  bool is_done() const { return is_done_; }

 private:
  const std::function<void()> body_;
  bool is_done_ = false;
};

TEST_P(CacheThreads, ReadersAndOtherBuildersDoNotWaitForABuilder) {
  SurfaceCache surfaces(tracer_, kPlenty);
  PathCache paths(tracer_, kPlenty, kDepth);
  for (int round = 0; round < 2; ++round) {
    Use(surfaces);
    surfaces.Refine(round, kInTurn);
    paths.Refine({}, Use(paths), round, kInTurn);
  }
  Use(surfaces);
  // Would hang where somebody waited.
  Interrupted on_surfaces([&] {
    Use(surfaces);
    surfaces.Refine(100, kInTurn);
    surfaces.EndFrame({});
  });
  surfaces.Refine(100, on_surfaces.loop());
  EXPECT_TRUE(on_surfaces.is_done());
  EXPECT_EQ(surfaces.ByteSize(), surfaces.CountBytes());
  Interrupted on_paths([&] {
    paths.Refine({}, Use(paths), 100, kInTurn);
    paths.EndFrame({});
  });
  paths.Refine({}, Use(paths), 100, on_paths.loop());
  EXPECT_TRUE(on_paths.is_done());
  EXPECT_EQ(paths.ByteSize(), paths.CountBytes());
}

TEST_P(CacheThreads, WhoBuildsACellIsLeftAlone) {
  SurfaceCache cache(tracer_, kPlenty);
  Use(cache);
  cache.Refine(100, kInTurn);
  Use(cache);
  // Wants the cells that are just being certified, and all others gone.
  uint64_t by_other = 0;
  Interrupted other([&] {
    Use(cache);
    by_other = cache.Refine(100, kInTurn);
  });
  const uint64_t own = cache.Refine(100, other.loop());
  EXPECT_GT(own, 0u);
  EXPECT_EQ(own + by_other, cache.CellCount());
}

TEST_P(CacheThreads, ManyAtOnce) {
  for (const uint64_t budget : {kPlenty, uint64_t{60'000}}) {
    SurfaceCache surfaces(tracer_, budget);
    PathCache paths(tracer_, budget, kDepth);
    std::atomic<uint64_t> built_surfaces{0}, built_paths{0};
    std::atomic<bool> stops{false};
    std::vector<std::thread> threads;
    for (int t = 0; t < 3; ++t) {
      threads.emplace_back([&, t] {
        for (int round = 0; round < (built_surfaces > 100 ? 12 : 500); ++round) {
          Use(surfaces);
          built_surfaces += surfaces.Refine(20 + t, kInTurn);
          built_paths += paths.Refine({}, Use(paths), 20 + t, kInTurn);
          surfaces.EndFrame({});
          paths.EndFrame({});
          EXPECT_LE(surfaces.ByteSize(), budget);
          EXPECT_LE(paths.ByteSize(), budget);
        }
      });
    }
    std::thread reader([&] {
      while (!stops) {
        Use(surfaces);
        Use(paths);
        surfaces.TreeSizes();
        paths.CellVerdicts();
      }
    });
    for (std::thread& thread : threads) thread.join();
    stops = true;
    reader.join();
    EXPECT_EQ(surfaces.ByteSize(), surfaces.CountBytes());
    EXPECT_EQ(paths.ByteSize(), paths.CountBytes());
    EXPECT_EQ(built_surfaces, surfaces.CellCount() + surfaces.evicted().cells);
    EXPECT_EQ(built_paths, paths.CellCount() + paths.evicted().cells);
    EXPECT_GT(built_surfaces, 100u);
    EXPECT_EQ(budget == kPlenty, surfaces.evicted().cells == 0);
  }
}

// Whoever comes first publishes a cell, and what is there at the end does not depend on who it was.
TEST_P(CacheThreads, ManyPublishThePapersCells) {
  RadianceCache alone(tracer_, {.max_cell_depth = 4});
  while (Build(alone)) {
  }
  ASSERT_GT(alone.CellCount(), 500u);
  for (int time = 0; time < 12 / test::kSanitizerShare; ++time) {
    RadianceCache cache(tracer_, {.max_cell_depth = 4});
    std::barrier together(3);
    std::vector<std::thread> threads;
    for (int t = 0; t < 3; ++t) {
      threads.emplace_back([&] {
        while (Build(cache, &together)) {
        }
        together.arrive_and_drop();
      });
    }
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(cache.CellCount(), alone.CellCount());
    EXPECT_EQ(cache.CellVerdicts(), alone.CellVerdicts());
    EXPECT_EQ(cache.ByteSize(), cache.CountBytes());
  }
}

TEST_P(CacheThreads, ThePapersCellsKeepToTheBudgetWhoeverPublishesThem) {
  const uint64_t budget = 150'000;
  RadianceCache cache(tracer_, {.memory_bytes = budget, .max_cell_depth = 4});
  std::atomic<int> rounds{0};
  std::barrier together(3);
  std::vector<std::thread> threads;
  for (int t = 0; t < 3; ++t) {
    threads.emplace_back([&, t] {
      for (int round = 0; round < 12; ++round, ++rounds) {
        Build(cache, &together);
        if (t == 0 && round % 4 == 3) cache.SetMemoryBytes(round == 7 ? budget : budget / 2);
        if (t == 1 && round == 5) cache.Clear();
      }
    });
  }
  while (rounds < 36) EXPECT_LE(cache.ByteSize(), budget);
  for (std::thread& thread : threads) thread.join();
  EXPECT_GT(cache.CellCount(), 0u);
  EXPECT_EQ(cache.ByteSize(), cache.CountBytes());
}

// Budgets, policies and whole caches change under readers and builders.
TEST_P(CacheThreads, WhoChangesAllWaitsForBuildersAndNotTheOtherWayRound) {
  SurfaceCache surfaces(tracer_, kPlenty);
  PathCache paths(tracer_, kPlenty, kDepth);
  std::atomic<bool> stops{false};
  std::atomic<int> refined{0};
  std::vector<std::thread> threads;
  for (int t = 0; t < 2; ++t) {
    threads.emplace_back([&] {
      for (; !stops; ++refined) {
        Use(surfaces);
        surfaces.Refine(50, kInTurn);
        paths.Refine({}, Use(paths), 50, kInTurn);
      }
    });
  }
  for (int round = 0; round < 10 || refined < 40; ++round) {
    for (const uint64_t budget : {uint64_t{40'000}, kPlenty}) {
      surfaces.SetMemoryBytes(budget);
      paths.SetMemoryBytes(budget);
      EXPECT_LE(surfaces.ByteSize(), budget);
      EXPECT_LE(paths.ByteSize(), budget);
    }
    surfaces.SetPolicy(round % 2 == 0 ? "lru" : "reuse");
    paths.SetPolicy(round % 2 == 0 ? "lru" : "reuse");
    if (round % 4 == 3) {
      surfaces.Clear();
      paths.Clear();
    }
  }
  stops = true;
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(surfaces.ByteSize(), surfaces.CountBytes());
  EXPECT_EQ(paths.ByteSize(), paths.CountBytes());
}

INSTANTIATE_TEST_SUITE_P(Kinds, CacheThreads,
                         testing::Values(EpochKind::kRcu, EpochKind::kSharedLock),
                         [](const auto& of) {
                           return of.param == EpochKind::kRcu ? "Rcu" : "SharedLock";
                         });

}  // namespace
}  // namespace linetree
