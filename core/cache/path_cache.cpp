#include "core/cache/path_cache.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <tuple>
#include <utility>

#include "core/cache/owned_node.h"
#include "core/cache/path_forest.h"
#include "core/math/check.h"

namespace linetree {

// The samples that fall into one leaf, which the group owns.
struct PathCache::Group {
  OwnedNode<PathNode> node;
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
      memory_bytes_(memory_bytes),
      costs_(tracer.scene().objects.size()) {
  const Scene& scene = tracer.scene();
  for (int i = 0; i < static_cast<int>(scene.objects.size()); ++i) {
    const Material& material = scene.MaterialOf(i);
    branches_.push_back(!IsBlack(material.reflect) || !IsBlack(material.transmit));
  }
}

PathCache::~PathCache() = default;

class PathCache::Builder {
 public:
  Builder(PathCache& cache, const PathLimits& limits) : cache_(cache) {
    const std::lock_guard lock(cache_.ledger_mutex_);
    forest_ = cache_.OpenForest(limits);
    if (forest_ != nullptr) ++forest_->builders;
  }
  ~Builder() {
    const std::lock_guard lock(cache_.ledger_mutex_);
    if (forest_ != nullptr) --forest_->builders;
  }
  Builder(const Builder&) = delete;
  Builder& operator=(const Builder&) = delete;

  Forest* forest() const { return forest_; }

