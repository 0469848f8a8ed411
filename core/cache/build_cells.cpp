// Building cells: trace the extremal rays that are missing, judge, publish.
#include <algorithm>
#include <mutex>

#include "core/cache/forest.h"
#include "core/cache/radiance_cache.h"
#include "core/math/check.h"

namespace linetree {
namespace {

// Corners are traced in stages, and a cell that two corners already refute is not traced further:
// opposite corners first, because they differ most.
constexpr std::array<int, 2> kFirstStage = {0, 15};
constexpr std::array<int, 2> kSecondStage = {5, 10};
constexpr std::array<int, 12> kThirdStage = {3, 12, 6, 9, 1, 2, 4, 8, 7, 11, 13, 14};

// What a new cell may add: its block, its interpolant.
constexpr uint64_t kCellBytes = sizeof(CellBlock) + sizeof(Interpolant);

}  // namespace

// One cell on its way.
struct RadianceCache::Work {
  CellRef ref;
  Corners corners;
  Judgement judgement;  // kUntried while the cell is not refuted

  bool IsOpen() const { return judgement.verdict == Verdict::kUntried; }
  bool Has(std::span<const int> some) const {
    return std::all_of(some.begin(), some.end(),
                       [&](int corner) { return corners[static_cast<size_t>(corner)] != nullptr; });
  }
  SampleKey KeyOf(int corner, uint32_t forest) const {
    return {GridKey(ref.cell.Corner(corner)), ref.object, ref.pair, forest};
  }
};

// Fills the corners that the store has; returns the keys of the others, each once, in order.
std::vector<SampleKey> RadianceCache::CollectMissing(const Session& session,
                                                     std::vector<Work>& works,
                                                     std::span<const int> corners) const {
  std::vector<SampleKey> missing;
  absl::flat_hash_map<SampleKey, bool> seen;
  const std::lock_guard lock(samples_mutex_);
  for (Work& work : works) {
    if (!work.IsOpen()) continue;
    for (const int corner : corners) {
      const SampleKey key = work.KeyOf(corner, session.forest);
      auto& sample = work.corners[static_cast<size_t>(corner)];
      sample = samples_.Get(key);
      if (!sample && seen.try_emplace(key, true).second) missing.push_back(key);
    }
  }
  return missing;
}

void RadianceCache::TraceMissing(const Session& session, const std::vector<SampleKey>& keys,
                                 const ParallelLoop& loop, std::vector<Work>& works,
                                 std::span<const int> corners, BuildStats& stats) {
  std::vector<SampleStore::Sample> samples(keys.size());
  std::vector<RayCounts> counts(keys.size());
  loop(keys.size(), [&](size_t i) {
    const SampleKey& key = keys[i];
    GridPoint p;
    for (size_t k = 0; k < 4; ++k) p[k] = static_cast<uint16_t>(key.grid >> (16 * k));
    samples[i] = std::make_shared<const CornerSample>(
        TraceCorner(tracer_, key.object, charts_[static_cast<size_t>(key.object)], key.pair,
                    CoordsOfGrid(p), session.limits, counts[i]));
  });
  absl::flat_hash_map<SampleKey, const SampleStore::Sample*> by_key;
  by_key.reserve(keys.size());
  for (size_t i = 0; i < keys.size(); ++i) {
    by_key.emplace(keys[i], &samples[i]);
    stats.counts += counts[i];
  }
  for (Work& work : works) {
    if (!work.IsOpen()) continue;
    for (const int corner : corners) {
      auto& sample = work.corners[static_cast<size_t>(corner)];
      if (!sample) sample = *by_key.at(work.KeyOf(corner, session.forest));
    }
  }
  const std::lock_guard lock(samples_mutex_);
  for (size_t i = 0; i < keys.size(); ++i) {
    if (samples[i]) samples_.Put(keys[i], samples[i]);
  }
}

BuildStats RadianceCache::Build(const Session& session, std::span<const CellRef> cells,
                                const ParallelLoop& loop) {
  BuildStats stats;
  std::vector<Work> works(cells.size());
  for (size_t i = 0; i < cells.size(); ++i) works[i].ref = cells[i];
  const std::array<std::span<const int>, 3> stages = {kFirstStage, kSecondStage, kThirdStage};
  for (const auto& stage : stages) {
    const auto missing = CollectMissing(session, works, stage);
    TraceMissing(session, missing, loop, works, stage, stats);
    // Where the loop was cut short, corners are missing.
    std::erase_if(works, [&](const Work& work) { return work.IsOpen() && !work.Has(stage); });
    for (Work& work : works) {
      for (const int corner : stage) {
        if (!work.IsOpen()) break;
        const Verdict v =
            judge_.Compare(*work.corners[0], *work.corners[static_cast<size_t>(corner)]);
        if (v != Verdict::kCertified) work.judgement.verdict = v;
      }
    }
  }
  loop(works.size(), [&](size_t i) {
    if (works[i].IsOpen()) works[i].judgement = judge_.Decide(works[i].corners);
  });
  std::erase_if(works, [](const Work& work) { return work.IsOpen(); });
  PublishWorks(session, works, stats);
  return stats;
}

RadianceCache::ObjectTrees& RadianceCache::Grow(Forest& forest, int32_t object) {
  if (!forest.trees) {
    auto table = std::make_unique<Forest::Trees>(forest.objects);
    forest.trees.PutFirst(table);
  }
  auto& slot = (*forest.trees)[static_cast<size_t>(object)];
  if (!slot) {
    auto trees = std::make_unique<ObjectTrees>(pools_);
    if (slot.PutFirst(trees)) ++forest.grown;
  }
  return *slot;
}

bool RadianceCache::PublishOne(Forest& forest, const Work& work, uint32_t now) {
  const uint64_t needed = kCellBytes + forest.GrowthBytes();
  // What others are about to take is promised until it counts as held, so that all together keep
  // to the budget.
  const uint64_t promised = promised_ += needed;
  const bool has_room = CellBytes() + promised <= cell_budget_;
  if (has_room) {
    auto& trees = Grow(forest, work.ref.object).pair;
    trees[static_cast<size_t>(work.ref.pair)].Publish(work.ref.cell, work.judgement, now);
  }
  promised_ -= needed;
  return has_room;
}

bool RadianceCache::MakeRoomAndPublish(const Session& session, const Work& work,
                                       BuildStats& stats) {
  const std::lock_guard alone(trees_mutex_);
  Forest* forest = FindForest(session.forest);
  if (forest == nullptr) return false;
  // Somebody else may have made room meanwhile.
  if (PublishOne(*forest, work, session.now)) return true;
  stats.cells_evicted += MakeRoom(kCellBytes + forest->GrowthBytes(), session.now);
  return PublishOne(*forest, work, session.now);
}

void RadianceCache::PublishWorks(const Session& session, const std::vector<Work>& works,
                                 BuildStats& stats) {
  {
    const std::lock_guard lock(samples_mutex_);
    samples_.EndRound();
  }
  stats.cells_tried += works.size();
  for (const Work& work : works) {
    if (work.judgement.verdict == Verdict::kCertified) ++stats.cells_accepted;
  }
  std::shared_lock publishing(trees_mutex_);
  // Null when sixteen other path limits took its place.
  Forest* forest = FindForest(session.forest);
  for (size_t i = 0; i < works.size(); ++i) {
    if (forest != nullptr && PublishOne(*forest, works[i], session.now)) continue;
    publishing.unlock();
    if (!MakeRoomAndPublish(session, works[i], stats)) {
      stats.cells_dropped += works.size() - i;
      return;
    }
    publishing.lock();
    forest = FindForest(session.forest);
  }
}

}  // namespace linetree
