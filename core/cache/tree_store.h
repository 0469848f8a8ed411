// The trees of all objects of a scene, of one kind, and the bytes they hold. What surface_cache.h
// and path_cache.h have in common.
//
// A Tree has Node, Cell, Traits, Tree(const Object&), cells() (cell_tree.h), OwnBytes() and
// CountBytes().
//
// Thread safety: Get, Want, ForEachTree and what only looks may run at any time, within an
// EpochGuard where trees may be taken away meanwhile. Builders (PlantWanted, Publish, Divide) may
// run at the same time as each other, as readers and as one who evicts (TryTake..., Dispose).
// Clear, Adopt and Restore need to be the only ones but readers.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/cache/epoch.h"
#include "core/cache/parallel_loop.h"
#include "core/math/check.h"
#include "core/scene/scene_change.h"
#include "core/tree/cell_tree.h"

namespace linetree {

// Of one object.
struct TreeSize {
  uint64_t cells = 0;  // of which something is known
  uint64_t bytes = 0;
};

// What has been taken back for want of room.
struct Evicted {
  uint64_t cells = 0;  // of which something was known
  uint64_t bytes = 0;
};

// The same, counted while others read it: they wait for nobody.
class EvictedCounter {
 public:
  void Add(const Evicted& more) {
    cells_ += more.cells;
    bytes_ += more.bytes;
  }
  Evicted now() const { return {cells_, bytes_}; }

 private:
  std::atomic<uint64_t> cells_{0}, bytes_{0};
};

template <class Tree>
class TreeStore {
 public:
  using Node = typename Tree::Node;
  using Children = typename Node::Children;
  using Counts = CellCounts<typename Tree::Traits>;

  // What the store holds for every object of the scene, trees or not, counts as well: where
  // `memory_bytes` have no room for it, there are no trees. What is taken back is added to
  // `evicted`, which must outlive the store and may be several stores'.
  TreeStore(const Scene& scene, uint64_t memory_bytes, EvictedCounter& evicted)
      : scene_(scene), evicted_(evicted) {
    MakeIndex(memory_bytes);
  }

  // Null when the object has no tree.
  Tree* Get(size_t object) const {
    const Index* index = index_.get();
    return index == nullptr ? nullptr : index->trees[object].get();
  }

  // Readers may not build; asking for a tree is all they do.
  void Want(size_t object) const {
    const Index* index = index_.get();
    if (index == nullptr) return;
    std::atomic<bool>& wanted = index->wanted[object];
    if (!wanted.load(std::memory_order_relaxed)) wanted.store(true, std::memory_order_relaxed);
  }
  // Trees for the objects that readers asked for, as far as `memory_bytes` go: those
  // that may_grow(size_t object) -> bool lets grow. False when there was no room for one.
  template <class Fn>
  bool PlantWanted(uint32_t now, uint64_t memory_bytes, Fn&& may_grow) {
    MakeIndex(memory_bytes);
    const Index* index = index_.get();
    if (index == nullptr) return false;
    for (size_t object = 0; object < index->trees.size(); ++object) {
      std::atomic<bool>& wanted = index->wanted[object];
      if (!wanted.load(std::memory_order_relaxed)) continue;  // most are not: a look is cheaper
      if (!wanted.exchange(false, std::memory_order_relaxed)) continue;
      if (index->trees[object] || !may_grow(object)) continue;
      if (!Plant(object, now, memory_bytes)) return false;
    }
    return true;
  }

  // Puts what somebody has kept of a cell back, into cells that are divided for it as far as need
  // be; false when there is no room. What is no cell of the object's tree is left out.
  template <class Payload>
  bool Restore(size_t object, int root, const typename Tree::Cell& cell,
               std::unique_ptr<const Payload> payload, uint32_t now, uint64_t memory_bytes) {
    MakeIndex(memory_bytes);
    if (!index_ || (Get(object) == nullptr && !Plant(object, now, memory_bytes))) return false;
    auto& cells = Get(object)->cells();
    if (root >= cells.roots()) return true;
    Node* node = &cells.Root(root);
    for (int level = 0; level < cell.depth; ++level) {
      if (node->IsLeaf() && !Divide(object, *node, now, memory_bytes)) return false;
      node = &(*node->children)[static_cast<size_t>(cell.ChildAt(level))];
    }
    return node->payload || Publish(object, *node, std::move(payload), memory_bytes);
  }

