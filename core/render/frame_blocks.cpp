#include "core/render/frame_blocks.h"

#include <algorithm>
#include <chrono>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "core/frame/frame_kernels.h"
#include "core/packet/packet_scene.h"
#include "core/render/tile_sources.h"

namespace linetree {
namespace {

constexpr int kTilesOfBlock = kBlockPixels / kPacketLanes;
constexpr int kTilesOfSecondWave = 4;
constexpr uint64_t kAllTiles = ~uint64_t{0};
static_assert(kTilesOfBlock == 64);

// Two tiles' worth: smaller samples say little.
constexpr uint32_t kLeastUses = 32;
// What is learnt for the frames to come may cost this share of a frame of about kPixelWork a pixel
// (see frame_plan.h), and is to be worth its price within kHorizon frames.
constexpr double kLearningShare = 0.03;
constexpr double kPixelWork = 30;
constexpr double kHorizon = 6;
// What is built for the rest of a frame is to be worth eight times its price within that frame:
// savings are promised before they are known.
constexpr double kSureHorizon = 1.0 / 8;
constexpr uint32_t kOftenDecided = 3;
constexpr size_t kProbedBlocks = 4;  // then one in so many blocks is
constexpr size_t kUnlimited = std::numeric_limits<size_t>::max();

// Blocks that one parallel loop handles: enough to hide its cost, few enough to stop soon.
constexpr size_t kSliceBlocks = 256;

// Tiles of the first and of the first two waves: scattered, so that no pattern of the picture can
// hide from them.
uint64_t FirstTile(size_t block) { return uint64_t{1} << (block * 29 % kTilesOfBlock); }
// With a square of four elsewhere: rays that stay together are traced faster.
uint64_t FirstTiles(size_t block) {
  constexpr size_t kSquares = kTilesOfBlock / kTilesOfSecondWave;
  const size_t square = block * 11 % kSquares;
  const size_t corner = square / 4 * 16 + square % 4 * 2;  // of eight tiles a row
  return FirstTile(block) | uint64_t{0x303} << corner;
}

double PriceOf(const Scene& scene, size_t object) {
  const Shape& shape = scene.objects[object].shape;
  const bool curved =
      std::holds_alternative<SphereShape>(shape) || std::holds_alternative<FrustumShape>(shape);
  return WorkOfCell(scene.lights.size(), curved);
}

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
        down_((frame.height + kBlockSide - 1) / kBlockSide) {}

  bool IsCancelled() const { return cancel_ != nullptr && cancel_->IsCancelled(); }

  void RenderClassical() {
    RenderWave(0, 1, Wave::kClassical, [](size_t) { return kAllTiles; });
  }

  void RenderCached();

 private:
  // Whether the trees are asked, and the work is booked.
  enum class Wave { kClassical, kCached, kBooked };

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
  void ForBlocks(double from, double to, Fn&& body);
  template <class TilesOf>
  void RenderWave(double from, double to, Wave wave, TilesOf&& tiles_of);
  uint64_t Refine(double weight, double horizon, size_t most_cells);

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
  std::mutex mutex_;
  std::vector<std::unique_ptr<PacketWorkspace>> idle_;  // guarded by mutex_
};

// body(block, workspace, counts) for all blocks; reports progress from one share to the other.
template <class Fn>
void Blocks::ForBlocks(double from, double to, Fn&& body) {
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
    for (const PacketCounts& c : counts) frame_.stats.base += c.rays;
    const double done = static_cast<double>(begin + counts.size()) / static_cast<double>(count);
    if (progress_) progress_(from + (to - from) * done);
  }
}

