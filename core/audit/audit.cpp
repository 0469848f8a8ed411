#include "core/audit/audit.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <mutex>
#include <utility>

#include "core/audit/random_stream.h"

namespace linetree {
namespace {

// Enough for frames that build cells, few enough for many scenes.
constexpr uint64_t kQueriesPerScene = 120'000;

// Limits and cache of one scene: mostly the defaults, now and then what is near their ends. A cache
// that is too small for its scene evicts while it answers.
PathLimits LimitsOf(RandomStream& random) {
  constexpr std::array kLimits = {PathLimits{},         PathLimits{},       PathLimits{2, 0.01},
                                  PathLimits{6, 0.001}, PathLimits{1, 0},   PathLimits{5, 0},
                                  PathLimits{4, 0.3},   PathLimits{8, 0.01}};
  return kLimits[random.Index(kLimits.size())];
}

CacheOptions CacheOf(RandomStream& random) {
  CacheOptions cache;
  if (random.OneIn(5)) cache.memory_bytes = uint64_t{1} << (17 + random.Below(5));
  return cache;
}

// The scenes of an audit in the order in which they are audited; `groups` are families, then files.
class Plan {
 public:
  explicit Plan(const AuditOptions& options) : options_(options) {
    const uint64_t wanted = (options.queries + kQueriesPerScene - 1) / kQueriesPerScene;
    const uint64_t rounds = groups() == 0 ? 0 : (wanted + groups() - 1) / groups();
    scenes_ = groups() * std::max<uint64_t>(1, rounds);
  }

  size_t groups() const { return options_.families.size() + options_.files.size(); }
  uint64_t scenes() const { return scenes_; }
  size_t GroupOf(uint64_t scene) const { return scene % groups(); }

  std::string GroupName(size_t group) const {
    const size_t families = options_.families.size();
    return group < families ? std::string(NameOf(options_.families[group]))
                            : options_.files[group - families].name;
  }

  SceneAuditRequest RequestOf(uint64_t scene) const {
    const size_t group = GroupOf(scene);
    const size_t families = options_.families.size();
    // Of the scene and its queries, whatever else is audited: scene i of a family is the same with
    // and without the other families.
    const uint64_t seed = MixBits(options_.seed) + scene / groups();
    RandomStream random(MixBits(seed));
    SceneAuditRequest request;
    request.scene = group < families ? MakeFamilyScene(options_.families[group], seed)
                                     : options_.files[group - families].scene;
    request.name = group < families ? request.scene->name : GroupName(group);
    request.seed = random.Bits();
    request.queries = options_.queries / scenes_;
    request.epsilons = options_.epsilons;
    request.judge = options_.judge;
    request.limits = LimitsOf(random);
    request.cache = CacheOf(random);
    request.max_violations = options_.max_violations;
    return request;
  }

 private:
  const AuditOptions& options_;
  uint64_t scenes_;
};

AuditReport EmptyReport(const AuditOptions& options, const Plan& plan) {
  AuditReport report;
  for (size_t group = 0; group < plan.groups(); ++group) {
    for (const double epsilon : options.epsilons) {
      report.rows.push_back({.group = plan.GroupName(group), .epsilon = epsilon});
    }
  }
  return report;
}

void Add(const SceneAudit& audit, size_t group, size_t max_violations, AuditReport& report) {
  const size_t epsilons = audit.by_epsilon.size();
  for (size_t e = 0; e < epsilons; ++e) {
    AuditRow& row = report.rows[group * epsilons + e];
    ++row.scenes;
    row.tally += audit.by_epsilon[e];
    report.total += audit.by_epsilon[e];
  }
  for (size_t k = 0; k < kQueryKinds; ++k) report.by_kind[k] += audit.by_kind[k];
  ++report.scenes;
  for (const Violation& violation : audit.violations) {
    if (report.violations.size() < max_violations) report.violations.push_back(violation);
  }
}

// The audits of all scenes, in their order; those behind one that failed may be missing. The loops
// within a scene are short, and what is between them is not shared, so threads get a scene each
// where there are enough of them.
std::vector<absl::StatusOr<SceneAudit>> AuditScenes(const Plan& plan, Answerer& answerer,
                                                    WorkerPool& pool, const Progress& progress) {
  std::vector<absl::StatusOr<SceneAudit>> audits(plan.scenes());
  std::atomic<bool> failed = false;
  std::mutex mutex;
  uint64_t ended = 0;  // guarded by mutex
  const auto audit = [&](uint64_t scene, WorkerPool& within) {
    if (failed) return;
    audits[scene] = AuditScene(plan.RequestOf(scene), answerer, within);
    if (!audits[scene].ok()) failed = true;
    std::lock_guard lock(mutex);
    ++ended;
    if (progress) progress(static_cast<double>(ended) / static_cast<double>(plan.scenes()));
  };
  if (plan.scenes() < static_cast<uint64_t>(pool.threads())) {
    for (uint64_t scene = 0; scene < plan.scenes(); ++scene) audit(scene, pool);
  } else {
    pool.ParallelFor(plan.scenes(), [&](size_t scene) {
      WorkerPool alone(1);
      audit(scene, alone);
    });
  }
  return audits;
}

}  // namespace

absl::StatusOr<AuditReport> RunAudit(const AuditOptions& options, Answerer& answerer,
                                     WorkerPool& pool, const Progress& progress) {
  const Plan plan(options);
  if (plan.groups() == 0) {
    return absl::InvalidArgumentError("expected a family or a scene file to audit");
  }
  const auto began = std::chrono::steady_clock::now();
  const auto audits = AuditScenes(plan, answerer, pool, progress);
  AuditReport report = EmptyReport(options, plan);
  for (uint64_t scene = 0; scene < plan.scenes(); ++scene) {
    const auto& audit = audits[scene];
    if (!audit.ok()) return audit.status();
    Add(*audit, plan.GroupOf(scene), options.max_violations, report);
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
  report.wall_s = took.count();
  return report;
}

}  // namespace linetree