  // Puts what is known of a cell, which the caller owns, into its node; false, and nothing done,
  // when there is no room.
  template <class Payload>
  bool Publish(size_t object, Node& node, std::unique_ptr<const Payload> payload,
               uint64_t memory_bytes) {
    Counts counts;
    counts.Add(*payload);
    if (!Reserve(counts.bytes, memory_bytes)) return false;
    cells_ += 1;
    Get(object)->cells().Add(counts);
    LT_CHECK(node.payload.PutFirst(payload));
    return true;
  }
  // Gives a leaf, which the caller owns, children that nobody owns (or the caller, too, with
  // `owned`); false when there is no room.
  bool Divide(size_t object, Node& node, uint32_t now, uint64_t memory_bytes, bool owned = false) {
    if (!Reserve(sizeof(Children), memory_bytes)) return false;
    auto children = std::make_unique<Children>();
    int c = 0;
    for (Node& child : *children) {
      child.cell = node.cell.Child(c++);
      child.root = node.root;
      child.last_used.store(now, std::memory_order_relaxed);
      child.claimed.store(owned, std::memory_order_relaxed);
    }
    Counts counts;
    counts.bytes = sizeof(Children);
    Get(object)->cells().Add(counts);
    LT_CHECK(node.children.PutFirst(children));
    return true;
  }

  // What has been taken away, which readers may still look at. It counts as held until it is
  // disposed of.
  class Removed {
   public:
    uint64_t bytes() const { return counts_.bytes; }

   private:
    friend TreeStore;
    std::vector<std::unique_ptr<Children>> children_;
    std::vector<std::unique_ptr<Tree>> trees_;
    Counts counts_;
  };
  // One block of leaves, which their parent stands for then; false, and nothing done, where it has
  // blocks below it or somebody owns one of its cells.
  bool TryTakeChildren(size_t object, Node& node, Removed& removed) {
    Children* children = node.children.get();
    if (children == nullptr || !TryClaim(*children)) return false;
    Counts counts;
    counts.bytes = sizeof(*children);
    uint32_t used = 0;
    for (const Node& child : *children) {
      if (child.payload) counts.Add(*child.payload);
      used = std::max(used, child.last_used.load(std::memory_order_relaxed));
    }
    node.last_used.store(used, std::memory_order_relaxed);
    removed.children_.push_back(node.children.Take());
    Get(object)->cells().Subtract(counts);
    removed.counts_ += counts;
    return true;
  }
  // The object must have one. As above.
  bool TryTakeTree(size_t object, Removed& removed) {
    Tree& tree = *Get(object);
    std::vector<Node*> roots;
    tree.cells().ForEachRoot([&](Node& root) { roots.push_back(&root); });
    if (!TryClaimAll(roots)) return false;
    removed.counts_ += tree.cells().counts();
    removed.counts_.bytes += tree.OwnBytes();
    removed.trees_.push_back(index_->trees[object].Take());
    return true;
  }
  // When nobody reads it any more.
  void Dispose(Removed& removed) {
    if (removed.children_.empty() && removed.trees_.empty()) return;
    AwaitReaders();
    const uint64_t cells = removed.counts_.Cells();
    Subtract(cells, removed.counts_.bytes);
    evicted_.Add({cells, removed.counts_.bytes});
    removed = Removed();
  }

