// The audit of a running server: a sampled share of its answers is traced again, in double, on one
// background thread of the lowest priority (DESIGN, section 5: audit).
//
// A request is never held up. Offering its answers copies the sampled ones into a queue without
// locks; what finds the queue full is dropped and counted. The thread holds no lock that a request
// may want while it traces or counts.
//
// Thread safety: all methods may be called from any thread.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "core/audit/bounded_queue.h"
#include "core/audit/violation.h"
#include "core/render/scene_host.h"

namespace linetree {

// Counts of one scene. Whoever shows them may read while the audit counts.
class AuditCounts {
 public:
  struct Values {
    uint64_t checked = 0;
    uint64_t violations = 0;  // of the checked
    uint64_t dropped = 0;     // sampled, but there was no room in the queue
    double max_error_over_allowed = 0;
    bool operator==(const Values&) const = default;
  };
  Values values() const;

 private:
  friend class LiveAudit;

  std::atomic<uint64_t> checked_{0};
  std::atomic<uint64_t> violations_{0};
  std::atomic<uint64_t> dropped_{0};
  std::atomic<double> max_error_over_allowed_{0};  // written by the audit's thread only
};

// A scene as a server holds it. Entries keep it alive while they wait, whatever becomes of its
// name.
struct LiveScene {
  std::string name;
  std::shared_ptr<const SceneHost> host;
  std::shared_ptr<AuditCounts> counts;
};

struct LiveAuditOptions {
  double share = 0;  // of the answers, in [0, 1]
  size_t max_waiting = 4096;
};

class LiveAudit {
 public:
  // Called on the audit's thread, for every violation.
  using OnViolation = std::function<void(const Violation&)>;

  // A share of 0 starts no thread.
  LiveAudit(const LiveAuditOptions& options, OnViolation on_violation);
  // Drops what waits; returns as soon as the ray that is being traced is done.
  ~LiveAudit();
  LiveAudit(const LiveAudit&) = delete;
  LiveAudit& operator=(const LiveAudit&) = delete;

  // What was answered. Classical answers are not sampled. `rays` are as they were asked.
  void Offer(const LiveScene& scene, const std::vector<Ray>& rays, const RenderOptions& options,
             const RayBatch& batch);
  void Offer(const LiveScene& scene, const RenderOptions& options, const Frame& frame);

  // Returns when everything that was offered before has been checked or dropped.
  void WaitUntilChecked();

 private:
  // A frame whose pixels have several rays.
  struct Sampled {
    Camera camera;
    int width, height;
    Sampling sampling;
  };
  // What the samples of one request have in common.
  struct Request {
    LiveScene scene;
    RenderOptions options;
    bool from_frame = false;
    double lane_rounding = 0;  // of the Frame or RayBatch
    std::optional<Sampled> sampled{};
  };
  struct Sample {
    std::shared_ptr<const Request> request;
    Ray ray;
    Rgb answer;
    size_t index = 0;  // of the request's answers
  };

  template <class SampleAt>
  void OfferSamples(Request request, size_t answers, const SampleAt& sample_at);
  void Run();
  void Check(const Sample& sample);
  static Rgb ClassicalOf(const Sample& sample);
  void WakeUp();

  const LiveAuditOptions options_;
  const OnViolation on_violation_;
  BoundedQueue<Sample> waiting_;
  std::atomic<uint64_t> requests_{0};  // so that no two requests sample alike
  std::atomic<uint64_t> queued_{0};
  std::atomic<uint64_t> done_{0};
  std::atomic<uint32_t> wake_ups_{0};
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace linetree
