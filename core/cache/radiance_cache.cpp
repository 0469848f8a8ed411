#include "core/cache/radiance_cache.h"

#include <algorithm>
#include <mutex>

#include "core/cache/epoch.h"
#include "core/cache/forest.h"
#include "core/math/check.h"

namespace linetree {
namespace {

// A surface whose radiance is the same constant for all rays costs nothing to shade.
bool VariesAtAll(const Scene& scene, const Material& material) {
  const bool lit =
      !scene.lights.empty() && !(IsBlack(material.diffuse) && IsBlack(material.specular));
  return lit || !IsBlack(material.reflect) || !IsBlack(material.transmit);
}

uint64_t SampleBudget(uint64_t memory_bytes) {
  return static_cast<uint64_t>(kSampleShare * static_cast<double>(memory_bytes));
}

}  // namespace

RadianceCache::RadianceCache(const Tracer& tracer, const CacheOptions& options)
    : tracer_(tracer),
      options_(options),
      judge_(tracer),
      cell_budget_(options.memory_bytes - SampleBudget(options.memory_bytes)),
      samples_(SampleBudget(options.memory_bytes)) {
  const Scene& scene = tracer.scene();
  charts_.reserve(scene.objects.size());
  caches_.reserve(scene.objects.size());
  for (int i = 0; i < static_cast<int>(scene.objects.size()); ++i) {
    charts_.emplace_back(scene.objects[static_cast<size_t>(i)]);
    caches_.push_back(options.memory_bytes > 0 && VariesAtAll(scene, scene.MaterialOf(i)));
  }
}

RadianceCache::~RadianceCache() = default;

uint32_t RadianceCache::NextTick() { return (++clock_) & kStampMask; }

RadianceCache::Forest* RadianceCache::ForestOf(const PathLimits& limits) const {
  Forest* found = nullptr;
  ForEachForest([&](Forest& forest) { found = forest.limits == limits ? &forest : found; });
  return found;
}

RadianceCache::Session RadianceCache::Open(const PathLimits& limits) {
  const uint32_t now = NextTick();
  {
    const std::shared_lock publishing(trees_mutex_);
    if (Forest* forest = ForestOf(limits)) {
      forest->last_used = now;
      return {forest->id, now, limits};
    }
  }
  const std::lock_guard alone(trees_mutex_);
  Forest* made = ForestOf(limits);  // by somebody else meanwhile
  if (made == nullptr) {
    auto* place = &forests_[0];
    for (auto& slot : forests_) {
      if (*place && (!slot || slot->last_used < (*place)->last_used)) place = &slot;
    }
    Drop(*place);
    auto forest = std::make_unique<Forest>();
    forest->id = next_forest_++;
    forest->limits = limits;
    forest->objects = charts_.size();
    made = forest.get();
    LT_CHECK(place->PutFirst(forest));
  }
  made->last_used = now;
  return {made->id, now, limits};
}

void RadianceCache::Drop(OwningSlot<Forest>& slot) {
  const std::unique_ptr<Forest> forest = slot.Take();
  if (!forest) return;
  AwaitReaders();
  forest->ForEach([](int32_t, ObjectTrees& trees) {
    for (Linetree& tree : trees.pair) tree.Clear();
  });
  const std::lock_guard lock(samples_mutex_);
  samples_.DropForest(forest->id);
}

RadianceCache::Forest* RadianceCache::FindForest(uint32_t id) const {
  Forest* found = nullptr;
  ForEachForest([&](Forest& forest) { found = forest.id == id ? &forest : found; });
  return found;
}

std::optional<CellQuery> RadianceCache::QueryFor(const Hit& hit, const Ray& ray) const {
  const auto object = static_cast<size_t>(hit.object);
  if (!hit.IsHit() || !hit.first_on_line || !caches_[object]) return std::nullopt;
  CellQuery query;
  query.object = hit.object;
  query.pair = charts_[object].PairOf(ray.direction);
  // Measured from the hit: far eyes would otherwise cost the coordinates their last digits.
  const auto coords = charts_[object].CoordsOf(query.pair, hit.point, ray.direction);
  if (!coords) return std::nullopt;
  query.coords = *coords;
  return query;
}

void RadianceCache::Find(const Session& session, double epsilon, std::span<const CellQuery> queries,
                         std::span<CellAnswer> answers) const {
  const EpochGuard reading;
  const Forest* forest = FindForest(session.forest);
  for (size_t i = 0; i < queries.size(); ++i) {
    const CellQuery& query = queries[i];
    CellAnswer& answer = answers[i];
    answer = {};
    if (forest == nullptr) continue;
    const ObjectTrees* trees = forest->Find(query.object);
    if (trees == nullptr) {
      answer.kind = Lookup::Kind::kUnbuilt;
      continue;
    }
    const Linetree& tree = trees->pair[static_cast<size_t>(query.pair)];
    const Lookup found = tree.Find(query.coords, epsilon, options_.max_cell_depth, session.now);
    answer.kind = found.kind;
    answer.verdict = found.verdict;
    answer.cell = found.cell;
    if (found.kind == Lookup::Kind::kAnswer) {
      answer.radiance = Evaluate(*found.interpolant, LocalCoords(found.cell, query.coords));
    }
  }
}

void RadianceCache::SetMemoryBytes(uint64_t memory_bytes) {
  const std::lock_guard alone(trees_mutex_);
  cell_budget_ = memory_bytes - SampleBudget(memory_bytes);
  {
    const std::lock_guard lock(samples_mutex_);
    samples_.SetLimit(SampleBudget(memory_bytes));
  }
  // A tick of its own: no session's cells are exempt.
  if (CellBytes() > cell_budget_) MakeRoom(0, NextTick());
}

uint64_t RadianceCache::CellBytes() const {
  uint64_t bytes = pools_.ByteSize();
  ForEachForest([&](const Forest& forest) { bytes += forest.ByteSize(); });
  return bytes;
}

uint64_t RadianceCache::ByteSize() const {
  const EpochGuard reading;
  const std::lock_guard lock(samples_mutex_);
  return CellBytes() + samples_.ByteSize();
}

uint64_t RadianceCache::CountBytes() const {
  const std::lock_guard alone(trees_mutex_);
  const std::lock_guard lock(samples_mutex_);
  uint64_t bytes = samples_.CountBytes();
  ForEachForest([&](const Forest& forest) {
    bytes += forest.ByteSize();
    forest.ForEach([&](int32_t, const ObjectTrees& trees) {
      for (const Linetree& tree : trees.pair) bytes += tree.CountBytes();
    });
  });
  return bytes;
}

uint64_t RadianceCache::CellCount() const {
  const EpochGuard reading;
  uint64_t cells = 0;
  ForEachForest([&](const Forest& forest) {
    forest.ForEach([&](int32_t, const ObjectTrees& trees) {
      for (const Linetree& tree : trees.pair) cells += tree.cell_count();
    });
  });
  return cells;
}

std::vector<std::array<uint64_t, kVerdictCount>> RadianceCache::CellVerdicts() const {
  const EpochGuard reading;
  std::vector<std::array<uint64_t, kVerdictCount>> verdicts(charts_.size());
  ForEachForest([&](const Forest& forest) {
    forest.ForEach([&](int32_t object, const ObjectTrees& trees) {
      for (const Linetree& tree : trees.pair) {
        const auto of_tree = tree.verdicts();
        for (size_t v = 0; v < kVerdictCount; ++v) {
          verdicts[static_cast<size_t>(object)][v] += of_tree[v];
        }
      }
    });
  });
  return verdicts;
}

void RadianceCache::Clear() {
  const std::lock_guard alone(trees_mutex_);
  for (auto& slot : forests_) Drop(slot);
  const std::lock_guard lock(samples_mutex_);
  samples_.Clear();
}

}  // namespace linetree