  // Takes back blocks of leaves, those used longest ago first, when there are none left whole
  // trees, and then all the rest, while the store holds more than `target` bytes: what nobody owns.
  void Evict(uint64_t target) {
    Removed removed;
    const auto is_done = [&] { return byte_size() - removed.bytes() <= target; };
    for (bool progress = true; progress && !is_done();) {
      progress = false;
      for (const Victim& victim : ParentsOfLeaves()) {
        if (is_done()) break;
        progress |= TryTakeChildren(victim.object, *victim.node, removed);
      }
    }
    if (!is_done()) {
      for (const Victim& victim : TreesByUse()) {
        if (is_done()) break;
        TryTakeTree(victim.object, removed);
      }
    }
    Dispose(removed);
    if (byte_size() > target && byte_size() == IndexBytes()) Clear();
  }

  // Takes the trees of a former scene's store over, for the objects that are still there and not
  // altered, without what prune(Tree&) takes out of them, which it returns (CellTree::Prune);
  // `loop` may prune several at once. The former store is empty afterwards, this one was before.
  // The budget is the caller's affair. Renumber(now, Payload&) -> false where what it names is
  // gone.
  template <class Fn>
  void Adopt(TreeStore& former, const SceneChange& change, uint64_t memory_bytes,
             const ParallelLoop& loop, Fn&& prune) {
    const std::unique_ptr<Index> old = former.TakeIndex();
    MakeIndex(memory_bytes);
    if (!old || !index_) return;
    loop(kAdoptedParts, [&](size_t part) {
      for (size_t object = part; object < old->trees.size(); object += kAdoptedParts) {
        const int32_t now = change.now[object];
        if (!old->trees[object] || now == SceneChange::kGone || change.altered[object]) continue;
        auto tree = std::make_unique<Tree>(scene_.objects[static_cast<size_t>(now)]);
        tree->cells() = std::move(old->trees[object]->cells());
        prune(*tree);
        if (!change.keeps_indices) {
          tree->cells().Prune(false,
                              [&](const Node& node) { return !RenumberPayload(change.now, node); });
        }
        const Counts counts = tree->cells().counts();
        cells_ += counts.Cells();
        byte_size_ += tree->OwnBytes() + counts.bytes;
        LT_CHECK(index_->trees[static_cast<size_t>(now)].PutFirst(tree));
      }
    });
  }

  void Clear() { TakeIndex(); }

  // visit(size_t object, Tree&).
  template <class Fn>
  void ForEachTree(Fn&& visit) const {
    const Index* index = index_.get();
    if (index == nullptr) return;
    for (size_t object = 0; object < index->trees.size(); ++object) {
      if (Tree* tree = index->trees[object].get()) visit(object, *tree);
    }
  }

  // By object.
  std::vector<TreeSize> TreeSizes() const {
    std::vector<TreeSize> sizes(scene_.objects.size());
    ForEachTree([&](size_t object, Tree& tree) {
      const Counts counts = tree.cells().counts();
      sizes[object] = {counts.Cells(), tree.OwnBytes() + counts.bytes};
    });
    return sizes;
  }

  uint64_t byte_size() const { return byte_size_; }
  uint64_t cell_count() const { return cells_; }
  uint64_t CountBytes() const {
    uint64_t bytes = IndexBytes();
    ForEachTree([&](size_t, const Tree& tree) { bytes += tree.CountBytes(); });
    return bytes;
  }

 private:
  struct Index {
    explicit Index(size_t objects) : trees(objects), wanted(objects) {}
    std::vector<OwningSlot<Tree>> trees;            // by object
    mutable std::vector<std::atomic<bool>> wanted;  // by object: a reader found no tree
  };
  struct Victim {
    uint32_t used = 0;
    size_t object = 0;
    Node* node = nullptr;
  };
  static constexpr size_t kAdoptedParts = 64;

