// Trees of cells of any dimension, whose cells say what is certain about all that lies in them: the
// machinery that surface trees (2D) and certified linetrees (4D) share (DESIGN, section 4).
//
// A Traits class names
//   Cell       a square or box: uint8_t depth, Cell Child(int), int ChildAt(int level),
//   Payload    what a cell knows: movable, bool IsDecided() (no smaller cell could know more),
//              uint64_t HeapBytes(),
//   kChildren  2 to the power of the dimension,
//   kKinds, size_t KindOf(const Payload&)  by which cells are counted.
//
// Thread safety: reading and counting uses may run at the same time as everything but Prune and
// moving a tree. Whoever gives a cell a payload or children, or takes a block of children away,
// must own the cells that this concerns (Claim); what is taken away may be destroyed when nobody
// reads it any more. A payload that a reader has seen stays where it is until then.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "core/tree/owning_slot.h"

namespace linetree {

template <class Traits>
struct CellTreeNode {
  using Children = std::array<CellTreeNode, Traits::kChildren>;

  typename Traits::Cell cell;
  int root = 0;
  // Certified before anybody asked for it, and nobody has yet.
  std::atomic<bool> ahead{false};
  std::atomic<bool> claimed{false};
  OwningSlot<const typename Traits::Payload> payload;  // null: not certified yet
  OwningSlot<Children> children;
  // Uses of this cell and no smaller one; what counts as one, and when they are taken back, is the
  // cache's affair.
  mutable std::atomic<uint32_t> uses{0};
  mutable std::atomic<uint32_t> last_used{0};  // clock of the cache

  // Makes the caller its owner, if it has none. An owned cell stays in its tree. What has been
  // taken out of it stays owned for ever.
  bool Claim() { return !claimed.exchange(true, std::memory_order_acquire); }
  void Release() { claimed.store(false, std::memory_order_release); }

  bool IsLeaf() const { return !children; }
  uint64_t ByteSize() const {  // without the node itself, which its parent holds
    return BytesOf(payload.get()) + (children ? sizeof(Children) : 0);
  }
  static uint64_t BytesOf(const typename Traits::Payload* payload) {
    return payload == nullptr ? 0 : sizeof(*payload) + payload->HeapBytes();
  }
};

// Of the cells of which something is known.
template <class Traits>
struct CellCounts {
  std::array<uint64_t, Traits::kKinds> cells{};  // by kind
  uint64_t bytes = 0;                            // with their children

  uint64_t Cells() const {
    uint64_t sum = 0;
    for (const uint64_t n : cells) sum += n;
    return sum;
  }
  void Add(const typename Traits::Payload& payload) {
    ++cells[Traits::KindOf(payload)];
    bytes += CellTreeNode<Traits>::BytesOf(&payload);
  }
  CellCounts& operator+=(const CellCounts& o) {
    for (size_t k = 0; k < cells.size(); ++k) cells[k] += o.cells[k];
    bytes += o.bytes;
    return *this;
  }
};

template <class Traits>
class CellTree {
 public:
  using Node = CellTreeNode<Traits>;
  using Cell = typename Traits::Cell;
  using Counts = CellCounts<Traits>;

  // `roots` trees, one for each patch or pair of the chart; never resized.
  explicit CellTree(int roots) : roots_(static_cast<size_t>(roots)) {
    for (size_t i = 0; i < roots_.size(); ++i) roots_[i].root = static_cast<int>(i);
  }

  // The smallest cell of a root that holds `deepest`.
  const Node& Leaf(int root, const Cell& deepest) const {
    const Node* node = &roots_[static_cast<size_t>(root)];
    while (const auto* children = node->children.get()) {
      node = &(*children)[static_cast<size_t>(deepest.ChildAt(node->cell.depth))];
    }
    return *node;
  }
  Node& Leaf(int root, const Cell& deepest) {
    return const_cast<Node&>(std::as_const(*this).Leaf(root, deepest));
  }

