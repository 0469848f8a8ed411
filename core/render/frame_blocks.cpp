#include "core/render/frame_blocks.h"

#include <algorithm>
#include <chrono>
#include <functional>
#include <optional>
#include <vector>

#include "core/frame/frame_kernels.h"
#include "core/packet/packet_scene.h"
#include "core/render/block_loop.h"
#include "core/render/block_tiles.h"
#include "core/render/grow_trees.h"
#include "core/render/sample_blocks.h"
#include "core/render/sample_mean.h"
#include "core/render/tile_sources.h"

namespace linetree {
namespace {

// What is promised is looked for where it is more than the one share of the frame's work; for cells
// that last, where it is less than the other.
constexpr double kLeastPromise = 0.01, kLargePromise = 0.1;
// What pays for itself many times within the frame may cost this share of its work; first of all
// the other, to see whether cells keep what was promised.
constexpr double kSureShare = 0.1, kTrialShare = 0.01;
// What cells save of the frame's work for it to be cut once more.
constexpr double kWorthTrying = 0.05;

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
        loop_(pool, cancel, progress, frame.stats.cpu_ms),
        frame_(frame),
        across_((frame.width + kBlockSide - 1) / kBlockSide),
        down_((frame.height + kBlockSide - 1) / kBlockSide) {
    if (!frame.sampling.IsPlain()) samples_.emplace(frame.sampling);
  }

  bool IsCancelled() const { return loop_.IsCancelled(); }

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

  // Without `asking` no tree is asked.
  void RenderWave(double from, double to, std::optional<Asking> asking, const TilesOf& tiles_of);
  void RenderSamples(double from, double to, std::optional<Asking> asking);
  void RenderOnce(size_t block, PacketWorkspace& workspace, PacketCounts& counts, OnceBlock& once,
                  UseCounts& uses);
  void RenderTask(const BlockTask& task, std::optional<Asking> asking, PacketWorkspace& workspace,
                  PacketCounts& counts, BookedPackets* booked = nullptr);
  // Where no tree pays there is nothing to look up.
  std::optional<Asking> PaidFor(std::optional<Asking> asking) const {
    return asking == Asking::kPlanned && !plan_.PaysAny() ? std::nullopt : asking;
  }
  // Rays of a pixel.
  double Each() const { return samples_ ? samples_->count() : 1; }
  double Grow(const Growth& growth);
  // Says what is to be booked.
  void ChooseProbes();
  FramePlan::Booked BookAgain();
  // Whose trees grow before they are asked for most of the frame, or only after it.
  void RenderLearning();
  void RenderSettled();
  void RenderRest();
  // Work of the whole frame without trees, by what was booked of it.
  double WorkOf(const FramePlan::Booked& booked) const {
    return Each() * kRayWork * static_cast<double>(frame_.object.size()) +
           share_ * booked.classical;
  }
  // Whether it was enough to look for it before the next frame is rendered.
  bool NotePromise(const FramePlan::Booked& booked) {
    const bool is_promising =
        plan_.always() || share_ * booked.promised > kLeastPromise * WorkOf(booked);
    plan_.SetPromising(is_promising);
    return is_promising && plan_.HopesAny();
  }
  // Lets trees grow in stages, for what they promise; returns what they save of what was booked.
  double Earn(double work, double promised);
  // Renders squares of blocks and grows trees for what has been earned.
  void TrySquares(double saved);

