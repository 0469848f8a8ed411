// The certified linetrees of all objects of one scene that reflect or transmit, under a byte
// budget: where branches go, and radiance that may be interpolated. All requests with the same path
// limits share them.
//
// Thread safety: as surface_cache.h.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <shared_mutex>
#include <span>
#include <vector>

#include "core/cache/block_ledger.h"
#include "core/cache/cache_options.h"
#include "core/cache/cell_journal.h"
#include "core/cache/change_reach.h"
#include "core/cache/epoch.h"
#include "core/cache/parallel_loop.h"
#include "core/cache/tree_store.h"
#include "core/certify/path_certifier.h"
#include "core/certify/path_tree.h"
#include "core/certify/solid_interiors.h"

namespace linetree {

// A cell is certified when this many rays have fallen into it, of one frame or several: what that
// costs is then less than the searches that it saves. Rays of former requests count less and less,
// see KeptUses.
inline constexpr uint32_t kMinPathUses = 48;
// And divided when this many have: of one eye's rays a few children get most.
inline constexpr uint32_t kMinPathDivision = 4 * kMinPathUses;

// What is left of a cell's uses when a request of so many rays comes: half at least, nearly all
// when they are few. Without it cells become the finer the more often somebody flies by: sixteen
// clients built 1.8 times the cells of one who flew their union, and saved few searches more.
inline constexpr double kForgettingRays = 0x1p17;
inline double KeptUses(size_t rays) {
  return 1 - std::min(0.5, static_cast<double>(rays) / kForgettingRays);
}

// A cell costs about as much as tracing fifty rays: one for so many rays keeps the price of
// learning below a tenth of a frame. The cells that most rays ask for come first.
inline constexpr double kRaysPerNewCell = 512;
inline constexpr size_t kMinNewCells = 64;  // small batches may have so many all the same

// Samples that one reader takes; what more rays would add is not worth the memory.
inline constexpr size_t kMaxSamples = 4096;

// Path limits for which there are trees at the same time.
inline constexpr size_t kMaxPathForests = 8;

class PathCache {
 public:
  // Keeps a reference to the tracer, which must outlive the cache. Cells are at most `max_depth`
  // deep; readers and Refine ignore objects that are only matte.
  PathCache(const Tracer& tracer, uint64_t memory_bytes, int max_depth);
  ~PathCache();

  // A ray whose cell was looked up.
  struct Sample {
    int32_t object = 0;
    PathCoords at;
  };

  // As SurfaceCache::Reader.
  class Reader : public PathLists {
   public:
    // With `samples`, rays that are looked up are added to them, up to kMaxSamples; they must
    // outlive the reader.
    Reader(const PathCache& cache, const PathLimits& limits, std::vector<Sample>* samples);

    const PathStep* Find(const Hit& hit, const Vec3d& direction) const override;
    const SolidInterior* Inside(int object) const override {
      return cache_.interiors_.Find(object);
    }

    // Radiance along a ray with this hit, if a cell around it may answer at epsilon: then
    // kCertified, else why not.
    Verdict Interpolate(const Hit& hit, const Vec3d& direction, double epsilon,
                        Rgb& radiance) const;

   private:
    void Take(const Sample& sample) const {
      if (samples_ != nullptr && samples_->size() < kMaxSamples) samples_->push_back(sample);
    }
    // visit(const PathNode&, const CellPaths&) for the cells around a ray of which something is
    // known, the largest first; false when the ray has no place in any tree.
    template <class Fn>
    bool ForEachKnown(const Hit& hit, const Vec3d& direction, PathCoords& at, Fn&& visit) const;

    const PathCache& cache_;
    std::vector<Sample>* const samples_;
    const EpochGuard guard_;
    const TreeStore<PathTree>* store_ = nullptr;  // null: no trees for these limits yet
    uint32_t now_ = 0;
    // What Interpolate saw on its way, for the Find that follows it.
    mutable int32_t seen_object_ = kNoObject;
    mutable Vec3d seen_point_, seen_direction_;
    mutable std::optional<Sample> seen_sample_;
    mutable const PathStep* seen_steps_ = nullptr;
  };

