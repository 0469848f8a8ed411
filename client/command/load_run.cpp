#include "client/command/load_run.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <limits>
#include <mutex>
#include <thread>

#include "client/command/light_calls.h"
#include "client/library/status.h"
#include "core/math/check.h"

namespace linetree {
namespace {

using Clock = std::chrono::steady_clock;

// What one phase does.
struct PhasePlan {
  size_t frames_each = 0;  // 0: until the time is up; in an open loop arrivals say
  double duration_s = std::numeric_limits<double>::infinity();
  std::optional<std::vector<double>> arrivals{};  // open loop
  size_t frames = 0;                              // of all clients, for the progress; 0: unknown
};

// One phase of a load test, once.
class PhaseRun {
 public:
  PhaseRun(const LoadPlan& plan, PhasePlan phase, const std::vector<Client*>& clients,
           const std::function<void(double)>& progress)
      : plan_(plan), phase_(std::move(phase)), clients_(clients), progress_(progress) {}

  // Each client on a thread of its own.
  absl::StatusOr<LoadPhase> Run() {
    std::vector<std::thread> threads;
    for (size_t c = 0; c < clients_.size(); ++c) {
      threads.emplace_back([this, c] {
        if (phase_.arrivals) return FlyOpen(c);
        if (plan_.stream && plan_.newest) return FlyNewest(c);
        if (plan_.stream) return FlyStream(c);
        FlyClosed(c);
      });
    }
    for (std::thread& thread : threads) thread.join();
    if (!error_.ok()) return error_;
    LoadPhase result;
    result.samples = std::move(samples_);
    result.overtaken = looked_ - std::min<uint64_t>(looked_, result.samples.size());
    if (phase_.arrivals) result.not_begun = phase_.arrivals->size() - result.samples.size();
    return result;
  }

 private:
  double Now() const { return std::chrono::duration<double>(Clock::now() - began_).count(); }
  bool TimeIsUp() const { return stop_ || Now() >= phase_.duration_s; }

  // Or until the test ends.
  void WaitUntil(double time_s) {
    const std::chrono::duration<double> from_begin(time_s);
    std::unique_lock lock(mutex_);
    stopped_.wait_until(lock, began_ + std::chrono::duration_cast<Clock::duration>(from_begin),
                        [this] { return stop_.load(); });
  }

  FrameRequest RequestOf(size_t client, size_t frame) const {
    const FlightPiece& piece = plan_.pieces[client];
    const std::vector<Camera>& path = plan_.paths[piece.path];
    FrameRequest request = plan_.frame;
    request.camera = path[(piece.first + frame % piece.frames) % path.size()];
    return request;
  }

  size_t FramesOf(size_t client) const {
    if (phase_.frames_each > 0) return phase_.frames_each;
    const bool endless = std::isfinite(phase_.duration_s);
    return endless ? std::numeric_limits<size_t>::max() : plan_.pieces[client].frames;
  }

  void FlyClosed(size_t client) {
    for (size_t frame = 0; frame < FramesOf(client) && !TimeIsUp(); ++frame) {
      LoadSample sample{.client = client, .frame = frame};
      sample.intended_s = sample.start_s = Now();
      WaitUntil(Ask(sample));
    }
  }

  void FlyOpen(size_t client) {
    for (size_t frame = 0;; ++frame) {
      const size_t arrival = next_++;
      if (arrival >= phase_.arrivals->size()) return;
      LoadSample sample{.client = client, .frame = frame};
      sample.intended_s = (*phase_.arrivals)[arrival];
      // The first ones found everybody free, however long their threads took to start.
      sample.late = arrival >= clients_.size() && Now() > sample.intended_s;
      WaitUntil(sample.intended_s);
      if (TimeIsUp()) return;
      sample.start_s = Now();
      Ask(sample);
    }
  }

  void FlyStream(size_t client) {
    const size_t frames = FramesOf(client);
    size_t next = 0;
    while (next < frames && !stop_) {
      std::vector<FrameRequest> requests;
      for (size_t f = next; f < frames; ++f) requests.push_back(RequestOf(client, f));
      double before_s = Now();
      const absl::Status status = clients_[client]->Fly(
          plan_.scene, requests, plan_.format, [&](size_t, const Frame& frame) {
            LoadSample sample{.client = client, .frame = next++, .intended_s = before_s};
            sample.start_s = before_s;
            before_s = sample.end_s = Now();
            Keep(sample, frame);
          });
      if (status.ok()) return;
      LoadSample refused{.client = client, .frame = next++, .intended_s = before_s};
      refused.start_s = before_s;
      refused.end_s = Now();
      WaitUntil(KeepRefusal(refused, status));
    }
  }

  // A refusal ends the client's flight: what it looks at is not asked for a second time.
  void FlyNewest(size_t client) {
    const auto intended_s = [this](uint64_t view) {
      return static_cast<double>(view) / *plan_.newest;
    };
    const auto flight =
        clients_[client]->Steer(plan_.scene, {.format = plan_.format}, [&](LiveFrame live) {
          LoadSample sample{
              .client = client, .frame = live.view, .intended_s = intended_s(live.view)};
          sample.start_s = sample.intended_s;
          sample.end_s = Now();
          Keep(sample, live.frame);
        });
    for (size_t frame = 0; frame < FramesOf(client) && !stop_; ++frame) {
      WaitUntil(intended_s(frame));
      if (!flight->Look(RequestOf(client, frame)).ok()) break;
      ++looked_;
    }
    const absl::Status status = flight->Land();
    if (status.ok()) return;
    LoadSample refused{.client = client, .intended_s = Now()};
    refused.start_s = refused.end_s = refused.intended_s;
    KeepRefusal(refused, status);
  }

