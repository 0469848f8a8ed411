// The surface trees of all objects of one scene under a byte budget: what is certain about lights,
// for every shading point of every request. It depends on nothing but the scene, so all requests
// share it; answers that use it equal the classical tracer's bit for bit.
//
// Thread safety: every method may be called from any thread. Readers wait for nobody (epoch.h). So
// do those who call Refine: each makes the cells that it builds its own first, and passes over what
// somebody else is building. One at a time books uses and evicts. Adopt, Restore, Clear and
// SetMemoryBytes wait for those who build.
#pragma once

#include <atomic>
#include <functional>
#include <limits>
#include <mutex>
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
#include "core/certify/diffuse_summer.h"
#include "core/trace/light_lists.h"
#include "core/trace/tracer.h"
#include "core/tree/light_certifier.h"
#include "core/tree/surface_tree.h"

namespace linetree {

// A cell is divided when this many shading points of one frame fall into it and a light above it is
// undecided (DESIGN, section 7: smaller cells cost more than they save).
inline constexpr double kMinSurfaceUses = 200;

class SurfaceCache {
 public:
  // Keeps a reference to the tracer, which must outlive the cache. Cells with `min_uses` or more
  // are divided. `uses_functions` as for LightCertifier.
  SurfaceCache(const Tracer& tracer, uint64_t memory_bytes, double min_uses = kMinSurfaceUses,
               bool uses_functions = true);

  // Holds up those who evict: keep it short, a part of a frame. Stays with its thread.
  class Reader : public LightLists {
   public:
    // Diffuse sums are used where they meet `epsilon`; at 0 never. Each hit that Find is asked for
    // counts as `points` uses: readers of different frames stand for different numbers of points
    // at the same time, and nobody knows whose uses it is that Refine finds.
    explicit Reader(const SurfaceCache& cache, double epsilon = 0, uint32_t points = 1);
    KnownLights Find(const Hit& hit) const override;

    // The object's tree, for those who look cells up themselves; null where there is none yet,
    // which counts as asking for one.
    const SurfaceTree* TreeOf(size_t object) const;
    uint32_t now() const { return cache_.clock_; }
    double epsilon() const { return epsilon_; }

   private:
    const SurfaceCache& cache_;
    const double epsilon_;
    const uint32_t points_;
    const EpochGuard guard_;
  };

  // Which of the cells that were used are worth their price.
  struct Thrift {
    uint32_t least_uses = 1;  // of a cell that is certified
    // What a cell of an object costs, given what is known of the one that it is a quarter of (null:
    // nothing).
    using Price = std::function<double(size_t object, const CellLights* parent)>;
    // Shading points of an object's cell that is certified (infinity: none); of one that is
    // divided, given what is known of it, twice as many, and the cache's own least number at least.
    // Null: any.
    const Price* least_points = nullptr;
    // Whether an object without a tree may get one. Null: all.
    const std::function<bool(size_t)>* may_grow = nullptr;
    // Prices, and what all cells may cost together: those that most points ask for come first.
    // Null: nothing.
    const Price* price = nullptr;
    double most_work = std::numeric_limits<double>::infinity();
    // Whether what was used was so by requests that nobody has made (AheadCounts).
    bool ahead = false;
  };
  struct Grown {
    uint64_t cells = 0;   // certified
    double work = 0;      // their price
    uint64_t unkept = 0;  // cells and trees that were asked for and found no room
  };
  // Certifies and divides the cells that were used since the last call where that pays; `weight` is
  // the number of shading points that one use stands for.
  Grown Refine(double weight, const ParallelLoop& loop, const Thrift& thrift);
  uint64_t Refine(double weight, const ParallelLoop& loop) {
    return Refine(weight, loop, {}).cells;
  }

  // Takes over what the cache of a former scene knows and the change has not touched; that one is
  // empty afterwards, and stays so. Before anybody asks this one.
  Adopted Adopt(SurfaceCache& former, const ChangeReach& reach, const ParallelLoop& loop);

