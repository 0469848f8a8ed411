// The audit that every build runs: short, deterministic, of all families.
#include "core/audit/audit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <set>

#include "core/audit/random_stream.h"

namespace linetree {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr uint64_t kQueries = 20'000;
#else
constexpr uint64_t kQueries = 200'000;
#endif

AuditOptions AllFamilies(uint64_t queries) {
  AuditOptions options;
  options.queries = queries;
  for (int family = 0; family < kSceneFamilies; ++family) {
    options.families.push_back(static_cast<SceneFamily>(family));
  }
  return options;
}

AuditReport Audited(const AuditOptions& options, int threads) {
  WorkerPool pool(threads);
  Answerer answerer;
  auto report = RunAudit(options, answerer, pool);
  EXPECT_TRUE(report.ok()) << report.status();
  return *std::move(report);
}

TEST(AuditTest, CertifiedAnswersKeepThePromise) {
  const AuditReport report = Audited(AllFamilies(kQueries), 2);
  for (const Violation& violation : report.violations) ADD_FAILURE() << ToLine(violation);
  EXPECT_EQ(report.total.violations, 0u);
  EXPECT_GE(report.total.queries, kQueries * 9 / 10);
  EXPECT_GT(report.total.hits, report.total.queries / 3);
  // An audit of answers that the cache had no part in proves nothing.
  EXPECT_GT(report.total.listed_shadow_rays, report.total.shadow_rays / 2);
  EXPECT_EQ(report.rows.size(), kSceneFamilies * 4u);
  AuditTally sum;
  for (const AuditRow& row : report.rows) {
    EXPECT_EQ(row.scenes, report.scenes / kSceneFamilies);
    EXPECT_GT(row.tally.queries, 0u);
    EXPECT_TRUE(row.epsilon > 0 || row.tally.equal == row.tally.queries) << row.group;
    sum += row.tally;
  }
  EXPECT_EQ(sum, report.total);
}

TEST(AuditTest, ReportsDoNotDependOnThreads) {
  const AuditOptions options = AllFamilies(14'000);
  const AuditReport one = Audited(options, 1);
  const AuditReport three = Audited(options, 3);
  ASSERT_EQ(one.rows.size(), three.rows.size());
  for (size_t i = 0; i < one.rows.size(); ++i) {
    EXPECT_EQ(one.rows[i].tally, three.rows[i].tally) << one.rows[i].group;
  }
}

TEST(AuditTest, FamiliesAloneAreThoseOfTheFullAudit) {
  AuditOptions all = AllFamilies(14'000);
  AuditOptions one = all;
  one.families = {SceneFamily::kGlass};
  one.queries = all.queries / kSceneFamilies;
  const AuditReport report = Audited(all, 2);
  const AuditReport alone = Audited(one, 2);
  const size_t first = static_cast<size_t>(SceneFamily::kGlass) * all.epsilons.size();
  for (size_t e = 0; e < all.epsilons.size(); ++e) {
    EXPECT_EQ(alone.rows[e].tally, report.rows[first + e].tally);
  }
}

TEST(AuditTest, FilesAreAuditedToo) {
  AuditOptions options;
  options.queries = 4000;
  options.files.push_back({"room.textproto", MakeFamilyScene(SceneFamily::kWalls, 2)});
  const AuditReport report = Audited(options, 2);
  EXPECT_EQ(report.rows[0].group, "room.textproto");
  EXPECT_GT(report.total.queries, 3000u);
}

// Spoils answers along rays that depend on nothing but the ray.
class Spoiler : public Answerer {
 public:
  absl::StatusOr<RayBatch> TraceRays(SceneHost& host, const std::vector<Ray>& rays,
                                     const RenderOptions& options, WorkerPool& pool) override {
    auto batch = host.TraceRays(rays, options, pool);
    for (size_t i = 0; i < rays.size(); ++i) {
      const auto bits = std::bit_cast<uint64_t>(rays[i].direction.x);
      if (MixBits(bits) % 499 == 0) batch->answers[i].radiance.g += 10;
    }
    return batch;
  }
};

TEST(AuditTest, ViolationsComeInTheOrderOfTheirScenes) {
  const auto lines = [](int threads) {
    WorkerPool pool(threads);
    Spoiler spoiler;
    const auto report = RunAudit(AllFamilies(14'000), spoiler, pool);
    std::vector<std::string> text;
    for (const Violation& violation : report->violations) text.push_back(ToLine(violation));
    return text;
  };
  const auto one = lines(1);
  EXPECT_EQ(one.size(), AuditOptions{}.max_violations);
  EXPECT_EQ(one, lines(3));
}

// Lets no scene go on before a second one has begun.
class Rendezvous : public Answerer {
 public:
  absl::StatusOr<Frame> RenderFrame(SceneHost& host, const FrameRequest& request,
                                    WorkerPool& pool) override {
    std::unique_lock lock(mutex_);
    scenes_.insert(&host);
    changed_.notify_all();
    const bool met =
        changed_.wait_for(lock, std::chrono::minutes(1), [this] { return scenes_.size() > 1; });
    if (!met) return absl::DeadlineExceededError("no second scene");
    lock.unlock();
    return host.RenderFrame(request, pool);
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::set<const SceneHost*> scenes_;  // guarded by mutex_
};

TEST(AuditTest, ThreadsAuditScenesSideBySide) {
  WorkerPool pool(2);
  Rendezvous rendezvous;
  std::vector<double> shares;
  const auto report = RunAudit(AllFamilies(14'000), rendezvous, pool,
                               [&](double share) { shares.push_back(share); });
  ASSERT_TRUE(report.ok()) << report.status();
  ASSERT_EQ(shares.size(), report->scenes);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_EQ(shares.back(), 1);
}

class Failing : public Answerer {
 public:
  absl::StatusOr<Frame> RenderFrame(SceneHost&, const FrameRequest&, WorkerPool&) override {
    return absl::InternalError("as planned");
  }
};

TEST(AuditTest, WhatTheAnswererReturnsEndsTheAudit) {
  for (const int threads : {1, 3}) {
    WorkerPool pool(threads);
    Failing failing;
    EXPECT_EQ(RunAudit(AllFamilies(14'000), failing, pool).status(),
              absl::InternalError("as planned"));
  }
}

TEST(AuditTest, NothingToAuditIsAnError) {
  WorkerPool pool(1);
  Answerer answerer;
  EXPECT_TRUE(absl::IsInvalidArgument(RunAudit({}, answerer, pool).status()));
}

}  // namespace
}  // namespace linetree
