#include "core/cache/surface_cache.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <utility>

#include "core/cache/owned_node.h"

namespace linetree {

// Tells blocks from those of other caches.
constexpr uint64_t kLedgerKind = 1;

// A node whose lights are to be certified, and what comes after. It owns the node.
struct SurfaceCache::Work {
  OwnedNode<SurfaceNode> node;
  size_t object = 0;
  double points = 0;  // shading points expected in it
  const CellLights* parent = nullptr;
  std::unique_ptr<const CellLights> lights{};  // the result
  bool may_divide = true;
  float ns = 0;  // what certifying took
};

SurfaceCache::SurfaceCache(const Tracer& tracer, uint64_t memory_bytes, double min_uses,
                           bool uses_functions)
    : certifier_(tracer, uses_functions),
      summer_(tracer.scene()),
      min_uses_(min_uses),
      memory_bytes_(memory_bytes),
      store_(tracer.scene(), memory_bytes, evicted_),
      costs_(tracer.scene().objects.size()),
      ledger_(kLedgerKind, costs_) {
  NoteLedger();
}

SurfaceCache::Reader::Reader(const SurfaceCache& cache, double epsilon, uint32_t points)
    : cache_(cache), epsilon_(epsilon), points_(points) {}

KnownLights SurfaceCache::Reader::Find(const Hit& hit) const {
  const auto object = static_cast<size_t>(hit.object);
  const SurfaceTree* tree = cache_.store_.Get(object);
  if (tree != nullptr) return tree->Find(hit, epsilon_, cache_.clock_, points_);
  cache_.store_.Want(object);
  return {};
}

const SurfaceTree* SurfaceCache::Reader::TreeOf(size_t object) const {
  const SurfaceTree* tree = cache_.store_.Get(object);
  if (tree == nullptr) cache_.store_.Want(object);
  return tree;
}

std::vector<SurfaceCache::Work> SurfaceCache::CollectUsed(double weight, const Thrift& thrift,
                                                          uint64_t& unkept) {
  const EpochGuard reading;
  ++clock_;
  std::vector<Work> works;
  store_.ForEachTree([&](size_t object, SurfaceTree& tree) {
    const auto least = [&](const CellLights* known) {
      return thrift.least_points == nullptr ? 0 : (*thrift.least_points)(object, known);
    };
    if (std::isinf(least(nullptr))) return;
    tree.cells().ForEach([&](SurfaceNode& node) {
      if (!node.IsLeaf()) return;
      // What nobody has used is left alone: writing costs a cache line.
      if (node.uses.load(std::memory_order_relaxed) == 0) return;
      const uint32_t uses = node.uses.exchange(0, std::memory_order_relaxed);
      if (!thrift.ahead && node.ahead.exchange(false, std::memory_order_relaxed)) {
        ++ahead_.used;
      }
      if (uses < thrift.least_uses) return;
      const CellLights* known = node.payload.get();
      if (known != nullptr && !HasEnough(uses * weight, *known)) return;
      if (uses * weight < least(known)) return;
      OwnedNode<SurfaceNode> owned(node);
      if (owned) works.push_back({std::move(owned), object, uses * weight});
    });
  });
  const bool all_planted = store_.PlantWanted(clock_, TreeBudget(), [&](size_t object) {
    return thrift.may_grow == nullptr || (*thrift.may_grow)(object);
  });
  unkept += all_planted ? 0 : 1;
  return works;
}

uint64_t SurfaceCache::Room() const {
  const uint64_t held = store_.byte_size(), budget = TreeBudget();
  return budget > held ? budget - held : 0;
}

// As much as those that are there, nodes and all; the first ones as little as may be.
uint64_t SurfaceCache::BytesPerCell() const {
  const uint64_t cells = store_.cell_count();
  return std::max<uint64_t>(sizeof(CellLights), cells == 0 ? 0 : store_.byte_size() / cells);
}

void SurfaceCache::SortByPoints(std::vector<Work>& works) {
  std::stable_sort(works.begin(), works.end(),
                   [](const Work& a, const Work& b) { return a.points > b.points; });
}

void SurfaceCache::KeepWhatFits(std::vector<Work>& works, uint64_t& unkept) const {
  // One at least: what is held may be dear, and makes room when more comes.
  const uint64_t fitting = std::max<uint64_t>(1, Room() / BytesPerCell());
  if (works.size() <= fitting) return;
  unkept += works.size() - fitting;
  SortByPoints(works);
  works.erase(works.begin() + static_cast<std::ptrdiff_t>(fitting), works.end());
}

void SurfaceCache::Trim(std::vector<Work>& works, const Thrift& thrift, double& left) {
  SortByPoints(works);
  double planned = left;
  std::erase_if(works, [&](const Work& work) {
    const CellLights* known = work.node->payload.get();
    // Who is known is there to be divided.
    const double price = (known ? 4 : 1) * (*thrift.price)(work.object, known);
    if (price > planned) return true;
    planned -= price;
    if (!known) left -= price;
    return false;
  });
}

void SurfaceCache::AllowDivisions(std::vector<Work>& works, const Thrift& thrift, double left) {
  // First those that were planned, then those whose own knowledge is still to come.
  for (const bool is_known : {true, false}) {
    for (Work& work : works) {
      const CellLights* known = work.node->payload.get();
      if ((known != nullptr) != is_known) continue;
      const double price = 4 * (*thrift.price)(work.object, known);
      work.may_divide = price <= left;
      if (work.may_divide) left -= price;
    }
  }
}

bool SurfaceCache::ShouldDivide(const Work& work, const CellLights& lights,
                                const Thrift& thrift) const {
  if (!work.may_divide || work.node->cell.depth >= kMaxSurfaceDepth) return false;
  if (!HasEnough(work.points, lights)) return false;
  return thrift.least_points == nullptr ||
         work.points >= 2 * (*thrift.least_points)(work.object, &lights);
}

void SurfaceCache::Certify(std::vector<Work>& works, const ParallelLoop& loop,
                           const Thrift& thrift) const {
  loop(works.size(), [&](size_t i) {
    Work& work = works[i];
    if (work.node->payload) return;
    const BuildTimer timer(work.ns);
    const SurfaceChart& chart = store_.Get(work.object)->chart();
    auto lights = std::make_unique<CellLights>(certifier_.Certify(
        static_cast<int>(work.object), chart, work.node->root, work.node->cell, work.parent));
    // Who is about to be divided answers nobody.
    if (!ShouldDivide(work, *lights, thrift)) {
      summer_.AddSums(static_cast<int>(work.object), chart, work.node->root, work.node->cell,
                      *lights);
    }
    lights->MakeTasks(summer_.scene());
    work.lights = std::move(lights);
  });
}

std::vector<SurfaceCache::Work> SurfaceCache::Publish(std::vector<Work> works, const Thrift& thrift,
                                                      uint64_t& certified) {
  std::vector<Work> next;
  for (Work& work : works) {
    SurfaceNode& node = *work.node;
    if (!node.payload) {
      if (!work.lights) continue;  // the loop was cut short
      costs_.Add(work.object, work.ns);
      node.ahead = thrift.ahead;
      if (!store_.Publish(work.object, node, std::move(work.lights), TreeBudget())) continue;
      ++certified;
      ahead_.built += thrift.ahead ? 1 : 0;
      if (journal_ != nullptr) {
        journal_->Write({static_cast<int32_t>(work.object), node.root, node.cell}, *node.payload);
      }
    }
    if (!ShouldDivide(work, *node.payload, thrift)) continue;
    // Whose children nobody certifies has lost what was known of it.
    const uint64_t children = 4 + next.size();
    if (Room() < sizeof(SurfaceNode::Children) + children * BytesPerCell()) continue;
    if (!store_.Divide(work.object, node, clock_, TreeBudget(), /*owned=*/true)) continue;
    for (SurfaceNode& child : *node.children) {
      next.push_back(
          {OwnedNode<SurfaceNode>::Adopt(child), work.object, work.points / 4, node.payload.get()});
    }
  }
  return next;
}

size_t SurfaceCache::Restore(std::span<KeptSurfaceCell> cells) {
  const std::scoped_lock alone(builders_mutex_, ledger_mutex_);
  size_t restored = 0;
  for (auto& [place, lights] : cells) {
    if (!store_.Restore(static_cast<size_t>(place.object), place.patch, place.cell,
                        std::move(lights), clock_, EvictionTarget(memory_bytes_)))
      break;
    ++restored;
  }
  BeginAnew();
  return restored;
}

void SurfaceCache::BeginAnew() { pinned_ = frame_begin_ = ++clock_; }

SurfaceCache::Grown SurfaceCache::Refine(double weight, const ParallelLoop& loop,
                                         const Thrift& thrift) {
  const std::shared_lock building(builders_mutex_);
  Grown grown;
  std::vector<Work> works = CollectUsed(weight, thrift, grown.unkept);
  const bool is_limited = thrift.price != nullptr && std::isfinite(thrift.most_work);
  double left = thrift.most_work;
  if (is_limited) Trim(works, thrift, left);
  for (KeepWhatFits(works, grown.unkept); !works.empty(); KeepWhatFits(works, grown.unkept)) {
    if (is_limited) AllowDivisions(works, thrift, left);
    Certify(works, loop, thrift);
    works = Publish(std::move(works), thrift, grown.cells);
    for (const Work& child : works) {
      left -= is_limited ? (*thrift.price)(child.object, child.parent) : 0;
    }
  }
  const std::lock_guard evicting(ledger_mutex_);
  Evict();
  grown.work = is_limited ? thrift.most_work - left : 0;
  return grown;
}

Adopted SurfaceCache::Adopt(SurfaceCache& former, const ChangeReach& reach,
                            const ParallelLoop& loop) {
  const SceneChange& change = reach.change();
  const std::scoped_lock alone(builders_mutex_, former.builders_mutex_);
  const std::scoped_lock ledgers(ledger_mutex_, former.ledger_mutex_);
  const uint64_t before = former.store_.cell_count();
  former.memory_bytes_ = 0;
  clock_ = former.clock_.load();
  ledger_.Reset();
  former.ledger_.Reset();
  if (change.lights) former.store_.Clear();
  store_.Adopt(former.store_, change, memory_bytes_, loop, [&](SurfaceTree& tree) {
    if (!reach.TouchesShadows(tree.object())) return;
    tree.cells().Prune(
        /*covers=*/true, [&](const SurfaceNode& node) { return reach.TouchesShadows(tree, node); });
  });
  store_.Evict(EvictionTarget(memory_bytes_));
  BeginAnew();
  NoteLedger();
  const uint64_t kept = store_.cell_count();
  return {kept, before - kept};
}

void SurfaceCache::SetMemoryBytes(uint64_t memory_bytes) {
  const std::scoped_lock alone(builders_mutex_, ledger_mutex_);
  memory_bytes_ = memory_bytes;
  ledger_.Reset();  // its policy knows another budget
  Evict();
}

void SurfaceCache::Evict() {
  // Of what the ledger leaves, too, an eighth stays free, or nothing new would ever fit.
  ledger_.Evict(store_, EvictionTarget(TreeBudget()), pinned_);
  NoteLedger();
}

void SurfaceCache::EndFrame(const FrameMark& mark) {
  std::unique_lock lock(ledger_mutex_, std::defer_lock);
  if (mark.recorder != nullptr) {
    lock.lock();
  } else if (!lock.try_lock()) {
    return;
  }
  ledger_.EndFrame(store_, frame_begin_, EvictionTarget(memory_bytes_), mark);
  pinned_ = frame_begin_;
  frame_begin_ = ++clock_;
  Evict();  // the ledger may have grown
}

void SurfaceCache::SetPolicy(std::string_view name) {
  const std::lock_guard lock(ledger_mutex_);
  ledger_.SetPolicy(name);
  NoteLedger();
}

uint64_t SurfaceCache::CountBytes() const {
  const EpochGuard reading;
  return store_.CountBytes();
}

std::vector<TreeSize> SurfaceCache::TreeSizes() const {
  const EpochGuard reading;
  return store_.TreeSizes();
}

uint64_t SurfaceCache::TreeCount() const {
  const EpochGuard reading;
  uint64_t count = 0;
  store_.ForEachTree([&](size_t, const SurfaceTree&) { ++count; });
  return count;
}

void SurfaceCache::Clear() {
  const std::scoped_lock alone(builders_mutex_, ledger_mutex_);
  ledger_.Reset();
  store_.Clear();
}

}  // namespace linetree
