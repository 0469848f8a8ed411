#include "core/render/frame_blocks.h"

#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "core/frame/frame_kernels.h"
#include "core/packet/packet_scene.h"
#include "core/render/grow_trees.h"
#include "core/render/sample_blocks.h"
#include "core/render/sample_mean.h"
#include "core/render/tile_sources.h"

namespace linetree {
namespace {

constexpr int kTilesOfBlock = kBlockPixels / kPacketLanes;
constexpr size_t kTilesInRow = kBlockSide / 4;
constexpr uint64_t kAllTiles = ~uint64_t{0};
static_assert(kTilesOfBlock == 64);

// What is promised is looked for, in one of so many blocks, where it is more than the one share of
// the frame's work; for cells that last, where it is less than the other.
constexpr double kLeastPromise = 0.01, kLargePromise = 0.1;
constexpr size_t kExploredBlocks = 4;
// What pays for itself many times within the frame may cost this share of its work.
constexpr double kSureShare = 0.1;
// One in so many blocks is probed: while little is known, where trees pay, and where none does.
constexpr size_t kNewBlocks = 2, kProbedBlocks = 4, kIdleBlocks = 16;
constexpr uint32_t kOftenDecided = 6;
constexpr size_t kMostProbed = 256;  // there is no need for more

// Blocks that one parallel loop handles: enough to hide its cost, few enough to stop soon.
constexpr size_t kSliceBlocks = 256;

// One tile of a block, first of all: scattered, so that no pattern of the picture can hide from it.
uint64_t FirstTile(size_t block) { return uint64_t{1} << (block * 29 % kTilesOfBlock); }
// Then squares of so many tiles a side, elsewhere: rays that stay together are traced faster. First
// to see where cells are missing, then to see what they save.
constexpr size_t kExploredSide = 2, kTriedSide = 4;
// The top left one of such a square, and all of it.
uint64_t CornerOf(size_t block, size_t side) {
  const size_t squares = kTilesInRow / side;
  const size_t square = block * 11 % (squares * squares);
  return uint64_t{1} << (square / squares * side * kTilesInRow + square % squares * side);
}
uint64_t SquareOf(size_t block, size_t side) {
  uint64_t tiles = 0;
  for (size_t row = 0; row < side; ++row) {
    tiles |= (CornerOf(block, side) * ((uint64_t{1} << side) - 1)) << (row * kTilesInRow);
  }
  return tiles;
}
// Of a block, how much a square is.
constexpr double ShareOf(size_t side) { return static_cast<double>(side * side) / kTilesOfBlock; }

// Adds the time that it lives to `ms`.
class StageTimer {
 public:
  explicit StageTimer(double& ms) : ms_(ms) {}
  ~StageTimer() {
    const auto elapsed = std::chrono::steady_clock::now() - begin_;
    ms_ += std::chrono::duration<double, std::milli>(elapsed).count();
  }
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

 private:
  double& ms_;
  const std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

class Blocks {
 public:
  Blocks(const PacketTracer& packets, SurfaceCache& surfaces, FramePlan& plan,
         const RenderOptions& options, const EyeRays& eye_rays, WorkerPool& pool,
         const CancelToken* cancel, const Progress& progress, Frame& frame)
      : packets_(packets),
        surfaces_(surfaces),
        plan_(plan),
        options_(options),
        eye_rays_(eye_rays),
        pool_(pool),
        cancel_(cancel),
        progress_(progress),
        frame_(frame),
        across_((frame.width + kBlockSide - 1) / kBlockSide),
        down_((frame.height + kBlockSide - 1) / kBlockSide) {
    if (!frame.sampling.IsPlain()) samples_.emplace(frame.sampling);
  }

  bool IsCancelled() const { return cancel_ != nullptr && cancel_->IsCancelled(); }

  void RenderClassical() {
    if (samples_) {
      RenderSamples(0, 1, std::nullopt);
    } else {
      RenderWave(0, 1, std::nullopt, [](size_t) { return kAllTiles; });
    }
  }

  void RenderCached();

 private:
  using TilesOf = std::function<uint64_t(size_t block)>;

