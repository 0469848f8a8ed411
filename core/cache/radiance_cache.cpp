#include "core/cache/radiance_cache.h"

#include <algorithm>
#include <mutex>

#include "core/cache/forest.h"

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

RadianceCache::Session RadianceCache::Open(const PathLimits& limits) {
  std::unique_lock lock(mutex_);
  clock_ = (clock_ + 1) & kStampMask;
  for (const auto& forest : forests_) {
    if (!(forest->limits == limits)) continue;
    forest->last_used = clock_;
    return {forest->id, clock_, limits};
  }
  if (forests_.size() >= kMaxForests) {
    const auto oldest =
        std::min_element(forests_.begin(), forests_.end(),
                         [](const auto& a, const auto& b) { return a->last_used < b->last_used; });
    for (auto& [object, trees] : (*oldest)->objects) {
      for (Linetree& tree : trees->pair) tree.Clear();
    }
    samples_.DropForest((*oldest)->id);
    forests_.erase(oldest);
  }
  auto forest = std::make_unique<Forest>();
  forest->id = next_forest_++;
  forest->last_used = clock_;
  forest->limits = limits;
  forests_.push_back(std::move(forest));
  return {forests_.back()->id, clock_, limits};
}

RadianceCache::Forest* RadianceCache::FindForest(uint32_t id) const {
  for (const auto& forest : forests_) {
    if (forest->id == id) return forest.get();
  }
  return nullptr;
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
  std::shared_lock lock(mutex_);
  const Forest* forest = FindForest(session.forest);
  for (size_t i = 0; i < queries.size(); ++i) {
    const CellQuery& query = queries[i];
    CellAnswer& answer = answers[i];
    answer = {};
    if (forest == nullptr) continue;
    const Linetree* tree = forest->Find(query.object, query.pair);
    if (tree == nullptr) {
      answer.kind = Lookup::Kind::kUnbuilt;
      continue;
    }
    const Lookup found = tree->Find(query.coords, epsilon, options_.max_cell_depth, session.now);
    answer.kind = found.kind;
    answer.verdict = found.verdict;
    answer.cell = found.cell;
    if (found.kind == Lookup::Kind::kAnswer) {
      answer.radiance = Evaluate(*found.interpolant, LocalCoords(found.cell, query.coords));
    }
  }
}

void RadianceCache::SetMemoryBytes(uint64_t memory_bytes) {
  std::unique_lock lock(mutex_);
  cell_budget_ = memory_bytes - SampleBudget(memory_bytes);
  samples_.SetLimit(SampleBudget(memory_bytes));
  // A tick of its own: no session's cells are exempt.
  clock_ = (clock_ + 1) & kStampMask;
  if (CellBytes() > cell_budget_) MakeRoom(0, clock_);
}

uint64_t RadianceCache::CellBytes() const {
  uint64_t bytes = pools_.ByteSize();
  for (const auto& forest : forests_) bytes += forest->ByteSize();
  return bytes;
}

uint64_t RadianceCache::ByteSize() const {
  std::shared_lock lock(mutex_);
  return CellBytes() + samples_.ByteSize();
}

uint64_t RadianceCache::CountBytes() const {
  std::shared_lock lock(mutex_);
  uint64_t bytes = samples_.CountBytes();
  for (const auto& forest : forests_) {
    bytes += forest->ByteSize();
    for (const auto& [object, trees] : forest->objects) {
      for (const Linetree& tree : trees->pair) bytes += tree.CountBytes();
    }
  }
  return bytes;
}

uint64_t RadianceCache::CellCount() const {
  std::shared_lock lock(mutex_);
  uint64_t cells = 0;
  for (const auto& forest : forests_) {
    for (const auto& [object, trees] : forest->objects) {
      for (const Linetree& tree : trees->pair) cells += tree.cell_count();
    }
  }
  return cells;
}

std::vector<std::array<uint64_t, kVerdictCount>> RadianceCache::CellVerdicts() const {
  std::shared_lock lock(mutex_);
  std::vector<std::array<uint64_t, kVerdictCount>> verdicts(charts_.size());
  for (const auto& forest : forests_) {
    for (const auto& [object, trees] : forest->objects) {
      for (const Linetree& tree : trees->pair) {
        for (size_t v = 0; v < kVerdictCount; ++v) {
          verdicts[static_cast<size_t>(object)][v] += tree.verdicts()[v];
        }
      }
    }
  }
  return verdicts;
}

void RadianceCache::Clear() {
  std::unique_lock lock(mutex_);
  for (const auto& forest : forests_) {
    for (auto& [object, trees] : forest->objects) {
      for (Linetree& tree : trees->pair) tree.Clear();
    }
  }
  forests_.clear();
  samples_.Clear();
}

}  // namespace linetree
