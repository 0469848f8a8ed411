// A loop over the blocks of a frame by all threads of a pool.
#pragma once

#include <algorithm>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "core/packet/packet_tracer.h"
#include "core/packet/packet_workspace.h"
#include "core/render/answer_rays.h"
#include "core/render/worker_pool.h"
#include "core/trace/counts.h"

namespace linetree {

// Not thread safe: one loop at a time.
class BlockLoop {
 public:
  // Null: nobody cancels or asks how far it is. Adds the time of all threads to `cpu_ms`.
  BlockLoop(WorkerPool& pool, const CancelToken* cancel, const Progress& progress, double& cpu_ms)
      : pool_(pool), cancel_(cancel), progress_(progress), cpu_ms_(cpu_ms) {}

  bool IsCancelled() const { return cancel_ != nullptr && cancel_->IsCancelled(); }

  // body(size_t block, PacketWorkspace&, PacketCounts&) for `count` blocks, whose rays are added to
  // `rays`; progress goes from one share to the other. Once it is cancelled no block is begun.
  template <class Fn>
  void Run(size_t count, double from, double to, RayCounts& rays, Fn&& body) {
    const size_t slice = progress_ ? kSliceBlocks : count;
    for (size_t begin = 0; begin < count && !IsCancelled(); begin += slice) {
      std::vector<RayCounts> counts(std::min(slice, count - begin));
      const auto run = [&](size_t i) {
        if (IsCancelled()) return;
        PacketCounts own;
        std::unique_ptr<PacketWorkspace> workspace = TakeWorkspace();
        body(begin + i, *workspace, own);
        counts[i] = own.rays;
        GiveWorkspace(std::move(workspace));
      };
      pool_.ParallelFor(counts.size(), run, &cpu_ms_);
      for (const RayCounts& c : counts) rays += c;
      const double done = static_cast<double>(begin + counts.size()) / static_cast<double>(count);
      if (progress_) progress_(from + (to - from) * done);
    }
  }

 private:
  // Where somebody wants to know how far it is, so many blocks are one parallel loop, at whose end
  // threads wait for each other.
  static constexpr size_t kSliceBlocks = 256;

  std::unique_ptr<PacketWorkspace> TakeWorkspace() {
    {
      std::lock_guard lock(mutex_);
      if (!idle_.empty()) {
        auto workspace = std::move(idle_.back());
        idle_.pop_back();
        return workspace;
      }
    }
    return std::make_unique<PacketWorkspace>();
  }
  void GiveWorkspace(std::unique_ptr<PacketWorkspace> workspace) {
    std::lock_guard lock(mutex_);
    idle_.push_back(std::move(workspace));
  }

  WorkerPool& pool_;
  const CancelToken* const cancel_;
  const Progress& progress_;
  double& cpu_ms_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<PacketWorkspace>> idle_;  // guarded by mutex_
};

}  // namespace linetree