  PacketTracer::Region RegionOf(size_t block) const {
    const int column = static_cast<int>(block) % across_ * kBlockSide;
    const int row = static_cast<int>(block) / across_ * kBlockSide;
    return {column, row, std::min(kBlockSide, frame_.width - column),
            std::min(kBlockSide, frame_.height - row)};
  }
  size_t BlockCount() const { return static_cast<size_t>(across_) * static_cast<size_t>(down_); }
  size_t Stride() const { return static_cast<size_t>(frame_.width); }
  PixelTarget Target() {
    return {frame_.radiance.data(), frame_.object.data(), frame_.depth.data(), nullptr};
  }
  // What sums may be off by.
  double SumError() const { return options_.max_relative_error - packets_.radiance_rounding(); }

  template <class Fn>
  void ForBlocks(double from, double to, RayCounts& rays, Fn&& body);
  // Without `asking` no tree is asked.
  void RenderWave(double from, double to, std::optional<Asking> asking, const TilesOf& tiles_of);
  void RenderSamples(double from, double to, std::optional<Asking> asking);
  void RenderOnce(size_t block, PacketWorkspace& workspace, PacketCounts& counts, OnceBlock& once,
                  UseCounts& uses);
  void RenderTask(const BlockTask& task, std::optional<Asking> asking, PacketWorkspace& workspace,
                  PacketCounts& counts);
  // Where no tree pays there is nothing to look up.
  std::optional<Asking> PaidFor(std::optional<Asking> asking) const {
    return asking == Asking::kPlanned && !plan_.PaysAny() ? std::nullopt : asking;
  }
  // Rays of a pixel.
  double Each() const { return samples_ ? samples_->count() : 1; }
  double Grow(const Growth& growth);
  FramePlan::Booked Probe(double from, double to, const TilesOf& tiles_of);
  // Render squares of blocks, what is not `done` of them, and grow trees: for at most so much,
  // which returns what it cost; and for what has been earned.
  double Explore(size_t often, double horizon, double most_work, std::vector<uint64_t>& done);
  void TrySquares(std::vector<uint64_t>& done);
  // In one of so many blocks a tile is booked.
  size_t ProbedBlocks() const {
    const size_t often = std::max<size_t>(1, BlockCount() / kMostProbed);
    if (plan_.decisions() < kOftenDecided) return kNewBlocks * often;
    return (plan_.SkipsAll() ? kIdleBlocks : kProbedBlocks) * often;
  }

