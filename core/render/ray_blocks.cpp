#include "core/render/ray_blocks.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <numeric>
#include <utility>
#include <vector>

#include "core/frame/frame_kernels.h"
#include "core/math/check.h"
#include "core/packet/packet_scene.h"
#include "core/render/grow_trees.h"
#include "core/render/ray_order.h"

namespace linetree {
namespace {

// Rays that come as they are go through this many at a time; those that are binned fewer, so that
// their hits stay in the processor's caches. It bounds the memory for both, whatever a request asks
// for.
constexpr size_t kPartRays = size_t{1} << 18;
constexpr size_t kBinnedPartRays = size_t{1} << 14;
constexpr size_t kBlockRays = kBlockPixels;
static_assert(kBlockPackets * kPacketLanes == kBlockRays);

constexpr uint64_t kAllPackets = ~uint64_t{0};
constexpr int kPacketsOfSecondWave = 4;
constexpr uint32_t kOftenDecided = 3;
constexpr size_t kProbedBlocks = 4;  // then one in so many blocks is

// Packets of the first wave and of the second one: scattered, as in frames.
uint64_t FirstPacket(size_t block) { return uint64_t{1} << (block * 29 % kBlockPackets); }
uint64_t SecondPackets(size_t block) {
  constexpr size_t kRuns = kBlockPackets / kPacketsOfSecondWave;
  return uint64_t{0xf} << (block * 11 % kRuns * kPacketsOfSecondWave);
}

class RayBlocks {
 public:
  RayBlocks(const PacketTracer& packets, SurfaceCache& surfaces, FramePlan& plan,
            const RenderOptions& options, WorkerPool& pool, const CancelToken* cancel,
            FrameStats& stats)
      : packets_(packets),
        surfaces_(surfaces),
        plan_(plan),
        options_(options),
        pool_(pool),
        cancel_(cancel),
        stats_(stats) {
    // As packets have it.
    const Rgb& background = scene().background;
    for (int c = 0; c < 3; ++c) {
      background_.radiance[c] = static_cast<double>(static_cast<float>(background[c]));
    }
  }

  bool IsCancelled() const { return cancel_ != nullptr && cancel_->IsCancelled(); }

  // `binned`: as RayOrder::kBinned.
  void Answer(std::span<const Ray> rays, bool binned, std::span<RayAnswer> answers);

 private:
  // What a thread works with.
  struct Bench {
    PacketWorkspace workspace;
    std::vector<RayResult> results = std::vector<RayResult>(kBlockRays);
  };

  const Scene& scene() const { return packets_.tracer().scene(); }
  std::span<const uint32_t> Block(size_t block) const {
    const size_t first = block * kBlockRays;
    return std::span(order_).subspan(first, std::min(kBlockRays, order_.size() - first));
  }
  // What sums may be off by.
  double SumError() const { return options_.max_relative_error - packets_.radiance_rounding(); }

  template <class Fn>
  void ForBlocks(Fn&& body);
  void FindHits();
  void TraceClassical();
  void TraceCached();
  template <class PacketsOf>
  void TraceWave(Asking asking, PacketsOf&& packets_of);
  uint64_t Grow(const Growth& growth);
  void Store(std::span<const uint32_t> block, uint64_t packets, std::span<const RayResult> results);
  RayAnswer AnswerOf(const RayResult& result) const;

