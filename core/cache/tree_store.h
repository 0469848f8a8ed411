// The trees of all objects of a scene, of one kind, and the bytes they hold. What surface_cache.h
// and path_cache.h have in common; whoever owns a store guards it with a lock.
//
// A Tree has Node, Cell, Tree(const Object&), cells() (cell_tree.h) and CountBytes().
#pragma once

#include <algorithm>
#include <atomic>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/scene/scene_change.h"

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

template <class Tree>
class TreeStore {
 public:
  using Node = typename Tree::Node;
  // Who owns this destroys it; that takes a while.
  struct Removed {
    std::vector<decltype(Node::children)> children;
    std::vector<std::unique_ptr<Tree>> trees;
  };

  // What the store holds for every object of the scene, trees or not, counts as well: where
  // `memory_bytes` have no room for it, there are no trees.
  TreeStore(const Scene& scene, uint64_t memory_bytes) : scene_(scene) { MakeIndex(memory_bytes); }

  // Null when the object has no tree.
  Tree* Get(size_t object) const { return trees_.empty() ? nullptr : trees_[object].get(); }

  // Readers may not build; asking for a tree is all they do. May run at the same time as itself.
  void Want(size_t object) const {
    if (wanted_.empty()) return;
    std::atomic<bool>& wanted = wanted_[object];
    if (!wanted.load(std::memory_order_relaxed)) wanted.store(true, std::memory_order_relaxed);
  }
  // Trees for the objects that readers asked for, as far as `memory_bytes` go: those
  // that may_grow(size_t object) -> bool lets grow.
  template <class Fn>
  void PlantWanted(uint64_t memory_bytes, Fn&& may_grow) {
    MakeIndex(memory_bytes);
    for (size_t object = 0; object < trees_.size(); ++object) {
      if (!wanted_[object].exchange(false, std::memory_order_relaxed) || trees_[object]) continue;
      if (!may_grow(object)) continue;
      if (!Plant(object, memory_bytes)) return;
    }
  }

  // Puts what somebody has kept of a cell back, into cells that are divided for it as far as need
  // be; false when there is no room. What is no cell of the object's tree is left out.
  template <class Payload>
  bool Restore(size_t object, int root, const typename Tree::Cell& cell,
               std::unique_ptr<const Payload> payload, uint32_t now, uint64_t memory_bytes) {
    MakeIndex(memory_bytes);
    if (trees_.empty() || (!trees_[object] && !Plant(object, memory_bytes))) return false;
    auto& cells = trees_[object]->cells();
    if (root >= cells.roots()) return true;
    Node* node = &cells.Root(root);
    for (int level = 0; level < cell.depth; ++level) {
      if (node->IsLeaf() && !Divide(*node, now, memory_bytes)) return false;
      node = &(*node->children)[static_cast<size_t>(cell.ChildAt(level))];
    }
    return node->payload || Publish(*node, std::move(payload), memory_bytes);
  }

  // Puts what is known of a cell into its node; false, and nothing done, when there is no room.
  template <class Payload>
  bool Publish(Node& node, std::unique_ptr<const Payload> payload, uint64_t memory_bytes) {
    const uint64_t bytes = Node::BytesOf(payload.get());
    if (byte_size_ + bytes > memory_bytes) return false;
    node.payload = std::move(payload);
    byte_size_ += bytes;
    ++cells_;
    return true;
  }
  // Gives a leaf children; false when there is no room.
  bool Divide(Node& node, uint32_t now, uint64_t memory_bytes) {
    if (byte_size_ + sizeof(*node.children) > memory_bytes) return false;
    node.children = std::make_unique<typename decltype(node.children)::element_type>();
    byte_size_ += sizeof(*node.children);
    int c = 0;
    for (Node& child : *node.children) {
      child.cell = node.cell.Child(c++);
      child.root = node.root;
      child.last_used.store(now, std::memory_order_relaxed);
    }
    return true;
  }

