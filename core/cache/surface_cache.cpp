#include "core/cache/surface_cache.h"

#include <algorithm>
#include <utility>

namespace linetree {
namespace {

// A pass frees an eighth of the budget.
constexpr uint64_t kSlackDivisor = 8;

}  // namespace

// A node whose lights are to be certified, and what comes after.
struct SurfaceCache::Work {
  SurfaceNode* node = nullptr;
  size_t object = 0;
  double points = 0;  // shading points expected in it
  const CellLights* parent = nullptr;
  CellLights lights{};  // the result
};

SurfaceCache::SurfaceCache(const Tracer& tracer, uint64_t memory_bytes)
    : tracer_(tracer),
      certifier_(tracer),
      memory_bytes_(memory_bytes),
      trees_(tracer.scene().objects.size()),
      wanted_(tracer.scene().objects.size()) {}

SurfaceCache::Reader::Reader(const SurfaceCache& cache) : cache_(cache), lock_(cache.mutex_) {}

const LightList* SurfaceCache::Reader::Find(const Hit& hit) const {
  const auto object = static_cast<size_t>(hit.object);
  const SurfaceTree* tree = cache_.trees_[object].get();
  if (tree != nullptr) return tree->Find(hit, cache_.clock_);
  // Readers may not build; asking for the tree is all they do.
  std::atomic<bool>& wanted = cache_.wanted_[object];
  if (!wanted.load(std::memory_order_relaxed)) wanted.store(true, std::memory_order_relaxed);
  return nullptr;
}

// Trees for the objects that hits asked for, as far as the budget goes. Needs the lock.
void SurfaceCache::PlantTrees() {
  for (size_t object = 0; object < trees_.size(); ++object) {
    if (!wanted_[object].exchange(false, std::memory_order_relaxed) || trees_[object]) continue;
    auto tree = std::make_unique<SurfaceTree>(tracer_.scene().objects[object]);
    const uint64_t bytes = tree->CountBytes();
    if (byte_size_ + bytes > memory_bytes_) return;
    trees_[object] = std::move(tree);
    byte_size_ += bytes;
  }
}

std::vector<SurfaceCache::Work> SurfaceCache::CollectUsed(double weight) {
  std::unique_lock lock(mutex_);
  ++clock_;
  std::vector<Work> works;
  for (size_t object = 0; object < trees_.size(); ++object) {
    if (!trees_[object]) continue;
    trees_[object]->ForEach([&](SurfaceNode& node) {
      if (!node.IsLeaf()) return;
      const uint32_t uses = node.uses.exchange(0, std::memory_order_relaxed);
      if (uses == 0 || (node.certified && node.lights.IsDecided())) return;
      works.push_back({&node, object, uses * weight});
    });
  }
  PlantTrees();
  return works;
}

std::vector<SurfaceCache::Work> SurfaceCache::Publish(std::vector<Work> works,
                                                      const ParallelLoop& loop) {
  loop(works.size(), [&](size_t i) {
    Work& work = works[i];
    if (work.node->certified) return;
    const PatchHull hull = trees_[work.object]->chart().HullOf(work.node->patch, work.node->cell);
    work.lights = certifier_.Certify(static_cast<int>(work.object), hull, work.parent);
  });
  std::vector<Work> next;
  std::unique_lock lock(mutex_);
  for (Work& work : works) {
    SurfaceNode& node = *work.node;
    if (!node.certified) {
      const uint64_t bytes = work.lights.HeapBytes();
      if (byte_size_ + bytes > memory_bytes_) continue;
      node.lights = std::move(work.lights);
      node.certified = true;
      byte_size_ += bytes;
      ++cells_;
    }
    const bool divide = work.points >= kMinSurfaceUses && node.cell.depth < kMaxSurfaceDepth &&
                        !node.lights.IsDecided();
    if (!divide || byte_size_ + sizeof(*node.children) > memory_bytes_) continue;
    node.children = std::make_unique<std::array<SurfaceNode, 4>>();
    byte_size_ += sizeof(*node.children);
    for (int c = 0; c < 4; ++c) {
      SurfaceNode& child = (*node.children)[static_cast<size_t>(c)];
      child.cell = node.cell.Child(c);
      child.patch = node.patch;
      child.last_used.store(clock_, std::memory_order_relaxed);
      next.push_back({&child, work.object, work.points / 4, &node.lights});
    }
  }
  return next;
}

uint64_t SurfaceCache::Refine(double weight, const ParallelLoop& loop) {
  std::lock_guard refining(refine_mutex_);
  const uint64_t before = CellCount();
  std::vector<Work> works = CollectUsed(weight);
  while (!works.empty()) works = Publish(std::move(works), loop);
  const uint64_t certified = CellCount() - before;
  Evict();
  return certified;
}

// Takes back blocks of four leaves, those used longest ago first, while less than an eighth of the
// budget is free.
void SurfaceCache::Evict() {
  std::unique_lock lock(mutex_);
  const uint64_t target = memory_bytes_ - memory_bytes_ / kSlackDivisor;
  while (byte_size_ > target) {
    std::vector<std::pair<uint32_t, SurfaceNode*>> victims;  // parents of leaf blocks
    for (const auto& tree : trees_) {
      if (!tree) continue;
      tree->ForEach([&](SurfaceNode& node) {
        if (!node.children) return;
        uint32_t used = 0;
        for (const SurfaceNode& child : *node.children) {
          if (!child.IsLeaf()) return;
          used = std::max(used, child.last_used.load(std::memory_order_relaxed));
        }
        victims.emplace_back(used, &node);
      });
    }
    if (victims.empty()) return;
    std::stable_sort(victims.begin(), victims.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    for (const auto& [used, node] : victims) {
      if (byte_size_ <= target) break;
      for (const SurfaceNode& child : *node->children) {
        byte_size_ -= child.lights.HeapBytes();
        cells_ -= child.certified ? 1 : 0;
      }
      byte_size_ -= sizeof(*node->children);
      node->children.reset();
      node->last_used.store(used, std::memory_order_relaxed);
    }
  }
}

void SurfaceCache::SetMemoryBytes(uint64_t memory_bytes) {
  std::lock_guard refining(refine_mutex_);
  {
    std::unique_lock lock(mutex_);
    memory_bytes_ = memory_bytes;
  }
  Evict();
}

uint64_t SurfaceCache::ByteSize() const {
  std::shared_lock lock(mutex_);
  return byte_size_;
}

uint64_t SurfaceCache::CountBytes() const {
  std::shared_lock lock(mutex_);
  uint64_t bytes = 0;
  for (const auto& tree : trees_) {
    if (tree) bytes += tree->CountBytes();
  }
  return bytes;
}

uint64_t SurfaceCache::CellCount() const {
  std::shared_lock lock(mutex_);
  return cells_;
}

void SurfaceCache::Clear() {
  std::lock_guard refining(refine_mutex_);
  std::unique_lock lock(mutex_);
  for (auto& tree : trees_) tree.reset();
  byte_size_ = 0;
  cells_ = 0;
}

}  // namespace linetree