  const PacketTracer& packets_;
  SurfaceCache& surfaces_;
  FramePlan& plan_;
  const RenderOptions& options_;
  WorkerPool& pool_;
  const CancelToken* cancel_;
  FrameStats& stats_;
  RayAnswer background_;
  std::span<const Ray> rays_;
  std::span<RayAnswer> answers_;
  std::vector<uint32_t> order_;
  std::vector<Hit> hits_;  // empty: not binned
  std::mutex mutex_;
  std::vector<std::unique_ptr<Bench>> idle_;  // guarded by mutex_
};

// body(block, bench, counts) for all blocks of the order.
template <class Fn>
void RayBlocks::ForBlocks(Fn&& body) {
  std::vector<PacketCounts> counts((order_.size() + kBlockRays - 1) / kBlockRays);
  pool_.ParallelFor(
      counts.size(),
      [&](size_t block) {
        if (IsCancelled()) return;
        std::unique_ptr<Bench> bench;
        {
          std::lock_guard lock(mutex_);
          if (!idle_.empty()) {
            bench = std::move(idle_.back());
            idle_.pop_back();
          }
        }
        if (!bench) bench = std::make_unique<Bench>();
        body(Block(block), *bench, counts[block], block);
        std::lock_guard lock(mutex_);
        idle_.push_back(std::move(bench));
      },
      &stats_.cpu_ms);
  for (const PacketCounts& c : counts) stats_.base += c.rays;
}

void RayBlocks::FindHits() {
  order_ = SortedRays(rays_, scene().WorldBounds());
  hits_.resize(rays_.size());
  ForBlocks([&](std::span<const uint32_t> block, Bench&, PacketCounts& counts, size_t) {
    FindRayHitsWide(packets_.scene(), rays_, block, hits_, counts);
  });
  order_ = BinnedHits(scene(), hits_);
  for (size_t i = 0; i < rays_.size(); ++i) {
    if (!hits_[i].IsHit()) answers_[i] = background_;
  }
}

void RayBlocks::TraceClassical() {
  ForBlocks([&](std::span<const uint32_t> block, Bench& bench, PacketCounts& counts, size_t) {
    TraceRayBlockWide(packets_.scene(), {rays_, hits_, block, bench.results, options_.limits},
                      bench.workspace, counts);
    Store(block, kAllPackets, bench.results);
  });
}

template <class PacketsOf>
void RayBlocks::TraceWave(Asking asking, PacketsOf&& packets_of) {
  ForBlocks([&](std::span<const uint32_t> block, Bench& bench, PacketCounts& counts, size_t index) {
    const uint64_t packets = packets_of(index);
    if (packets == 0) return;
    const SurfaceCache::Reader reader(surfaces_, SumError());
    TraceCachedRaysWide(packets_.scene(), {rays_, hits_, block, bench.results, options_.limits},
                        packets, reader, plan_, asking, bench.workspace, counts);
    Store(block, packets, bench.results);
  });
}

uint64_t RayBlocks::Grow(const Growth& growth) {
  if (IsCancelled()) return 0;
  // Who cancels does not wait for what others would learn either.
  const ParallelLoop loop = [&](size_t count, const std::function<void(size_t)>& body) {
    const auto unless_cancelled = [&](size_t i) {
      if (!IsCancelled()) body(i);
    };
    pool_.ParallelFor(count, unless_cancelled, &stats_.cpu_ms);
  };
  const auto grown = GrowTrees(scene(), surfaces_, plan_, growth, loop);
  stats_.cells_tried += grown.cells;
  stats_.cells_accepted += grown.cells;
  stats_.cells_unkept += grown.unkept;
  return grown.cells;
}

void RayBlocks::TraceCached() {
  if (rays_.size() < kLeastTeachingRays) {
    TraceWave(Asking::kExploring, [](size_t) { return kAllPackets; });
    return;
  }
  const uint64_t trees = surfaces_.TreeCount();
  // Who has decided often looks less often.
  const uint32_t turn = plan_.decisions();
  const auto first = [turn](size_t block) {
    return turn < kOftenDecided || (block + turn) % kProbedBlocks == 0 ? FirstPacket(block) : 0;
  };
  TraceWave(Asking::kBooked, first);
  const FramePlan::Booked booked = plan_.Decide();
  const double share = kBlockPackets * (turn < kOftenDecided ? 1.0 : kProbedBlocks);
  const double work = kRayWork * static_cast<double>(rays_.size()) + booked.classical * share;
  const double speculation = std::min(kLearningShare * work, share * booked.promised / 2);
  const uint64_t cells = Grow({kBlockPackets, share, kSureHorizon, speculation});
  const bool settled = cells == 0 && surfaces_.TreeCount() == trees;
  if (settled || !plan_.WantsAny()) {
    TraceWave(Asking::kExploring, [&](size_t block) { return kAllPackets & ~first(block); });
  } else {
    TraceWave(Asking::kExploring,
              [&](size_t block) { return SecondPackets(block) & ~first(block); });
    Grow({static_cast<double>(kBlockPackets) / kPacketsOfSecondWave, share, kSureHorizon,
          kReinvested * share * std::max(booked.saved, 0.0)});
    TraceWave(Asking::kExploring,
              [&](size_t block) { return kAllPackets & ~SecondPackets(block) & ~first(block); });
  }
  Grow({1, share, kLearningHorizon, kLearningShare * work});
}

RayAnswer RayBlocks::AnswerOf(const RayResult& result) const {
  if (result.object == kNoObject) return background_;
  RayAnswer answer;
  for (int c = 0; c < 3; ++c) answer.radiance[c] = static_cast<double>(result.radiance[c]);
  answer.object = result.object;
  answer.depth = result.depth;
  if (options_.mode == Mode::kCached && (result.uses & kSearched) == 0) {
    const bool summed = (result.uses & kSummed) != 0;
    answer.source = summed ? Source::kInterpolated : Source::kReplayed;
    if (summed) answer.verdict = Verdict::kCertified;
  } else {
    answer.source = (result.uses & kListed) != 0 ? Source::kResidual : Source::kTraced;
  }
  return answer;
}

void RayBlocks::Store(std::span<const uint32_t> block, uint64_t packets,
                      std::span<const RayResult> results) {
  for (size_t i = 0; i < block.size(); ++i) {
    if ((packets >> (i / kPacketLanes) & 1) != 0) answers_[block[i]] = AnswerOf(results[i]);
  }
}

void RayBlocks::Answer(std::span<const Ray> rays, bool binned, std::span<RayAnswer> answers) {
  rays_ = rays;
  answers_ = answers;
  hits_.clear();
  if (binned) {
    FindHits();
  } else {
    order_.resize(rays.size());
    std::iota(order_.begin(), order_.end(), 0u);
  }
  if (options_.mode == Mode::kCached) {
    TraceCached();
  } else {
    TraceClassical();
  }
}

}  // namespace

absl::Status AnswerRayBlocks(const PacketTracer& packets, SurfaceCache& surfaces, FramePlan& plan,
                             const RenderOptions& options, std::span<const Ray> rays,
                             WorkerPool& pool, const CancelToken* cancel,
                             std::span<RayAnswer> answers, FrameStats& stats) {
  LT_CHECK(rays.size() == answers.size());
  LT_CHECK(packets.IsWide());
  const bool binned = options.ray_order == RayOrder::kBinned ||
                      (options.ray_order == RayOrder::kAuto &&
                       !KeepTogether(rays, packets.tracer().scene().WorldBounds()));
  const size_t part_rays = binned ? kBinnedPartRays : kPartRays;
  RayBlocks blocks(packets, surfaces, plan, options, pool, cancel, stats);
  for (size_t begin = 0; begin < rays.size(); begin += part_rays) {
    const size_t count = std::min(part_rays, rays.size() - begin);
    blocks.Answer(rays.subspan(begin, count), binned, answers.subspan(begin, count));
    if (blocks.IsCancelled()) return absl::CancelledError("the request was cancelled");
  }
  CountAnswers(answers, stats);
  return absl::OkStatus();
}

}  // namespace linetree