  // Tells of cells from now on; it must outlive the cache. Before anybody asks.
  void SetJournal(CellJournal* journal) { journal_ = journal; }
  // Takes kept cells back as far as there is room, of which it returns the number.
  size_t Restore(std::span<KeptSurfaceCell> cells);
  // Ends a frame, or another request: what it has used is booked where that is needed. May leave
  // that to the next one's end while somebody else lets the trees grow, unless it is recorded.
  void EndFrame(const FrameMark& mark);
  // As BlockLedger::SetPolicy.
  void SetPolicy(std::string_view name);
  Evicted evicted() const { return evicted_.now(); }
  // Bytes beside the trees: of what eviction needs to know.
  uint64_t LedgerBytes() const { return costs_.ByteSize() + ledger_bytes_; }

  void SetMemoryBytes(uint64_t memory_bytes);
  uint64_t ByteSize() const { return store_.byte_size(); }
  uint64_t CountBytes() const;
  uint64_t CellCount() const { return store_.cell_count(); }
  AheadCounts ahead() const { return ahead_.now(); }
  uint64_t TreeCount() const;
  std::vector<TreeSize> TreeSizes() const;  // by object
  void Clear();

 private:
  struct Work;

  // Whether a cell with so many points is to be divided, as far as the cache's least number goes.
  bool HasEnough(double points, const CellLights& lights) const {
    return points >= min_uses_ && lights.WantsSmaller() && points >= min_uses_ * lights.Patience();
  }
  // Whether smaller cells are worth their cost, with what is known of this one.
  bool ShouldDivide(const Work& work, const CellLights& lights, const Thrift& thrift) const;
  std::vector<Work> CollectUsed(double weight, const Thrift& thrift, uint64_t& unkept);
  // Keeps those of the works that most points ask for and that there is room for: what is certified
  // without room to keep it is work for nobody.
  void KeepWhatFits(std::vector<Work>& works, uint64_t& unkept) const;
  // What is left of the trees' budget, and what a cell takes, as far as is known.
  uint64_t Room() const;
  uint64_t BytesPerCell() const;
  // What most points ask for first.
  static void SortByPoints(std::vector<Work>& works);
  // Drops works that cost more than `left`, which is reduced by what the others do.
  static void Trim(std::vector<Work>& works, const Thrift& thrift, double& left);
  // Says which of the works may be divided, for what is left.
  static void AllowDivisions(std::vector<Work>& works, const Thrift& thrift, double left);
  // Certifies what the works ask for.
  void Certify(std::vector<Work>& works, const ParallelLoop& loop, const Thrift& thrift) const;
  // Puts that into the trees, which it counts; the children's works come back.
  std::vector<Work> Publish(std::vector<Work> works, const Thrift& thrift, uint64_t& certified);
  // What trees may take; the rest is the ledger's.
  uint64_t TreeBudget() const {
    const uint64_t all = memory_bytes_;
    return all - std::min<uint64_t>(all, ledger_bytes_);
  }
  // Down to what a pass leaves. Needs ledger_mutex_, as the next two.
  void Evict();
  // What is there has been used by no frame yet.
  void BeginAnew();
  // Says how much the ledger takes.
  void NoteLedger() { ledger_bytes_ = ledger_.ByteSize(); }

  const LightCertifier certifier_;
  const DiffuseSummer summer_;
  const double min_uses_;
  CellJournal* journal_ = nullptr;
  std::atomic<uint64_t> memory_bytes_;
  std::atomic<uint64_t> ledger_bytes_{0};
  std::atomic<uint32_t> clock_{1};
  EvictedCounter evicted_;
  TreeStore<SurfaceTree> store_;
  BuildCosts costs_;
  AheadCounters ahead_;
  // Shared by those who build; who has it alone may change trees as a whole. Taken before the next.
  mutable std::shared_mutex builders_mutex_;
  mutable std::mutex ledger_mutex_;
  // Guarded by ledger_mutex_:
  BlockLedger<SurfaceTree> ledger_;
  uint32_t frame_begin_ = 1;  // the clock when the last frame ended,
  uint32_t pinned_ = 1;       // and when it began
};

}  // namespace linetree
