// Audits of many scenes: every answer that the cache helped to give is held against the classical
// tracer, and what breaks the promise is recorded (DESIGN, section 5: audit).
//
// Deterministic: a seed gives the same scenes and queries on any number of threads, and the same
// report but for its time.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/audit/audit_scene.h"
#include "core/audit/scene_families.h"

namespace linetree {

// A scene that is audited besides those of the families; it needs a camera.
struct AuditedFile {
  std::string name;
  std::shared_ptr<const Scene> scene;
};

struct AuditOptions {
  // About so many, for all scenes and epsilons together; a few more are asked.
  uint64_t queries = 1'000'000;
  uint64_t seed = 1;
  std::vector<SceneFamily> families;
  std::vector<AuditedFile> files;
  std::vector<double> epsilons = {0, 0.02, 0.1, 0.25};
  JudgeKind judge = JudgeKind::kCertified;
  size_t max_violations = 20;  // that are kept; all are counted
};

// One family or file at one epsilon.
struct AuditRow {
  std::string group;
  double epsilon = 0;
  uint64_t scenes = 0;
  AuditTally tally = {};
};

struct AuditReport {
  std::vector<AuditRow> rows;  // by group, then epsilon
  std::array<AuditTally, kQueryKinds> by_kind;
  AuditTally total;
  uint64_t scenes = 0;
  std::vector<Violation> violations;  // the first ones
  double wall_s = 0;
};

// INVALID_ARGUMENT for bad epsilons, and for nothing to audit. Scenes are audited side by side
// where there are as many as threads, so the answerer is called from several threads at once;
// `progress` is not.
absl::StatusOr<AuditReport> RunAudit(const AuditOptions& options, Answerer& answerer,
                                     WorkerPool& pool, const Progress& progress = nullptr);

}  // namespace linetree