  const PacketTracer& packets_;
  SurfaceCache& surfaces_;
  FramePlan& plan_;
  const RenderOptions& options_;
  const EyeRays& eye_rays_;
  WorkerPool& pool_;
  BlockLoop loop_;
  Frame& frame_;
  const int across_, down_;
  // Of frames with several to a pixel. Their trees learn from rays through the pixels' centres,
  // which are no part of the picture.
  std::optional<PixelSamples> samples_;
  // Of a cached frame: tiles that are rendered, by block; what is booked there, and how many
  // shading points one that is booked stands for.
  std::vector<uint64_t> done_;
  std::vector<BookedPackets> booked_;
  double share_ = 0;
  bool books_ = false;  // this wave
};

void Blocks::RenderTask(const BlockTask& task, std::optional<Asking> asking,
                        PacketWorkspace& workspace, PacketCounts& counts, BookedPackets* booked) {
  if (!asking) {
    RenderBlockWide(packets_.scene(), task, workspace, counts);
    return;
  }
  const SurfaceCache::Reader reader(surfaces_, SumError());
  RenderFrameBlockWide(packets_.scene(), task, reader, plan_, *asking, booked, workspace, counts);
}

void Blocks::RenderWave(double from, double to, std::optional<Asking> asking,
                        const TilesOf& tiles_of) {
  // Once: other frames may decide meanwhile.
  const bool pays = PaidFor(asking).has_value();
  const auto books = [&](size_t block) { return books_ && booked_[block].tiles != 0; };
  std::vector<UseCounts> uses(BlockCount());
  RayCounts& rays = samples_ ? frame_.stats.ip : frame_.stats.base;
  loop_.Run(BlockCount(), from, to, rays,
            [&](size_t block, PacketWorkspace& workspace, PacketCounts& counts) {
              const uint64_t tiles = tiles_of(block);
              if (tiles == 0) return;
              const PixelTarget target = Target();
              const PacketTracer::Region region = RegionOf(block);
              const BlockTask task = {eye_rays_, region, options_.limits,
                                      Stride(),  target, packets_.sees_squares(),
                                      tiles};
              const bool asked = pays || books(block);
              RenderTask(task, asked ? asking : std::nullopt, workspace, counts,
                         books(block) ? &booked_[block] : nullptr);
              StoreSources(region, tiles, workspace.uses(), asked, frame_, uses[block]);
            });
  if (samples_) return;
  UseCounts all[2];  // of blocks where trees were not asked, and where they were
  for (size_t block = 0; block < uses.size(); ++block) all[pays || books(block)] += uses[block];
  for (const bool asked : {false, true}) AddSources(all[asked], asked, frame_.stats);
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
  loop_.Run(BlockCount(), from, to, frame_.stats.base, body);
  UseCounts all;
  for (const UseCounts& counts : uses) all += counts;
  AddSources(all, sampled.asked, frame_.stats);
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
// built so far are measured to save in the rest of the frame. Where the last frame has promised
// nothing, this one is not cut into waves: that costs more than to look.
void Blocks::RenderCached() {
  ChooseProbes();
  if (plan_.IsPromising() || samples_) {
    RenderLearning();
  } else {
    RenderSettled();
  }
}

void Blocks::ChooseProbes() {
  const uint32_t turn = plan_.decisions();
  const size_t often = OneProbedIn(BlockCount());
  share_ = Each() * static_cast<double>(kTilesOfBlock / kBookedTiles * often);
  done_.assign(BlockCount(), 0);
  booked_.assign(BlockCount(), {});
  for (size_t block = 0; block < BlockCount(); ++block) {
    if (!IsProbed(block, static_cast<size_t>(across_), often, turn)) continue;
    booked_[block].tiles = TilesToBook(block);
    booked_[block].one_in = samples_ ? 1 : kTilesOfBlock / kBookedTiles;
    // Rays through the centres of pixels that have several are no part of the picture.
    done_[block] = samples_ ? booked_[block].tiles : kAllTiles;
  }
}

void Blocks::RenderLearning() {
  {
    const StageTimer timer(frame_.stages.probe_ms);
    books_ = true;
    RenderWave(0, 0.1, Asking::kPlanned, [&](size_t block) { return done_[block]; });
    books_ = false;
  }
  const FramePlan::Booked first = plan_.Decide();
  const double work = WorkOf(first), promised = share_ * first.promised;
  double purse = kLearningShare * work;
  purse -= Grow({share_, share_, kSureHorizon, std::min(purse, promised / 2)});
  if (NotePromise(first)) {
    BookAgain();
    if (promised > kLargePromise * work) {
      const double saved = Earn(work, promised);
      if (share_ * saved > kWorthTrying * work) TrySquares(saved);
    } else {
      purse -= Grow({share_, share_, kLearningHorizon, purse});
    }
  }
  RenderRest();
  Grow({1, share_, kLearningHorizon, purse});
}

void Blocks::RenderSettled() {
  done_.assign(BlockCount(), 0);
  // All count here, each for itself.
  for (BookedPackets& booked : booked_) booked.others_count = true;
  books_ = true;
  RenderRest();
  books_ = false;
  const FramePlan::Booked booked = plan_.Decide();
  double purse = kLearningShare * WorkOf(booked);
  purse -= Grow({1, share_, kLearningHorizon, purse});
  if (!NotePromise(booked)) return;
  BookAgain();
  Grow({share_, share_, kLearningHorizon, purse});
}

void Blocks::RenderRest() {
  if (samples_) {
    RenderSamples(0.5, 1, Asking::kPlanned);
  } else {
    RenderWave(0.5, 1, Asking::kPlanned, [&](size_t block) { return ~done_[block]; });
  }
}

FramePlan::Booked Blocks::BookAgain() {
  const StageTimer timer(frame_.stages.probe_ms);
  RayCounts none;
  loop_.Run(BlockCount(), 0.1, 0.1, none,
            [&](size_t block, PacketWorkspace& workspace, PacketCounts&) {
              if (booked_[block].packets.empty()) return;
              const SurfaceCache::Reader reader(surfaces_, SumError());
              BookAgainWide(packets_.scene(), booked_[block], reader, plan_, workspace);
            });
  return plan_.Decide();
}

double Blocks::Earn(double work, double promised) {
  const double most_work = std::min(promised / 4, kSureShare * work);
  double spent = 0, saved = 0, purse = kTrialShare * work;
  while (plan_.HopesAny()) {
    const double now = Grow({share_, share_, kSureHorizon, std::min(purse, most_work - spent)});
    if (now == 0) break;
    spent += now;
    saved = BookAgain().saved;
    purse = kReinvested * share_ * saved - spent;
  }
  return saved;
}

void Blocks::TrySquares(double saved) {
  const auto square = [&](size_t block) { return TriedSquare(block) & ~done_[block]; };
  RenderWave(0.1, 0.5, Asking::kPlanned, square);
  for (size_t block = 0; block < done_.size(); ++block) done_[block] |= TriedSquare(block);
  const double earned = kReinvested * share_ * (1 - kTriedShare) * saved;
  if (earned > 0) Grow({Each() / kTriedShare, share_, kSureHorizon, earned});
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