  // Certifies and divides the cells of the samples where that pays; `weight` is the number of rays
  // that one sample stands for; `ahead` as in SurfaceCache::Thrift; of the uses that earlier calls
  // booked on a cell the share `kept_uses` still counts, see KeptUses. Returns how many cells it
  // certified.
  uint64_t Refine(const PathLimits& limits, std::span<const Sample> samples, double weight,
                  const ParallelLoop& loop, bool ahead = false, double kept_uses = 1);

  // As SurfaceCache::Adopt.
  Adopted Adopt(PathCache& former, const ChangeReach& reach, const ParallelLoop& loop);

  // As those of SurfaceCache. Of more path limits than there may be trees for, none are taken back.
  void SetJournal(CellJournal* journal) { journal_ = journal; }
  size_t Restore(const PathLimits& limits, std::span<KeptPathCell> cells);
  // As SurfaceCache's.
  void EndFrame(const FrameMark& mark);
  void SetPolicy(std::string_view name);
  Evicted evicted() const { return evicted_.now(); }
  uint64_t LedgerBytes() const { return costs_.ByteSize() + ledger_bytes_; }

  void SetMemoryBytes(uint64_t memory_bytes);
  uint64_t ByteSize() const;
  uint64_t CountBytes() const;
  uint64_t CellCount() const;
  AheadCounts ahead() const { return ahead_.now(); }
  // Cells by verdict, for every object of the scene.
  std::vector<std::array<uint64_t, kVerdictCount>> CellVerdicts() const;
  void Clear();

 private:
  struct Forest;
  struct Group;
  // Builds in a forest as long as it lives, which stays so long.
  class Builder;

  // Null where there is none; within a guard, or by those who keep it from being taken away.
  Forest* FindForest(const PathLimits& limits) const;
  // Null where others build in as many as there may be. Needs ledger_mutex_.
  Forest* OpenForest(const PathLimits& limits);
  // visit(Forest&), as FindForest.
  template <class Fn>
  void ForEachForest(Fn&& visit) const {
    for (const auto& slot : forests_) {
      if (Forest* forest = slot.get()) visit(*forest);
    }
  }
  void LookAround(Forest& forest, Group& group, const PathCoords& at) const;
  // Those of the samples' leaves that nobody else owns.
  std::vector<Group> GroupByLeaf(Forest& forest, std::span<const Sample> samples) const;
  // Of the groups' cells, certifies those that pay and most ask for, `allowance` at most (which it
  // takes them from).
  void Certify(Forest& forest, std::vector<Group>& groups, const ParallelLoop& loop,
               size_t& allowance) const;
  // Puts that into the trees and divides cells; the samples that go on come back.
  std::vector<Sample> Publish(Forest& forest, std::vector<Group> groups, bool ahead,
                              uint64_t& certified);
  static std::vector<Group*> ChooseNew(std::vector<Group>& groups, size_t allowance);
  // By trees and ledgers; within a guard, or as FindForest.
  uint64_t UsedBytes() const;
  // What the other forests leave of the budget.
  uint64_t BudgetOf(const Forest& forest) const;
  // Down to what a pass leaves. Needs ledger_mutex_, as the next two.
  void Evict();
  // As SurfaceCache's.
  void BeginAnew();
  void NoteLedgers();

  const Tracer& tracer_;
  const PathCertifier certifier_;
  const SolidInteriors interiors_;
  const int max_depth_;
  CellJournal* journal_ = nullptr;
  std::vector<bool> branches_;  // by object: whether it reflects or transmits
  std::atomic<uint64_t> memory_bytes_;
  std::atomic<uint64_t> ledger_bytes_{0};
  std::atomic<uint32_t> clock_{1};
  EvictedCounter evicted_;  // of all forests, also those that are gone
  std::array<OwningSlot<Forest>, kMaxPathForests> forests_;
  BuildCosts costs_;
  AheadCounters ahead_;
  // As SurfaceCache's.
  mutable std::shared_mutex builders_mutex_;
  mutable std::mutex ledger_mutex_;
  // Guarded by ledger_mutex_, as are the forests' ledgers and which forests there are:
  std::string policy_name_;
  uint32_t frame_begin_ = 1, pinned_ = 1;  // as SurfaceCache's
};

}  // namespace linetree
