#include "core/cache/path_cache.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "core/cache/path_forest.h"

namespace linetree {

// The samples that fall into one leaf.
struct PathCache::Group {
  PathNode* node = nullptr;
  int32_t object = 0;
  const CellPaths* parent = nullptr;
  int barren_levels = 0;  // how many cells in a row around this one have saved nothing
  std::vector<Sample> samples;
  std::unique_ptr<const CellPaths> paths{};  // the result
  float ns = 0;                              // what certifying took
};

PathCache::PathCache(const Tracer& tracer, uint64_t memory_bytes, int max_depth)
    : tracer_(tracer),
      certifier_(tracer),
      interiors_(tracer),
      max_depth_(max_depth),
      costs_(tracer.scene().objects.size()),
      memory_bytes_(memory_bytes) {
  NoteLedgers();
  const Scene& scene = tracer.scene();
  for (int i = 0; i < static_cast<int>(scene.objects.size()); ++i) {
    const Material& material = scene.MaterialOf(i);
    branches_.push_back(!IsBlack(material.reflect) || !IsBlack(material.transmit));
  }
}

PathCache::~PathCache() = default;

PathCache::Forest* PathCache::FindForest(const PathLimits& limits) const {
  for (const auto& forest : forests_) {
    if (forest->limits == limits) return forest.get();
  }
  return nullptr;
}

PathCache::Reader::Reader(const PathCache& cache, const PathLimits& limits,
                          std::vector<Sample>* samples)
    : cache_(cache), samples_(samples), lock_(cache.mutex_), now_(cache.clock_) {
  if (const Forest* forest = cache.FindForest(limits)) store_ = &forest->store;
}

PathCache::Forest& PathCache::OpenForest(const PathLimits& limits) {
  if (Forest* forest = FindForest(limits)) return *forest;
  if (forests_.size() >= kMaxPathForests) {
    const auto oldest =
        std::min_element(forests_.begin(), forests_.end(),
                         [](const auto& a, const auto& b) { return a->last_used < b->last_used; });
    const TreeStore<PathTree>& store = (*oldest)->store;
    evicted_.cells += store.evicted().cells + store.cell_count();
    evicted_.bytes += store.evicted().bytes + store.byte_size();
    forests_.erase(oldest);
  }
  const uint64_t used = UsedBytes();
  forests_.push_back(std::make_unique<Forest>(
      tracer_.scene(), limits, memory_bytes_ > used ? memory_bytes_ - used : 0, costs_));
  forests_.back()->ledger.SetPolicy(policy_name_);
  return *forests_.back();
}

// Fills in what the larger cells around a group's leaf say.
void PathCache::LookAround(Forest& forest, Group& group, const PathCoords& at) const {
  const PathTree& tree = *forest.store.Get(static_cast<size_t>(group.object));
  tree.cells().ForEachAround(at.pair, CellAt(at.coords, max_depth_), [&](const PathNode& node) {
    if (!node.payload || node.payload->steps.empty()) return;
    if (&node != group.node) group.parent = node.payload.get();
    group.barren_levels = node.payload->ListsAnything() ? 0 : group.barren_levels + 1;
  });
}

std::vector<PathCache::Group> PathCache::GroupByLeaf(Forest& forest,
                                                     std::span<const Sample> samples) const {
  struct Placed {
    PathNode* node;
    const Sample* sample;
  };
  std::vector<Placed> placed;
  placed.reserve(samples.size());
  for (const Sample& sample : samples) {
    PathTree* tree = forest.store.Get(static_cast<size_t>(sample.object));
    if (tree == nullptr) continue;
    const CellId deepest = CellAt(sample.at.coords, max_depth_);
    placed.push_back({&tree->cells().Leaf(sample.at.pair, deepest), &sample});
  }
  // By what the cells are, not by where they lie in memory: what a tight budget keeps must not
  // depend on that.
  const auto key = [](const Placed& p) {
    return std::tuple(p.sample->object, p.node->root, p.node->cell);
  };
  std::sort(placed.begin(), placed.end(),
            [&](const Placed& a, const Placed& b) { return key(a) < key(b); });
  std::vector<Group> groups;
  for (const Placed& p : placed) {
    if (groups.empty() || groups.back().node != p.node) {
      groups.emplace_back();
      groups.back().node = p.node;
      groups.back().object = p.sample->object;
      LookAround(forest, groups.back(), p.sample->at);
    }
    groups.back().samples.push_back(*p.sample);
  }
  return groups;
}

std::vector<PathCache::Group*> PathCache::ChooseNew(std::vector<Group>& groups, size_t allowance) {
  std::vector<Group*> chosen;
  for (Group& group : groups) {
    if (!group.node->payload && group.node->uses >= kMinPathUses) chosen.push_back(&group);
  }
  // Groups come in the order of their cells, so that ties don't depend on memory either.
  std::stable_sort(chosen.begin(), chosen.end(),
                   [](const Group* a, const Group* b) { return a->node->uses > b->node->uses; });
  chosen.resize(std::min(chosen.size(), allowance));
  return chosen;
}

std::vector<PathCache::Sample> PathCache::Descend(Forest& forest, std::vector<Group> groups,
                                                  double weight, const ParallelLoop& loop,
                                                  size_t& allowance, uint64_t& certified) {
  for (const Group& group : groups) {
    group.node->uses += static_cast<uint32_t>(static_cast<double>(group.samples.size()) * weight);
  }
  const std::vector<Group*> chosen = ChooseNew(groups, allowance);
  allowance -= chosen.size();
  loop(chosen.size(), [&](size_t i) {
    Group& group = *chosen[i];
    const BuildTimer timer(group.ns);
    const ObjectChart& chart = forest.store.Get(static_cast<size_t>(group.object))->chart();
    group.paths = std::make_unique<const CellPaths>(
        certifier_.Certify(group.object, chart, group.node->root, BoxOf(group.node->cell),
                           forest.limits, group.parent));
  });
  std::vector<Sample> next;
  std::vector<const Group*> published;
  std::unique_lock lock(mutex_);
  const uint64_t budget = BudgetOf(forest);
  for (Group& group : groups) {
    PathNode& node = *group.node;
    if (group.paths) costs_.Add(static_cast<size_t>(group.object), group.ns);
    if (node.ahead && !refines_ahead_) {
      node.ahead = false;
      ++ahead_.used;
    }
    if (group.paths && forest.store.Publish(node, std::move(group.paths), budget)) {
      ++certified;
      node.ahead = refines_ahead_;
      ahead_.built += refines_ahead_ ? 1 : 0;
      if (journal_ != nullptr) published.push_back(&group);
    }
    if (!node.payload || node.payload->IsDecided() || node.cell.depth >= max_depth_) continue;
    // Where dividing has not helped so far, more rays must ask for it.
    if (node.uses < uint64_t{kMinPathDivision} << std::min(group.barren_levels, 8)) continue;
    if (!forest.store.Divide(node, clock_, budget)) continue;
    next.insert(next.end(), group.samples.begin(), group.samples.end());
  }
  lock.unlock();
  // Nothing is evicted meanwhile: only who refines does that.
  for (const Group* group : published) {
    const PathNode& node = *group->node;
    journal_->Write(forest.limits, {group->object, node.root, node.cell}, *node.payload);
  }
  return next;
}

size_t PathCache::Restore(const PathLimits& limits, std::span<KeptPathCell> cells) {
  std::lock_guard refining(refine_mutex_);
  std::unique_lock lock(mutex_);
  if (FindForest(limits) == nullptr && forests_.size() >= kMaxPathForests) return 0;
  Forest& forest = OpenForest(limits);
  const uint64_t others = UsedBytes() - forest.store.byte_size();
  const uint64_t target = EvictionTarget(memory_bytes_);
  size_t restored = 0;
  for (auto& [place, paths] : cells) {
    if (place.cell.depth > max_depth_) continue;
    if (!forest.store.Restore(static_cast<size_t>(place.object), place.pair, place.cell,
                              std::move(paths), clock_, target > others ? target - others : 0))
      break;
    ++restored;
  }
  BeginAnew();
  return restored;
}

void PathCache::BeginAnew() { pinned_ = frame_begin_ = ++clock_; }

void PathCache::NoteLedgers() {
  uint64_t bytes = costs_.ByteSize();
  for (const auto& forest : forests_) bytes += forest->ledger.ByteSize();
  ledger_bytes_ = bytes;
}

uint64_t PathCache::Refine(const PathLimits& limits, std::span<const Sample> samples, double weight,
                           const ParallelLoop& loop, bool ahead) {
  std::lock_guard refining(refine_mutex_);
  refines_ahead_ = ahead;
  uint64_t certified = 0;
  Forest* forest = nullptr;
  std::vector<Group> groups;
  {
    std::unique_lock lock(mutex_);
    ++clock_;
    if (memory_bytes_ == 0) return 0;
    forest = &OpenForest(limits);
    forest->last_used = clock_;
    forest->store.PlantWanted(BudgetOf(*forest), [](size_t) { return true; });
    groups = GroupByLeaf(*forest, samples);
  }
  const double rays = static_cast<double>(samples.size()) * weight;
  size_t allowance = std::max(kMinNewCells, static_cast<size_t>(rays / kRaysPerNewCell));
  while (!groups.empty()) {
    const std::vector<Sample> next =
        Descend(*forest, std::move(groups), weight, loop, allowance, certified);
    groups = GroupByLeaf(*forest, next);
  }
  Evict();
  return certified;
}

uint64_t PathCache::UsedBytes() const {
  uint64_t bytes = 0;
  for (const auto& forest : forests_) {
    bytes += forest->store.byte_size() + forest->ledger.ByteSize();
  }
  return bytes;
}

uint64_t PathCache::BudgetOf(const Forest& forest) const {
  const uint64_t others = UsedBytes() - forest.store.byte_size();
  return memory_bytes_ > others ? memory_bytes_ - others : 0;
}

// From the forests that were used longest ago on.
void PathCache::Evict() {
  std::vector<Forest*> order;
  for (const auto& forest : forests_) order.push_back(forest.get());
  std::sort(order.begin(), order.end(),
            [](const Forest* a, const Forest* b) { return a->last_used < b->last_used; });
  const uint64_t target = EvictionTarget(memory_bytes_);
  for (Forest* forest : order) {
    const uint64_t used = UsedBytes();
    if (used <= target) break;
    const uint64_t excess = used - target;
    const uint64_t held = forest->store.byte_size() + forest->ledger.ByteSize();
    forest->ledger.Evict(forest->store, held > excess ? held - excess : 0, pinned_, mutex_);
  }
  NoteLedgers();
}

void PathCache::EndFrame(const FrameMark& mark) {
  std::unique_lock refining(refine_mutex_, std::defer_lock);
  if (mark.recorder != nullptr) {
    refining.lock();
  } else if (!refining.try_lock()) {
    return;
  }
  const uint64_t target = EvictionTarget(memory_bytes_);
  for (const auto& forest : forests_) {
    const uint64_t own = forest->store.byte_size() + forest->ledger.ByteSize();
    const uint64_t others = UsedBytes() - own;
    forest->ledger.EndFrame(forest->store, frame_begin_, target > others ? target - others : 0,
                            mark);
  }
  pinned_ = frame_begin_;
  frame_begin_ = ++clock_;
  Evict();  // ledgers may have grown
}

void PathCache::SetPolicy(std::string_view name) {
  std::lock_guard refining(refine_mutex_);
  policy_name_ = std::string(name);
  for (const auto& forest : forests_) forest->ledger.SetPolicy(name);
  NoteLedgers();
}

Evicted PathCache::evicted() const {
  std::shared_lock lock(mutex_);
  Evicted all = evicted_;
  for (const auto& forest : forests_) {
    all.cells += forest->store.evicted().cells;
    all.bytes += forest->store.evicted().bytes;
  }
  return all;
}

Adopted PathCache::Adopt(PathCache& former, const ChangeReach& reach) {
  const SceneChange& change = reach.change();
  std::scoped_lock refining(refine_mutex_, former.refine_mutex_);
  Adopted adopted;
  {
    std::scoped_lock lock(mutex_, former.mutex_);
    former.memory_bytes_ = 0;
    clock_ = former.clock_.load();
    for (const auto& forest : former.forests_) {
      const uint64_t before = forest->store.cell_count();
      Forest& own = OpenForest(forest->limits);
      own.last_used = forest->last_used;
      own.store.Adopt(forest->store, change, BudgetOf(own), [&](PathTree& tree) {
        return tree.cells().Prune(/*covers=*/false,
                                  [&](const PathNode& node) { return reach.Touches(tree, node); });
      });
      own.ledger.Reset();
      adopted.dropped += before;
    }
    former.forests_.clear();
  }
  BeginAnew();
  Evict();
  adopted.kept = CellCount();
  adopted.dropped -= adopted.kept;
  return adopted;
}

void PathCache::SetMemoryBytes(uint64_t memory_bytes) {
  std::lock_guard refining(refine_mutex_);
  {
    std::unique_lock lock(mutex_);
    memory_bytes_ = memory_bytes;
  }
  for (const auto& forest : forests_) forest->ledger.Reset();  // they know another budget
  Evict();
}

uint64_t PathCache::ByteSize() const {
  std::shared_lock lock(mutex_);
  uint64_t bytes = 0;
  for (const auto& forest : forests_) bytes += forest->store.byte_size();
  return bytes;
}

uint64_t PathCache::CountBytes() const {
  std::shared_lock lock(mutex_);
  uint64_t bytes = 0;
  for (const auto& forest : forests_) bytes += forest->store.CountBytes();
  return bytes;
}

uint64_t PathCache::CellCount() const {
  std::shared_lock lock(mutex_);
  uint64_t cells = 0;
  for (const auto& forest : forests_) cells += forest->store.cell_count();
  return cells;
}

AheadCounts PathCache::ahead() const {
  std::shared_lock lock(mutex_);
  return ahead_;
}

std::vector<std::array<uint64_t, kVerdictCount>> PathCache::CellVerdicts() const {
  std::shared_lock lock(mutex_);
  std::vector<std::array<uint64_t, kVerdictCount>> verdicts(branches_.size());
  for (const auto& forest : forests_) {
    forest->store.ForEachTree([&](size_t object, PathTree& tree) {
      tree.cells().ForEach([&](PathNode& node) {
        if (node.payload) ++verdicts[object][static_cast<size_t>(node.payload->verdict)];
      });
    });
  }
  return verdicts;
}

void PathCache::Clear() {
  std::lock_guard refining(refine_mutex_);
  std::unique_lock lock(mutex_);
  forests_.clear();
}

}  // namespace linetree