  // Takes back blocks of leaves, those used longest ago first, when there are none left whole
  // trees, and then all the rest, while the store holds more than `target` bytes.
  void Evict(uint64_t target) {
    while (byte_size_ > target) {
      std::vector<std::pair<uint32_t, Node*>> victims = ParentsOfLeaves();
      if (victims.empty()) {
        DropTrees(target);
        if (byte_size_ > target) Clear();
        return;
      }
      std::stable_sort(victims.begin(), victims.end(),
                       [](const auto& a, const auto& b) { return a.first < b.first; });
      Removed removed;
      for (const auto& [used, node] : victims) {
        if (byte_size_ <= target) break;
        TakeChildren(*node, removed);
      }
    }
  }
  // One block of leaves, which their parent stands for then.
  void TakeChildren(Node& node, Removed& removed) {
    uint64_t cells = 0, bytes = sizeof(*node.children);
    uint32_t used = 0;
    for (const Node& child : *node.children) {
      bytes += Node::BytesOf(child.payload.get());
      cells += child.payload ? 1 : 0;
      used = std::max(used, child.last_used.load(std::memory_order_relaxed));
    }
    node.last_used.store(used, std::memory_order_relaxed);
    removed.children.push_back(std::move(node.children));
    CountEvicted(cells, bytes);
  }
  // The object must have one.
  void TakeTree(size_t object, Removed& removed) {
    Tree& tree = *trees_[object];
    uint64_t cells = 0;
    tree.cells().ForEach([&](Node& node) { cells += node.payload ? 1 : 0; });
    CountEvicted(cells, tree.CountBytes());
    removed.trees.push_back(std::move(trees_[object]));
  }

  // Takes the trees of a former scene's store over, for the objects that are still there and not
  // altered, without what prune(Tree&) takes out of them, which it returns (CellTree::Pruned). The
  // former store is empty afterwards, this one was before. The budget is the caller's affair.
  // Renumber(now, Payload&) -> false where what it names is gone.
  template <class Fn>
  void Adopt(TreeStore& former, const SceneChange& change, uint64_t memory_bytes, Fn&& prune) {
    MakeIndex(memory_bytes);
    cells_ += former.cells_;
    byte_size_ += former.byte_size_ - former.IndexBytes();
    for (size_t object = 0; object < former.trees_.size(); ++object) {
      const int32_t now = change.now[object];
      if (!former.trees_[object]) continue;
      Tree& old = *former.trees_[object];
      if (trees_.empty() || now == SceneChange::kGone || change.altered[object]) {
        byte_size_ -= old.CountBytes();
        Subtract(old.cells().Prune(false, [](const Node&) { return true; }).cells, 0);
        continue;
      }
      auto tree = std::make_unique<Tree>(scene_.objects[static_cast<size_t>(now)]);
      tree->cells() = std::move(old.cells());
      const auto pruned = prune(*tree);
      Subtract(pruned.cells, pruned.bytes);
      if (!change.keeps_indices) {
        const auto lost = tree->cells().Prune(
            false, [&](const Node& node) { return !RenumberPayload(change.now, node); });
        Subtract(lost.cells, lost.bytes);
      }
      trees_[static_cast<size_t>(now)] = std::move(tree);
    }
    former.Clear();
  }

  void Clear() {
    trees_ = std::vector<std::unique_ptr<Tree>>();
    wanted_ = std::vector<std::atomic<bool>>();
    byte_size_ = 0;
    cells_ = 0;
  }

  // visit(size_t object, Tree&).
  template <class Fn>
  void ForEachTree(Fn&& visit) const {
    for (size_t object = 0; object < trees_.size(); ++object) {
      if (trees_[object]) visit(object, *trees_[object]);
    }
  }