template <class TilesOf>
void Blocks::RenderWave(double from, double to, Wave wave, TilesOf&& tiles_of) {
  // Where no tree pays there is nothing to look up.
  if (wave == Wave::kCached && plan_.SkipsAll()) wave = Wave::kClassical;
  const bool asked = wave != Wave::kClassical;
  std::vector<UseCounts> uses(BlockCount());
  ForBlocks(from, to, [&](size_t block, PacketWorkspace& workspace, PacketCounts& counts) {
    const uint64_t tiles = tiles_of(block);
    if (tiles == 0) return;
    const PixelTarget target = Target();
    const PacketTracer::Region region = RegionOf(block);
    const BlockTask task = {
        eye_rays_, region, options_.limits, Stride(), target, packets_.sees_squares(), tiles};
    if (asked) {
      const SurfaceCache::Reader reader(surfaces_, SumError());
      RenderFrameBlockWide(packets_.scene(), task, reader, plan_, wave == Wave::kBooked, workspace,
                           counts);
    } else {
      RenderBlockWide(packets_.scene(), task, workspace, counts);
    }
    StoreSources(region, tiles, workspace.uses(), asked, frame_, uses[block]);
  });
  for (const UseCounts& counts : uses) AddSources(counts, asked, frame_.stats);
}

// Cells that pay for themselves within `horizon` frames like this one.
uint64_t Blocks::Refine(double weight, double horizon, size_t most_cells) {
  if (IsCancelled()) return 0;
  const StageTimer timer(frame_.stages.learn_ms);
  // Who cancels does not wait for what others would learn either.
  const ParallelLoop loop = [&](size_t count, const std::function<void(size_t)>& body) {
    const auto unless_cancelled = [&](size_t i) {
      if (!IsCancelled()) body(i);
    };
    pool_.ParallelFor(count, unless_cancelled, &frame_.stats.cpu_ms);
  };
  const Scene& scene = packets_.tracer().scene();
  const std::function<double(size_t)> least_points = [&](size_t object) {
    if (plan_.Skips(object)) return Box3::kInf;
    return PriceOf(scene, object) / (horizon * plan_.SavedPerPoint(object));
  };
  // What is booked is one tile in kTilesOfBlock, and half of it once it has been looked at.
  const std::function<bool(size_t)> may_grow = [&](size_t object) {
    const bool pays =
        plan_.SavedInAll(object) * 2 * kTilesOfBlock * kHorizon >= PriceOf(scene, object);
    if (!pays) plan_.Skip(object);
    return pays;
  };
  const uint64_t cells = surfaces_.Refine(weight, loop,
                                          {plan_.always() ? 1 : kLeastUses, &least_points,
                                           &may_grow, plan_.always() ? kUnlimited : most_cells});
  frame_.stats.cells_tried += cells;
  frame_.stats.cells_accepted += cells;
  return cells;
}

void Blocks::RenderCached() {
  const uint64_t trees = surfaces_.TreeCount();
  // Who has decided often looks less often.
  const uint32_t turn = plan_.decisions();
  const auto first_tile = [turn](size_t block) {
    return turn < kOftenDecided || (block + turn) % kProbedBlocks == 0 ? FirstTile(block) : 0;
  };
  {
    const StageTimer timer(frame_.stages.probe_ms);
    RenderWave(0, 0.1, Wave::kBooked, first_tile);
  }
  plan_.Decide();
  const uint64_t cells = Refine(kTilesOfBlock, kSureHorizon, kUnlimited);
  const bool settled = cells == 0 && surfaces_.TreeCount() == trees;
  if (settled || !plan_.WantsAny()) {
    RenderWave(0.1, 1, Wave::kCached, [&](size_t block) { return kAllTiles & ~first_tile(block); });
  } else {
    RenderWave(0.1, 0.3, Wave::kCached,
               [&](size_t block) { return FirstTiles(block) & ~first_tile(block); });
    Refine(static_cast<double>(kTilesOfBlock) / kTilesOfSecondWave, kSureHorizon, kUnlimited);
    RenderWave(0.3, 1, Wave::kCached,
               [&](size_t block) { return kAllTiles & ~FirstTiles(block) & ~first_tile(block); });
  }
  const double work = kLearningShare * kPixelWork * static_cast<double>(frame_.object.size());
  const size_t lights = packets_.tracer().scene().lights.size();
  Refine(1, kHorizon, static_cast<size_t>(work / WorkOfCell(lights, false)));
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