  const PacketTracer& packets_;
  SurfaceCache& surfaces_;
  FramePlan& plan_;
  const RenderOptions& options_;
  const EyeRays& eye_rays_;
  WorkerPool& pool_;
  const CancelToken* cancel_;
  const Progress& progress_;
  Frame& frame_;
  const int across_, down_;
  // Of frames with several to a pixel. Their trees learn from rays through the pixels' centres,
  // which are no part of the picture.
  std::optional<PixelSamples> samples_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<PacketWorkspace>> idle_;  // guarded by mutex_
};

// body(block, workspace, counts) for all blocks; reports progress from one share to the other.
template <class Fn>
void Blocks::ForBlocks(double from, double to, RayCounts& rays, Fn&& body) {
  const size_t count = BlockCount();
  for (size_t begin = 0; begin < count && !IsCancelled(); begin += kSliceBlocks) {
    std::vector<PacketCounts> counts(std::min(kSliceBlocks, count - begin));
    pool_.ParallelFor(
        counts.size(),
        [&](size_t i) {
          if (IsCancelled()) return;
          std::unique_ptr<PacketWorkspace> workspace;
          {
            std::lock_guard lock(mutex_);
            if (!idle_.empty()) {
              workspace = std::move(idle_.back());
              idle_.pop_back();
            }
          }
          if (!workspace) workspace = std::make_unique<PacketWorkspace>();
          body(begin + i, *workspace, counts[i]);
          std::lock_guard lock(mutex_);
          idle_.push_back(std::move(workspace));
        },
        &frame_.stats.cpu_ms);
    for (const PacketCounts& c : counts) rays += c.rays;
    const double done = static_cast<double>(begin + counts.size()) / static_cast<double>(count);
    if (progress_) progress_(from + (to - from) * done);
  }
}

void Blocks::RenderTask(const BlockTask& task, std::optional<Asking> asking,
                        PacketWorkspace& workspace, PacketCounts& counts) {
  if (!asking) {
    RenderBlockWide(packets_.scene(), task, workspace, counts);
    return;
  }
  const SurfaceCache::Reader reader(surfaces_, SumError());
  RenderFrameBlockWide(packets_.scene(), task, reader, plan_, *asking, workspace, counts);
}

void Blocks::RenderWave(double from, double to, std::optional<Asking> asking,
                        const TilesOf& tiles_of) {
  asking = PaidFor(asking);
  const bool asked = asking.has_value();
  std::vector<UseCounts> uses(BlockCount());
  RayCounts& rays = samples_ ? frame_.stats.ip : frame_.stats.base;
  ForBlocks(from, to, rays, [&](size_t block, PacketWorkspace& workspace, PacketCounts& counts) {
    const uint64_t tiles = tiles_of(block);
    if (tiles == 0) return;
    const PixelTarget target = Target();
    const PacketTracer::Region region = RegionOf(block);
    const BlockTask task = {
        eye_rays_, region, options_.limits, Stride(), target, packets_.sees_squares(), tiles};
    RenderTask(task, asking, workspace, counts);
    StoreSources(region, tiles, workspace.uses(), asked, frame_, uses[block]);
  });
  if (samples_) return;
  for (const UseCounts& counts : uses) AddSources(counts, asked, frame_.stats);
}

void Blocks::RenderOnce(size_t block, PacketWorkspace& workspace, PacketCounts& counts,
                        OnceBlock& once, UseCounts& uses) {
  const PacketTracer::Region region = RegionOf(block);
  const PixelTarget target = Target();
  const ShownSample shown(*samples_);
  const OnceTask task = {eye_rays_, region, Stride(), target, *samples_, shown.column, shown.row};
  const SurfaceCache::Reader reader(surfaces_, SumError());
  RenderOnceWide(packets_.scene(), task, reader, plan_, workspace, counts, once);
  const auto each = static_cast<uint64_t>(samples_->count());
  StoreOnce(region, once.done, workspace.uses(), each, frame_, uses);
}

void Blocks::RenderSamples(double from, double to, std::optional<Asking> asking) {
  asking = PaidFor(asking);
  const EyeRays eye_rays = eye_rays_.Divided(samples_->across(), samples_->down());
  const SampledFrame sampled = {
      *samples_, eye_rays, options_.limits, packets_.sees_squares(), asking.has_value(), frame_};
  // At epsilon 0 every sample is evaluated.
  const bool evaluates_once = sampled.asked && SumError() > 0;
  std::vector<UseCounts> uses(BlockCount());
  const auto body = [&](size_t block, PacketWorkspace& workspace, PacketCounts& counts) {
    const auto render = [&](const BlockTask& task) {
      RenderTask(task, asking, workspace, counts);
      return workspace.uses();
    };
    OnceBlock once;
    if (evaluates_once) RenderOnce(block, workspace, counts, once, uses[block]);
    RenderSampledBlock(sampled, RegionOf(block), render, evaluates_once ? &once : nullptr,
                       uses[block]);
  };
  ForBlocks(from, to, frame_.stats.base, body);
  for (const UseCounts& counts : uses) AddSources(counts, sampled.asked, frame_.stats);
}

double Blocks::Grow(const Growth& growth) {
  if (IsCancelled()) return 0;
  const StageTimer timer(frame_.stages.learn_ms);
  // Who cancels does not wait for what others would learn either.
  const ParallelLoop loop = [&](size_t count, const std::function<void(size_t)>& body) {
    const auto unless_cancelled = [&](size_t i) {
      if (!IsCancelled()) body(i);
    };
    pool_.ParallelFor(count, unless_cancelled, &frame_.stats.cpu_ms);
  };
  Growth own = growth;
  own.ahead = options_.ahead;
  const auto grown = GrowTrees(packets_.tracer().scene(), surfaces_, plan_, own, loop);
  frame_.stats.cells_tried += grown.cells;
  frame_.stats.cells_accepted += grown.cells;
  frame_.stats.cells_unkept += grown.unkept;
  return grown.work;
}

// Trees grow for a small share of the frame's work, and by what they earn: half of what the cells
// built so far are measured to save in the rest of the frame.
void Blocks::RenderCached() {
  const uint32_t turn = plan_.decisions();
  const size_t probed = ProbedBlocks();
  const auto first_tile = [&](size_t block) {
    return (block + turn) % probed == 0 ? FirstTile(block) : 0;
  };
  const FramePlan::Booked first = Probe(0, 0.05, first_tile);
  const double share = Each() * static_cast<double>(kTilesOfBlock * probed);
  const double work =
      Each() * kRayWork * static_cast<double>(frame_.object.size()) + share * first.classical;
  const double promised = share * first.promised;
  double purse = kLearningShare * work;
  purse -= Grow({share, share, kSureHorizon, std::min(purse, promised / 2)});
  std::vector<uint64_t> done(BlockCount());
  for (size_t block = 0; block < done.size(); ++block) done[block] = first_tile(block);
  if (plan_.HopesAny() && promised > kLeastPromise * work) {
    if (promised > kLargePromise * work) {
      const double most_work = std::min(promised / 4, kSureShare * work);
      if (Explore(kExploredBlocks, kSureHorizon, most_work, done) > 0) TrySquares(done);
    } else {
      purse -= Explore(kExploredBlocks, kLearningHorizon, purse, done);
    }
  }
  if (samples_) {
    RenderSamples(0.5, 1, Asking::kPlanned);
  } else {
    RenderWave(0.5, 1, Asking::kPlanned, [&](size_t block) { return kAllTiles & ~done[block]; });
  }
  Grow({1, share, kLearningHorizon, purse});
}

FramePlan::Booked Blocks::Probe(double from, double to, const TilesOf& tiles_of) {
  const StageTimer timer(frame_.stages.probe_ms);
  RenderWave(from, to, Asking::kBooked, tiles_of);
  return plan_.Decide();
}

double Blocks::Explore(size_t often, double horizon, double most_work,
                       std::vector<uint64_t>& done) {
  const uint32_t turn = plan_.decisions();
  const auto square = [&](size_t block) {
    return (block + turn) % often == 0 ? SquareOf(block, kExploredSide) : 0;
  };
  RenderWave(0.05, 0.1, Asking::kExploring,
             [&](size_t block) { return square(block) & ~done[block]; });
  for (size_t block = 0; block < done.size(); ++block) done[block] |= square(block);
  const double weight = Each() * static_cast<double>(often) / ShareOf(kExploredSide);
  const double booked = Each() * static_cast<double>(kTilesOfBlock * ProbedBlocks());
  return Grow({weight, booked, horizon, most_work});
}

// One tile of some is booked.
void Blocks::TrySquares(std::vector<uint64_t>& done) {
  const size_t probed = ProbedBlocks();
  const auto corner = [&](size_t block) {
    return block % probed == 0 ? CornerOf(block, kTriedSide) & ~done[block] : 0;
  };
  const FramePlan::Booked booked = Probe(0.1, 0.15, corner);
  RenderWave(0.15, 0.5, Asking::kPlanned, [&](size_t block) {
    return SquareOf(block, kTriedSide) & ~corner(block) & ~done[block];
  });
  for (size_t block = 0; block < done.size(); ++block) done[block] |= SquareOf(block, kTriedSide);
  const double share = Each() * static_cast<double>(kTilesOfBlock * probed);
  const double earned = kReinvested * share * (1 - ShareOf(kTriedSide)) * booked.saved;
  if (earned > 0) Grow({Each() / ShareOf(kTriedSide), share, kSureHorizon, earned});
}

}  // namespace

absl::Status RenderBlocks(const PacketTracer& packets, SurfaceCache& surfaces, FramePlan& plan,
                          const RenderOptions& options, const EyeRays& eye_rays, WorkerPool& pool,
                          const CancelToken* cancel, const Progress& progress, Frame& frame) {
  Blocks blocks(packets, surfaces, plan, options, eye_rays, pool, cancel, progress, frame);
  if (options.mode == Mode::kCached) {
    blocks.RenderCached();
  } else {
    blocks.RenderClassical();
  }
  if (blocks.IsCancelled()) return absl::CancelledError("the request was cancelled");
  return absl::OkStatus();
}

}  // namespace linetree