  // When the client may ask again: later than now after a refusal.
  double Ask(LoadSample& sample) {
    const FrameRequest request = RequestOf(sample.client, sample.frame);
    const absl::StatusOr<Frame> frame =
        clients_[sample.client]->RenderFrame(plan_.scene, request, "", plan_.format, {});
    sample.end_s = Now();
    if (!frame.ok()) return KeepRefusal(sample, frame.status());
    Keep(sample, *frame);
    return sample.end_s;
  }

  double KeepRefusal(LoadSample& sample, const absl::Status& status) {
    const std::lock_guard lock(mutex_);
    const auto back_in_ms = RetryAfter(status);
    // What is too large is refused for ever, which a negative delay says.
    if (!absl::IsResourceExhausted(status) || !back_in_ms || back_in_ms->count() < 0) {
      if (error_.ok()) error_ = status;
      stop_ = true;
      stopped_.notify_all();
      return sample.end_s;
    }
    sample.refused = true;
    samples_.push_back(sample);
    return sample.end_s + std::chrono::duration<double>(*back_in_ms).count();
  }

  void Keep(LoadSample& sample, const Frame& frame) {
    sample.timing = frame.timing;
    sample.wire_bytes = frame.wire_bytes;
    sample.stats = frame.stats;
    const std::lock_guard lock(mutex_);
    samples_.push_back(sample);
    if (!progress_) return;
    const double by_frames = phase_.frames == 0 ? 0
                                                : static_cast<double>(samples_.size()) /
                                                      static_cast<double>(phase_.frames);
    progress_(std::min(1.0, std::max(by_frames, sample.end_s / phase_.duration_s)));
  }

  const LoadPlan& plan_;
  const PhasePlan phase_;
  const std::vector<Client*>& clients_;
  const std::function<void(double)>& progress_;
  const Clock::time_point began_ = Clock::now();
  std::atomic<bool> stop_{false};
  std::atomic<size_t> next_{0};      // of the arrivals
  std::atomic<uint64_t> looked_{0};  // viewpoints of flights by the newest
  std::mutex mutex_;
  std::condition_variable stopped_;
  std::vector<LoadSample> samples_;  // guarded by mutex_
  absl::Status error_;               // guarded by mutex_
};

// Cells of all trees of the scene of which something is known.
// Of all trees of the scene, of either judge.
struct CellCount {
  uint64_t held = 0;
  uint64_t evicted = 0;  // since the scene was loaded
};

absl::StatusOr<CellCount> CountCells(Client& client, const std::string& scene) {
  const auto stats = client.GetStats(scene);
  if (!stats.ok()) return stats.status();
  LT_CHECK(stats->scenes_size() == 1);
  const auto& counts = stats->scenes(0);
  return CellCount{counts.cells() + counts.surface_cells(),
                   counts.cells_evicted() + counts.totals().cells_evicted()};
}

size_t FramesOfAll(const LoadPlan& plan) {
  if (plan.frames_each > 0) return plan.frames_each * plan.pieces.size();
  if (plan.duration_s > 0) return 0;
  size_t all = 0;
  for (const FlightPiece& piece : plan.pieces) all += piece.frames;
  return all;
}

PhasePlan MeasuredPhase(const LoadPlan& plan) {
  PhasePlan phase{.frames_each = plan.frames_each, .frames = FramesOfAll(plan)};
  if (plan.duration_s > 0) phase.duration_s = plan.duration_s;
  if (plan.arrivals) {
    const size_t most = phase.frames == 0 ? std::numeric_limits<size_t>::max() : phase.frames;
    phase.arrivals = PlanArrivals(*plan.arrivals, most, phase.duration_s);
    phase.frames = phase.arrivals->size();
  }
  return phase;
}

}  // namespace

absl::StatusOr<std::vector<LoadPhase>> RunLoad(const LoadPlan& plan,
                                               const std::vector<Client*>& clients,
                                               const std::function<void(double)>& progress,
                                               Client* light) {
  LT_CHECK(!clients.empty() && clients.size() == plan.pieces.size());
  std::vector<std::pair<std::string, PhasePlan>> todo;
  if (plan.warm_up_frames > 0) {
    todo.emplace_back("warm-up", PhasePlan{.frames_each = plan.warm_up_frames,
                                           .frames = plan.warm_up_frames * clients.size()});
  }
  todo.emplace_back("measured", MeasuredPhase(plan));
  std::vector<LoadPhase> phases;
  for (auto& [name, phase] : todo) {
    const auto before = CountCells(*clients.front(), plan.scene);
    if (!before.ok()) return before.status();
    std::optional<LightCalls> meanwhile;
    if (light != nullptr) meanwhile.emplace(*light, plan.scene);
    auto result = PhaseRun(plan, phase, clients, progress).Run();
    if (!result.ok()) return result.status();
    if (meanwhile) {
      auto latencies_ms = meanwhile->Finish();
      if (!latencies_ms.ok()) return latencies_ms.status();
      result->light_calls_ms = *std::move(latencies_ms);
    }
    const auto after = CountCells(*clients.front(), plan.scene);
    if (!after.ok()) return after.status();
    result->name = name;
    result->cells_evicted = after->evicted - before->evicted;
    const uint64_t known = after->held + result->cells_evicted;
    result->cells_built = known > before->held ? known - before->held : 0;
    phases.push_back(*std::move(result));
  }
  return phases;
}

}  // namespace linetree
