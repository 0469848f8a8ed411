// The radiance cache of one scene: linetrees of all objects under one byte budget.
//
// Cells depend on where paths end, so there is one forest of linetrees for every PathLimits in use
// (at most kMaxForests; the one that was used least recently makes room). The answer to a ray never
// depends on what else the cache holds beyond the choice between interpolating and tracing.
//
// Thread safety: every method may be called from any thread. Find waits for nobody (epoch.h).
// Builders trace, judge and publish at the same time as each other, the latter by compare-and-swap
// (linetree.h); who evicts, or makes and drops forests, waits for those who publish.
#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <shared_mutex>
#include <span>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "core/cache/cache_options.h"
#include "core/cache/parallel_loop.h"
#include "core/cache/sample_store.h"
#include "core/tree/linetree.h"
#include "core/tree/owning_slot.h"
#include "core/tree/paper_judge.h"

namespace linetree {

inline constexpr size_t kMaxForests = 16;

// A ray that hits an object, in the coordinates of its linetree.
struct CellQuery {
  int32_t object = 0;
  int32_t pair = 0;
  RayCoords coords{};
};

struct CellRef {
  int32_t object = 0;
  int32_t pair = 0;
  CellId cell;
  bool operator==(const CellRef&) const = default;
  auto operator<=>(const CellRef&) const = default;
  template <class H>
  friend H AbslHashValue(H h, const CellRef& r) {
    return H::combine(std::move(h), r.object, r.pair, r.cell.depth, r.cell.index);
  }
};

struct CellAnswer {
  Lookup::Kind kind = Lookup::Kind::kGiveUp;
  Verdict verdict = Verdict::kUntried;  // of the last tried cell on the way
  Rgb radiance;                         // kAnswer
  CellId cell;                          // kUnbuilt: the one to build
};

struct BuildStats {
  RayCounts counts;
  uint64_t cells_tried = 0;
  uint64_t cells_accepted = 0;  // certified for some epsilon
  uint64_t cells_evicted = 0;
  uint64_t cells_dropped = 0;  // judged, but there was no room to keep them
};

class RadianceCache {
 public:
  // Keeps a reference to the tracer, which must outlive the cache.
  RadianceCache(const Tracer& tracer, const CacheOptions& options);
  ~RadianceCache();
  RadianceCache(const RadianceCache&) = delete;
  RadianceCache& operator=(const RadianceCache&) = delete;

  const CacheOptions& options() const { return options_; }

  // What requests with one PathLimits share. `now` orders uses: one tick per batch.
  struct Session {
    uint32_t forest = 0;
    uint32_t now = 0;
    PathLimits limits;
  };
  Session Open(const PathLimits& limits);

  // The query of a ray with this hit, or none where no linetree can answer: the object's radiance
  // is cheaper to compute than to look up, the hit is not the first on its line, or the line has no
  // coordinates.
  std::optional<CellQuery> QueryFor(const Hit& hit, const Ray& ray) const;

  // Looks the queries up at epsilon. answers.size() == queries.size().
  void Find(const Session& session, double epsilon, std::span<const CellQuery> queries,
            std::span<CellAnswer> answers) const;

  // Traces, judges and publishes cells, each of which must have been kUnbuilt; `cells` are
  // distinct. What does not fit into the budget beside cells in use by this session is dropped.
  // The loop may leave bodies out when it is cancelled: cells that miss one are not built.
  BuildStats Build(const Session& session, std::span<const CellRef> cells,
                   const ParallelLoop& loop);

  // Another budget than options().memory_bytes; what exceeds it is evicted now. For those who share
  // one budget between several caches.
  void SetMemoryBytes(uint64_t memory_bytes);

  // Exact bytes held; CountBytes recomputes them from scratch.
  uint64_t ByteSize() const;
  uint64_t CountBytes() const;
  uint64_t CellCount() const;
  // Tried cells by verdict, for every object of the scene.
  std::vector<std::array<uint64_t, kVerdictCount>> CellVerdicts() const;
  // Forgets everything.
  void Clear();

 private:
  struct ObjectTrees;
  struct Forest;
  struct Work;
  struct Victim;

  // Within a guard, or with the trees' lock, shared or not.
  Forest* FindForest(uint32_t id) const;
  // visit(Forest&); as FindForest.
  template <class Fn>
  void ForEachForest(Fn&& visit) const {
    for (const auto& slot : forests_) {
      if (Forest* forest = slot.get()) visit(*forest);
    }
  }
  uint32_t NextTick();
  // The forest that has these limits; null where there is none. With the trees' lock, shared or
  // not.
  Forest* ForestOf(const PathLimits& limits) const;
  // Takes a forest out when nobody reads it any more. Needs the trees' lock.
  void Drop(OwningSlot<Forest>& slot);
  // Bytes of forests and cells, without samples. As FindForest.
  uint64_t CellBytes() const;
  std::vector<SampleKey> CollectMissing(const Session& session, std::vector<Work>& works,
                                        std::span<const int> corners) const;
  void TraceMissing(const Session& session, const std::vector<SampleKey>& keys,
                    const ParallelLoop& loop, std::vector<Work>& works,
                    std::span<const int> corners, BuildStats& stats);
  // The object's trees, made where there are none. With the trees' lock, shared or not.
  ObjectTrees& Grow(Forest& forest, int32_t object);
  void PublishWorks(const Session& session, const std::vector<Work>& works, BuildStats& stats);
  // False, and nothing done, where the budget has no room. With the trees' lock, shared or not.
  bool PublishOne(Forest& forest, const Work& work, uint32_t now);
  // The same where others have to go; false where the forest is gone, too.
  bool MakeRoomAndPublish(const Session& session, const Work& work, BuildStats& stats);
  // Frees cells not used by this session, least recently used leaves first, until `needed` more
  // bytes fit. Returns how many it evicted. Needs the trees' lock.
  uint64_t MakeRoom(uint64_t needed, uint32_t now);
  // Those that this session does not use, in the order in which they go.
  std::vector<Victim> Leaves(uint32_t now) const;
  // Of objects that have no cells any more.
  void TakeBareTrees(std::vector<std::unique_ptr<ObjectTrees>>& bare);

  const Tracer& tracer_;
  const CacheOptions options_;
  PaperJudge judge_;
  std::vector<ObjectChart> charts_;  // by object
  std::vector<bool> caches_;         // by object: whether looking up can pay

  // Shared by those who publish cells; who has it alone may take cells and forests away. Taken
  // before the next.
  mutable std::shared_mutex trees_mutex_;
  mutable std::mutex samples_mutex_;
  // Guarded by trees_mutex_, but for Find:
  CellPools pools_;
  std::array<OwningSlot<Forest>, kMaxForests> forests_;
  // Guarded by trees_mutex_:
  uint64_t cell_budget_;  // what the samples' share leaves
  uint32_t next_forest_ = 1;
  std::atomic<uint64_t> promised_{0};  // bytes that those who publish are about to take
  std::atomic<uint32_t> clock_{0};
  SampleStore samples_;  // guarded by samples_mutex_
};

}  // namespace linetree