  // visit(const Node&) for all cells that hold `deepest`, the largest first.
  template <class Fn>
  void ForEachAround(int root, const Cell& deepest, Fn&& visit) const {
    const Node* node = &roots_[static_cast<size_t>(root)];
    visit(*node);
    while (const auto* children = node->children.get()) {
      node = &(*children)[static_cast<size_t>(deepest.ChildAt(node->cell.depth))];
      visit(*node);
    }
  }

  int roots() const { return static_cast<int>(roots_.size()); }
  Node& Root(int root) { return roots_[static_cast<size_t>(root)]; }

  // The smallest cell, marked as used at `now`.
  const Node& Find(int root, const Cell& deepest, uint32_t now) const {
    const Node& node = Leaf(root, deepest);
    if (node.last_used.load(std::memory_order_relaxed) != now) {
      node.last_used.store(now, std::memory_order_relaxed);
    }
    return node;
  }

  // visit(Node&) for all nodes, parents before children.
  template <class Fn>
  void ForEach(Fn&& visit) {
    for (Node& root : roots_) Visit(root, visit);
  }

  // visit(Node&) for the largest cells.
  template <class Fn>
  void ForEachRoot(Fn&& visit) {
    for (Node& root : roots_) visit(root);
  }

  // What a cell knows is dropped where `touches` (const Node&, not asked without payload), and then
  // blocks of leaves of which nothing is known any more. With `covers`, what touches no cell
  // touches none in it. Returns what was dropped. Nobody else may look at the tree meanwhile.
  template <class Fn>
  Counts Prune(bool covers, Fn&& touches) {
    Counts pruned;
    for (Node& root : roots_) Prune(root, covers, touches, pruned);
    Subtract(pruned);
    return pruned;
  }

  // For those who put something into cells or take it out.
  void Add(const Counts& counts) {
    for (size_t k = 0; k < counts.cells.size(); ++k) CounterOf(counts_.cells[k]) += counts.cells[k];
    CounterOf(counts_.bytes) += counts.bytes;
  }
  void Subtract(const Counts& counts) {
    for (size_t k = 0; k < counts.cells.size(); ++k) CounterOf(counts_.cells[k]) -= counts.cells[k];
    CounterOf(counts_.bytes) -= counts.bytes;
  }
  Counts counts() const {
    Counts now;
    for (size_t k = 0; k < now.cells.size(); ++k) now.cells[k] = CounterOf(counts_.cells[k]);
    now.bytes = CounterOf(counts_.bytes);
    return now;
  }
  // Recomputed from scratch.
  Counts Recount() const {
    Counts counts;
    for (const Node& root : roots_) Recount(root, counts);
    return counts;
  }

  // Without what the cells know and their children.
  uint64_t OwnBytes() const { return sizeof(CellTree) + roots_.capacity() * sizeof(Node); }

 private:
  static std::atomic_ref<uint64_t> CounterOf(uint64_t& counter) {
    return std::atomic_ref<uint64_t>(counter);
  }

  template <class Fn>
  static void Visit(Node& node, Fn& visit) {
    visit(node);
    auto* children = node.children.get();
    if (children == nullptr) return;
    for (Node& child : *children) Visit(child, visit);
  }
  template <class Fn>
  static void Prune(Node& node, bool covers, Fn& touches, Counts& pruned) {
    if (node.payload) {
      if (touches(std::as_const(node))) {
        pruned.Add(*node.payload);
        node.payload.Take();
      } else if (covers) {
        return;
      }
    }
    if (!node.children) return;
    bool is_bare = true;
    for (Node& child : *node.children) {
      Prune(child, covers, touches, pruned);
      is_bare = is_bare && child.IsLeaf() && !child.payload;
    }
    if (!is_bare) return;
    pruned.bytes += sizeof(*node.children);
    node.children.Take();
  }
  static void Recount(const Node& node, Counts& counts) {
    if (const auto* payload = node.payload.get()) counts.Add(*payload);
    const auto* children = node.children.get();
    if (children == nullptr) return;
    counts.bytes += sizeof(*children);
    for (const Node& child : *children) Recount(child, counts);
  }

  std::vector<Node> roots_;
  mutable Counts counts_;
};

}  // namespace linetree
