#include "core/cache/surface_cache.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace linetree {

// A node whose lights are to be certified, and what comes after.
struct SurfaceCache::Work {
  SurfaceNode* node = nullptr;
  size_t object = 0;
  double points = 0;        // shading points expected in it
  double least_points = 0;  // Thrift's
  const CellLights* parent = nullptr;
  std::unique_ptr<const CellLights> lights{};  // the result
  bool may_divide = true;
};

SurfaceCache::SurfaceCache(const Tracer& tracer, uint64_t memory_bytes, double min_uses,
                           bool uses_functions)
    : certifier_(tracer, uses_functions),
      summer_(tracer.scene()),
      min_uses_(min_uses),
      memory_bytes_(memory_bytes),
      store_(tracer.scene(), memory_bytes) {}

SurfaceCache::Reader::Reader(const SurfaceCache& cache, double epsilon)
    : cache_(cache), epsilon_(epsilon), lock_(cache.mutex_) {}

KnownLights SurfaceCache::Reader::Find(const Hit& hit) const {
  const auto object = static_cast<size_t>(hit.object);
  const SurfaceTree* tree = cache_.store_.Get(object);
  if (tree != nullptr) return tree->Find(hit, epsilon_, cache_.clock_);
  cache_.store_.Want(object);
  return {};
}

const SurfaceTree* SurfaceCache::Reader::TreeOf(size_t object) const {
  const SurfaceTree* tree = cache_.store_.Get(object);
  if (tree == nullptr) cache_.store_.Want(object);
  return tree;
}

std::vector<SurfaceCache::Work> SurfaceCache::CollectUsed(double weight, const Thrift& thrift) {
  std::unique_lock lock(mutex_);
  ++clock_;
  std::vector<Work> works;
  store_.ForEachTree([&](size_t object, SurfaceTree& tree) {
    const double least = thrift.least_points == nullptr ? 0 : (*thrift.least_points)(object);
    if (std::isinf(least)) return;
    tree.cells().ForEach([&](SurfaceNode& node) {
      if (!node.IsLeaf()) return;
      const uint32_t uses = node.uses.exchange(0, std::memory_order_relaxed);
      if (uses < thrift.least_uses || uses * weight < least) return;
      if (uses == 0 || (node.payload && !node.payload->WantsSmaller())) return;
      works.push_back({&node, object, uses * weight, least});
    });
  });
  store_.PlantWanted(memory_bytes_, [&](size_t object) {
    return thrift.may_grow == nullptr || (*thrift.may_grow)(object);
  });
  return works;
}

void SurfaceCache::Trim(std::vector<Work>& works, const Thrift& thrift, double& left) {
  std::stable_sort(works.begin(), works.end(),
                   [](const Work& a, const Work& b) { return a.points > b.points; });
  std::erase_if(works, [&](const Work& work) {
    const double price = work.node->payload ? 0 : (*thrift.price)(work.object);
    if (price > left) return true;
    left -= price;
    return false;
  });
}

void SurfaceCache::AllowDivisions(std::vector<Work>& works, const Thrift& thrift, double left) {
  for (Work& work : works) {
    const double price = 4 * (*thrift.price)(work.object);
    work.may_divide = price <= left;
    if (work.may_divide) left -= price;
  }
}

bool SurfaceCache::ShouldDivide(const Work& work, const CellLights& lights) const {
  return work.may_divide && work.points >= std::max(min_uses_, 2 * work.least_points) &&
         work.node->cell.depth < kMaxSurfaceDepth && lights.WantsSmaller();
}

std::vector<SurfaceCache::Work> SurfaceCache::Publish(std::vector<Work> works,
                                                      const ParallelLoop& loop) {
  loop(works.size(), [&](size_t i) {
    Work& work = works[i];
    if (work.node->payload) return;
    const SurfaceChart& chart = store_.Get(work.object)->chart();
    auto lights = std::make_unique<CellLights>(certifier_.Certify(
        static_cast<int>(work.object), chart, work.node->root, work.node->cell, work.parent));
    // Who is about to be divided answers nobody.
    if (!ShouldDivide(work, *lights)) {
      summer_.AddSums(static_cast<int>(work.object), chart, work.node->root, work.node->cell,
                      *lights);
    }
    lights->MakeTasks(summer_.scene());
    work.lights = std::move(lights);
  });
  std::vector<Work> next;
  std::unique_lock lock(mutex_);
  for (Work& work : works) {
    SurfaceNode& node = *work.node;
    if (!node.payload) {
      if (!work.lights) continue;  // the loop was cut short
      if (!store_.Publish(node, std::move(work.lights), memory_bytes_)) continue;
    }
    if (!ShouldDivide(work, *node.payload) || !store_.Divide(node, clock_, memory_bytes_)) continue;
    for (SurfaceNode& child : *node.children) {
      next.push_back({&child, work.object, work.points / 4, work.least_points, node.payload.get()});
    }
  }
  return next;
}

uint64_t SurfaceCache::Refine(double weight, const ParallelLoop& loop, const Thrift& thrift) {
  std::lock_guard refining(refine_mutex_);
  const uint64_t before = CellCount();
  std::vector<Work> works = CollectUsed(weight, thrift);
  const bool is_limited = thrift.price != nullptr && std::isfinite(thrift.most_work);
  double left = thrift.most_work;
  if (is_limited) Trim(works, thrift, left);
  while (!works.empty()) {
    if (is_limited) AllowDivisions(works, thrift, left);
    works = Publish(std::move(works), loop);
    for (const Work& child : works) left -= is_limited ? (*thrift.price)(child.object) : 0;
  }
  const uint64_t certified = CellCount() - before;
  std::unique_lock lock(mutex_);
  store_.Evict(EvictionTarget(memory_bytes_));
  return certified;
}

void SurfaceCache::SetMemoryBytes(uint64_t memory_bytes) {
  std::lock_guard refining(refine_mutex_);
  std::unique_lock lock(mutex_);
  memory_bytes_ = memory_bytes;
  store_.Evict(EvictionTarget(memory_bytes_));
}

uint64_t SurfaceCache::ByteSize() const {
  std::shared_lock lock(mutex_);
  return store_.byte_size();
}

uint64_t SurfaceCache::CountBytes() const {
  std::shared_lock lock(mutex_);
  return store_.CountBytes();
}

uint64_t SurfaceCache::CellCount() const {
  std::shared_lock lock(mutex_);
  return store_.cell_count();
}

std::vector<TreeSize> SurfaceCache::TreeSizes() const {
  std::shared_lock lock(mutex_);
  return store_.TreeSizes();
}

uint64_t SurfaceCache::TreeCount() const {
  std::shared_lock lock(mutex_);
  uint64_t count = 0;
  store_.ForEachTree([&](size_t, const SurfaceTree&) { ++count; });
  return count;
}

void SurfaceCache::Clear() {
  std::lock_guard refining(refine_mutex_);
  std::unique_lock lock(mutex_);
  store_.Clear();
}

}  // namespace linetree