  bool Reserve(uint64_t bytes, uint64_t memory_bytes) {
    uint64_t held = byte_size_.load();
    do {
      if (held + bytes > memory_bytes) return false;
    } while (!byte_size_.compare_exchange_weak(held, held + bytes));
    return true;
  }
  void Subtract(uint64_t cells, uint64_t bytes) {
    cells_ -= cells;
    byte_size_ -= bytes;
  }
  // False when there is no room. Somebody has just asked for it: it is not what goes first.
  bool Plant(size_t object, uint32_t now, uint64_t memory_bytes) {
    auto tree = std::make_unique<Tree>(scene_.objects[object]);
    tree->cells().ForEachRoot(
        [now](Node& root) { root.last_used.store(now, std::memory_order_relaxed); });
    const uint64_t bytes = tree->OwnBytes();
    if (!Reserve(bytes, memory_bytes)) return false;
    if (!index_->trees[object].PutFirst(tree)) byte_size_ -= bytes;
    return true;
  }
  void MakeIndex(uint64_t memory_bytes) {
    if (index_ || BytesOfIndex() > memory_bytes) return;
    auto index = std::make_unique<Index>(scene_.objects.size());
    if (index_.PutFirst(index)) byte_size_ += BytesOfIndex();
  }
  // With all trees, when nobody reads them any more.
  std::unique_ptr<Index> TakeIndex() {
    std::unique_ptr<Index> index = index_.Take();
    if (index) AwaitReaders();
    byte_size_ = 0;
    cells_ = 0;
    return index;
  }
  uint64_t BytesOfIndex() const {
    return scene_.objects.size() * (sizeof(Index::trees[0]) + sizeof(Index::wanted[0]));
  }
  uint64_t IndexBytes() const { return index_ ? BytesOfIndex() : 0; }

  // All leaves, or none.
  static bool TryClaimAll(std::span<Node* const> nodes) {
    for (size_t i = 0; i < nodes.size(); ++i) {
      if (nodes[i]->Claim()) {
        if (nodes[i]->IsLeaf()) continue;
        nodes[i]->Release();
      }
      while (i > 0) nodes[--i]->Release();
      return false;
    }
    return true;
  }
  static bool TryClaim(Children& children) {
    std::array<Node*, std::tuple_size_v<Children>> nodes;
    for (size_t c = 0; c < nodes.size(); ++c) nodes[c] = &children[c];
    return TryClaimAll(nodes);
  }

  static bool IsUsedEarlier(const Victim& a, const Victim& b) { return a.used < b.used; }
  std::vector<Victim> ParentsOfLeaves() const {
    std::vector<Victim> parents;
    ForEachTree([&](size_t object, Tree& tree) {
      tree.cells().ForEach([&](Node& node) {
        const Children* children = node.children.get();
        if (children == nullptr) return;
        uint32_t used = 0;
        for (const Node& child : *children) {
          if (!child.IsLeaf()) return;
          used = std::max(used, child.last_used.load(std::memory_order_relaxed));
        }
        parents.push_back({used, object, &node});
      });
    });
    std::stable_sort(parents.begin(), parents.end(), IsUsedEarlier);
    return parents;
  }
  std::vector<Victim> TreesByUse() const {
    std::vector<Victim> trees;
    ForEachTree([&](size_t object, Tree& tree) {
      uint32_t used = 0;
      tree.cells().ForEachRoot([&](Node& root) {
        used = std::max(used, root.last_used.load(std::memory_order_relaxed));
      });
      trees.push_back({used, object});
    });
    std::stable_sort(trees.begin(), trees.end(), IsUsedEarlier);
    return trees;
  }
  static bool RenumberPayload(std::span<const int32_t> now, const Node& node) {
    using Payload = std::remove_const_t<std::remove_reference_t<decltype(*node.payload)>>;
    // Nobody else holds it: it may change before anybody sees it again.
    return Renumber(now, const_cast<Payload&>(*node.payload));
  }

  const Scene& scene_;
  EvictedCounter& evicted_;
  OwningSlot<Index> index_;  // empty where there is no room for it
  std::atomic<uint64_t> byte_size_{0};
  std::atomic<uint64_t> cells_{0};
};

// A pass of eviction frees an eighth of the budget.
inline uint64_t EvictionTarget(uint64_t memory_bytes) { return memory_bytes - memory_bytes / 8; }

}  // namespace linetree