 private:
  PathCache& cache_;
  Forest* forest_ = nullptr;
};

PathCache::Forest* PathCache::FindForest(const PathLimits& limits) const {
  Forest* found = nullptr;
  ForEachForest([&](Forest& forest) {
    if (forest.limits == limits) found = &forest;
  });
  return found;
}

PathCache::Reader::Reader(const PathCache& cache, const PathLimits& limits,
                          std::vector<Sample>* samples)
    : cache_(cache), samples_(samples), now_(cache.clock_) {
  if (const Forest* forest = cache.FindForest(limits)) store_ = &forest->store;
}

PathCache::Forest* PathCache::OpenForest(const PathLimits& limits) {
  if (Forest* forest = FindForest(limits)) return forest;
  OwningSlot<Forest>* place = nullptr;
  for (auto& slot : forests_) {
    if (!slot) {
      place = &slot;
      break;
    }
    if (slot->builders > 0) continue;
    if (place == nullptr || slot->last_used < (*place)->last_used) place = &slot;
  }
  if (place == nullptr) return nullptr;
  if (const std::unique_ptr<Forest> oldest = place->Take()) {
    AwaitReaders();
    const TreeStore<PathTree>& store = oldest->store;
    evicted_.Add({store.cell_count(), store.byte_size()});
  }
  const uint64_t all = memory_bytes_, used = UsedBytes();
  auto forest = std::make_unique<Forest>(tracer_.scene(), limits, all > used ? all - used : 0,
                                         costs_, evicted_);
  forest->ledger.SetPolicy(policy_name_);
  LT_CHECK(place->PutFirst(forest));
  return place->get();
}

// Fills in what the larger cells around a group's leaf say.
void PathCache::LookAround(Forest& forest, Group& group, const PathCoords& at) const {
  const PathTree& tree = *forest.store.Get(static_cast<size_t>(group.object));
  tree.cells().ForEachAround(at.pair, CellAt(at.coords, max_depth_), [&](const PathNode& node) {
    const CellPaths* paths = node.payload.get();
    if (paths == nullptr || paths->steps.empty()) return;
    if (&node != group.node.get()) group.parent = paths;
    group.barren_levels = paths->ListsAnything() ? 0 : group.barren_levels + 1;
  });
}

std::vector<PathCache::Group> PathCache::GroupByLeaf(Forest& forest,
                                                     std::span<const Sample> samples) const {
  const EpochGuard reading;
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
  const PathNode* last = nullptr;
  bool is_ours = false;
  for (const Placed& p : placed) {
    if (std::exchange(last, p.node) != p.node) {
      OwnedNode<PathNode> owned(*p.node);
      is_ours = static_cast<bool>(owned);
      if (!is_ours) continue;
      groups.emplace_back();
      groups.back().node = std::move(owned);
      groups.back().object = p.sample->object;
      LookAround(forest, groups.back(), p.sample->at);
    }
    if (is_ours) groups.back().samples.push_back(*p.sample);
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

void PathCache::Certify(Forest& forest, std::vector<Group>& groups, const ParallelLoop& loop,
                        size_t& allowance) const {
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
}

std::vector<PathCache::Sample> PathCache::Publish(Forest& forest, std::vector<Group> groups,
                                                  bool ahead, uint64_t& certified) {
  std::vector<Sample> next;
  for (Group& group : groups) {
    PathNode& node = *group.node;
    const auto object = static_cast<size_t>(group.object);
    if (!ahead && node.ahead.exchange(false, std::memory_order_relaxed)) ++ahead_.used;
    if (group.paths) {
      costs_.Add(object, group.ns);
      node.ahead = ahead;
      if (forest.store.Publish(object, node, std::move(group.paths), BudgetOf(forest))) {
        ++certified;
        ahead_.built += ahead ? 1 : 0;
        if (journal_ != nullptr) {
          journal_->Write(forest.limits, {group.object, node.root, node.cell}, *node.payload);
        }
      }
    }
    if (!node.payload || node.payload->IsDecided() || node.cell.depth >= max_depth_) continue;
    // Where dividing has not helped so far, more rays must ask for it.
    if (node.uses < uint64_t{kMinPathDivision} << std::min(group.barren_levels, 8)) continue;
    if (!forest.store.Divide(object, node, clock_, BudgetOf(forest))) continue;
    next.insert(next.end(), group.samples.begin(), group.samples.end());
  }
  return next;
}

size_t PathCache::Restore(const PathLimits& limits, std::span<KeptPathCell> cells) {
  const std::scoped_lock alone(builders_mutex_, ledger_mutex_);
  const bool has_place =
      std::any_of(forests_.begin(), forests_.end(), [](const auto& slot) { return !slot; });
  if (FindForest(limits) == nullptr && !has_place) return 0;
  Forest& forest = *OpenForest(limits);
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
  uint64_t bytes = 0;
  ForEachForest([&](Forest& forest) {
    forest.ledger_bytes = forest.ledger.ByteSize();
    bytes += forest.ledger_bytes;
  });
  ledger_bytes_ = bytes;
}

uint64_t PathCache::Refine(const PathLimits& limits, std::span<const Sample> samples, double weight,
                           const ParallelLoop& loop, bool ahead, double kept_uses) {
  const std::shared_lock building(builders_mutex_);
  const uint32_t now = ++clock_;
  uint64_t certified = 0;
  if (memory_bytes_ > 0) {
    const Builder builder(*this, limits);
    if (builder.forest() == nullptr) return 0;
    Forest& forest = *builder.forest();
    forest.last_used = now;
    forest.store.PlantWanted(now, BudgetOf(forest), [](size_t) { return true; });
    const double rays = static_cast<double>(samples.size()) * weight;
    size_t allowance = std::max(kMinNewCells, static_cast<size_t>(rays / kRaysPerNewCell));
    std::vector<Group> groups = GroupByLeaf(forest, samples);
    while (!groups.empty()) {
      for (const Group& group : groups) {
        group.node->uses = static_cast<uint32_t>(
            std::lround(kept_uses * group.node->uses) +
            static_cast<int64_t>(static_cast<double>(group.samples.size()) * weight));
      }
      Certify(forest, groups, loop, allowance);
      const std::vector<Sample> next = Publish(forest, std::move(groups), ahead, certified);
      groups = GroupByLeaf(forest, next);
    }
  }
  const std::lock_guard evicting(ledger_mutex_);
  Evict();
  return certified;
}

uint64_t PathCache::UsedBytes() const {
  uint64_t bytes = 0;
  ForEachForest([&](const Forest& forest) { bytes += forest.BytesHeld(); });
  return bytes;
}

uint64_t PathCache::BudgetOf(const Forest& forest) const {
  const EpochGuard reading;
  uint64_t others = forest.ledger_bytes;
  ForEachForest([&](const Forest& other) { others += &other == &forest ? 0 : other.BytesHeld(); });
  const uint64_t all = memory_bytes_;
  return all > others ? all - others : 0;
}

// From the forests that were used longest ago on.
void PathCache::Evict() {
  NoteLedgers();
  std::vector<Forest*> order;
  ForEachForest([&](Forest& forest) { order.push_back(&forest); });
  std::sort(order.begin(), order.end(),
            [](const Forest* a, const Forest* b) { return a->last_used < b->last_used; });
  const uint64_t target = EvictionTarget(memory_bytes_);
  for (Forest* forest : order) {
    const uint64_t used = UsedBytes();
    if (used <= target) break;
    const uint64_t excess = used - target, held = forest->BytesHeld();
    forest->ledger.Evict(forest->store, held > excess ? held - excess : 0, pinned_);
    NoteLedgers();
  }
}

void PathCache::EndFrame(const FrameMark& mark) {
  std::unique_lock lock(ledger_mutex_, std::defer_lock);
  if (mark.recorder != nullptr) {
    lock.lock();
  } else if (!lock.try_lock()) {
    return;
  }
  const uint64_t target = EvictionTarget(memory_bytes_);
  ForEachForest([&](Forest& forest) {
    const uint64_t others = UsedBytes() - forest.BytesHeld();
    forest.ledger.EndFrame(forest.store, frame_begin_, target > others ? target - others : 0, mark);
    forest.ledger_bytes = forest.ledger.ByteSize();
  });
  pinned_ = frame_begin_;
  frame_begin_ = ++clock_;
  Evict();  // ledgers may have grown
}

void PathCache::SetPolicy(std::string_view name) {
  const std::lock_guard lock(ledger_mutex_);
  policy_name_ = std::string(name);
  ForEachForest([&](Forest& forest) { forest.ledger.SetPolicy(name); });
  NoteLedgers();
}

Adopted PathCache::Adopt(PathCache& former, const ChangeReach& reach, const ParallelLoop& loop) {
  const SceneChange& change = reach.change();
  const std::scoped_lock alone(builders_mutex_, former.builders_mutex_);
  const std::scoped_lock ledgers(ledger_mutex_, former.ledger_mutex_);
  Adopted adopted;
  former.memory_bytes_ = 0;
  clock_ = former.clock_.load();
  for (auto& slot : former.forests_) {
    const std::unique_ptr<Forest> forest = slot.Take();
    if (!forest) continue;
    AwaitReaders();
    adopted.dropped += forest->store.cell_count();
    Forest& own = *OpenForest(forest->limits);
    own.last_used = forest->last_used.load();
    own.store.Adopt(forest->store, change, BudgetOf(own), loop, [&](PathTree& tree) {
      tree.cells().Prune(/*covers=*/false,
                         [&](const PathNode& node) { return reach.Touches(tree, node); });
    });
    own.ledger.Reset();
  }
  BeginAnew();
  Evict();
  adopted.kept = CellCount();
  adopted.dropped -= adopted.kept;
  return adopted;
}

void PathCache::SetMemoryBytes(uint64_t memory_bytes) {
  const std::scoped_lock alone(builders_mutex_, ledger_mutex_);
  memory_bytes_ = memory_bytes;
  ForEachForest([](Forest& forest) { forest.ledger.Reset(); });  // they know another budget
  Evict();
}

void PathCache::Clear() {
  const std::scoped_lock alone(builders_mutex_, ledger_mutex_);
  for (auto& slot : forests_) {
    const std::unique_ptr<Forest> forest = slot.Take();
    if (forest) AwaitReaders();
  }
  NoteLedgers();
}

}  // namespace linetree
