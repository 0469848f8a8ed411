// The audit of one scene: its cache is warmed by frames, then asked, and every answer compared with
// the classical one.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/audit/tally.h"
#include "core/audit/violation.h"
#include "core/render/scene_host.h"

namespace linetree {

// What is audited. The default is SceneHost; tests put in ones that err.
class Answerer {
 public:
  virtual ~Answerer() = default;
  virtual absl::StatusOr<Frame> RenderFrame(SceneHost& host, const FrameRequest& request,
                                            WorkerPool& pool) {
    return host.RenderFrame(request, pool);
  }
  virtual absl::StatusOr<RayBatch> TraceRays(SceneHost& host, const std::vector<Ray>& rays,
                                             const RenderOptions& options, WorkerPool& pool) {
    return host.TraceRays(rays, options, pool);
  }
};

struct SceneAuditRequest {
  std::string name;  // in violations
  std::shared_ptr<const Scene> scene;
  uint64_t seed = 1;           // of the queries
  uint64_t queries = 100'000;  // about so many, for all epsilons together
  std::vector<double> epsilons;
  JudgeKind judge = JudgeKind::kCertified;
  PathLimits limits;
  CacheOptions cache;
  size_t max_violations = 20;  // that are kept; all are counted
};

struct SceneAudit {
  std::vector<AuditTally> by_epsilon;  // as request.epsilons
  std::array<AuditTally, kQueryKinds> by_kind;
  std::vector<Violation> violations;  // the first ones
};

// INVALID_ARGUMENT for a scene without cameras or a bad epsilon, and whatever the answerer returns.
absl::StatusOr<SceneAudit> AuditScene(const SceneAuditRequest& request, Answerer& answerer,
                                      WorkerPool& pool);

}  // namespace linetree