  // By object; counted anew.
  std::vector<TreeSize> TreeSizes() const {
    std::vector<TreeSize> sizes(scene_.objects.size());
    ForEachTree([&](size_t object, Tree& tree) {
      sizes[object].bytes = tree.CountBytes();
      tree.cells().ForEach([&](Node& node) { sizes[object].cells += node.payload ? 1 : 0; });
    });
    return sizes;
  }

  uint64_t byte_size() const { return byte_size_; }
  // Since the store was made.
  const Evicted& evicted() const { return evicted_; }
  uint64_t cell_count() const { return cells_; }
  uint64_t CountBytes() const {
    uint64_t bytes = IndexBytes();
    ForEachTree([&](size_t, const Tree& tree) { bytes += tree.CountBytes(); });
    return bytes;
  }

 private:
  // False when there is no room.
  bool Plant(size_t object, uint64_t memory_bytes) {
    auto tree = std::make_unique<Tree>(scene_.objects[object]);
    const uint64_t bytes = tree->CountBytes();
    if (byte_size_ + bytes > memory_bytes) return false;
    trees_[object] = std::move(tree);
    byte_size_ += bytes;
    return true;
  }
  void MakeIndex(uint64_t memory_bytes) {
    const size_t objects = scene_.objects.size();
    if (!trees_.empty() || objects * (sizeof(trees_[0]) + sizeof(wanted_[0])) > memory_bytes)
      return;
    trees_.resize(objects);
    wanted_ = std::vector<std::atomic<bool>>(objects);
    byte_size_ += IndexBytes();
  }
  uint64_t IndexBytes() const {
    return trees_.capacity() * sizeof(trees_[0]) + wanted_.capacity() * sizeof(wanted_[0]);
  }
  std::vector<std::pair<uint32_t, Node*>> ParentsOfLeaves() const {
    std::vector<std::pair<uint32_t, Node*>> parents;
    ForEachTree([&](size_t, Tree& tree) {
      tree.cells().ForEach([&](Node& node) {
        if (!node.children) return;
        uint32_t used = 0;
        for (const Node& child : *node.children) {
          if (!child.IsLeaf()) return;
          used = std::max(used, child.last_used.load(std::memory_order_relaxed));
        }
        parents.emplace_back(used, &node);
      });
    });
    return parents;
  }
  static bool RenumberPayload(std::span<const int32_t> now, const Node& node) {
    using Payload = std::remove_const_t<typename decltype(node.payload)::element_type>;
    // Nobody else holds it: it may change before anybody sees it again.
    return Renumber(now, const_cast<Payload&>(*node.payload));
  }
  void Subtract(uint64_t cells, uint64_t bytes) {
    cells_ -= cells;
    byte_size_ -= bytes;
  }
  // Of trees without children, those used longest ago first.
  void DropTrees(uint64_t target) {
    std::vector<std::pair<uint32_t, size_t>> order;
    ForEachTree([&](size_t object, Tree& tree) {
      uint32_t used = 0;
      tree.cells().ForEach([&](Node& node) {
        used = std::max(used, node.last_used.load(std::memory_order_relaxed));
      });
      order.emplace_back(used, object);
    });
    std::sort(order.begin(), order.end());
    for (const auto& [used, object] : order) {
      if (byte_size_ <= target) return;
      Removed removed;
      TakeTree(object, removed);
    }
  }
  void CountEvicted(uint64_t cells, uint64_t bytes) {
    Subtract(cells, bytes);
    evicted_.cells += cells;
    evicted_.bytes += bytes;
  }

  const Scene& scene_;
  // Empty where there is no room for them:
  std::vector<std::unique_ptr<Tree>> trees_;       // by object
  mutable std::vector<std::atomic<bool>> wanted_;  // by object: a reader found no tree
  uint64_t byte_size_ = 0;
  uint64_t cells_ = 0;
  Evicted evicted_;
};

// A pass of eviction frees an eighth of the budget.
inline uint64_t EvictionTarget(uint64_t memory_bytes) { return memory_bytes - memory_bytes / 8; }

}  // namespace linetree
