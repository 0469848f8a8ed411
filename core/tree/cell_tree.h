// Trees of cells of any dimension, whose cells say what is certain about all that lies in them: the
// machinery that surface trees (2D) and certified linetrees (4D) share (DESIGN, section 4).
//
// A Traits class names
//   Cell       a square or box: uint8_t depth, Cell Child(int), int ChildAt(int level),
//   Payload    what a cell knows: movable, bool IsDecided() (no smaller cell could know more),
//              uint64_t HeapBytes(),
//   kChildren  2 to the power of the dimension.
//
// Thread safety: Find may run at the same time as itself (it counts uses with relaxed atomics);
// what changes the tree needs exclusive access.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace linetree {

template <class Traits>
struct CellTreeNode {
  typename Traits::Cell cell;
  int root = 0;
  bool ahead = false;  // certified before anybody asked for it, and nobody has yet
  std::unique_ptr<const typename Traits::Payload> payload;  // null: not certified yet
  std::unique_ptr<std::array<CellTreeNode, Traits::kChildren>> children;
  // Uses of this cell and no smaller one; what counts as one, and when they are taken back, is the
  // cache's affair.
  mutable std::atomic<uint32_t> uses{0};
  mutable std::atomic<uint32_t> last_used{0};  // clock of the cache

  bool IsLeaf() const { return children == nullptr; }
  uint64_t ByteSize() const {  // without the node itself, which its parent holds
    return BytesOf(payload.get()) + (children ? sizeof(*children) : 0);
  }
  static uint64_t BytesOf(const typename Traits::Payload* payload) {
    return payload == nullptr ? 0 : sizeof(*payload) + payload->HeapBytes();
  }
};

template <class Traits>
class CellTree {
 public:
  using Node = CellTreeNode<Traits>;
  using Cell = typename Traits::Cell;

  // `roots` trees, one for each patch or pair of the chart; never resized.
  explicit CellTree(int roots) : roots_(static_cast<size_t>(roots)) {
    for (size_t i = 0; i < roots_.size(); ++i) roots_[i].root = static_cast<int>(i);
  }

  // The smallest cell of a root that holds `deepest`.
  const Node& Leaf(int root, const Cell& deepest) const {
    const Node* node = &roots_[static_cast<size_t>(root)];
    while (node->children) {
      node = &(*node->children)[static_cast<size_t>(deepest.ChildAt(node->cell.depth))];
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
    while (node->children) {
      node = &(*node->children)[static_cast<size_t>(deepest.ChildAt(node->cell.depth))];
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

  // What was taken out of a tree.
  struct Pruned {
    uint64_t cells = 0;  // of which something was known
    uint64_t bytes = 0;
  };
  // What a cell knows is dropped where `touches` (const Node&, not asked without payload), and then
  // blocks of leaves of which nothing is known any more. With `covers`, what touches no cell
  // touches none in it.
  template <class Fn>
  Pruned Prune(bool covers, Fn&& touches) {
    Pruned pruned;
    for (Node& root : roots_) Prune(root, covers, touches, pruned);
    return pruned;
  }

  // Without what the cells know and their children.
  uint64_t OwnBytes() const { return sizeof(CellTree) + roots_.capacity() * sizeof(Node); }
  // Recomputed from scratch.
  uint64_t CountBytes() const {
    uint64_t bytes = OwnBytes();
    for (const Node& root : roots_) bytes += BytesOf(root);
    return bytes;
  }

 private:
  template <class Fn>
  static void Visit(Node& node, Fn& visit) {
    visit(node);
    if (!node.children) return;
    for (Node& child : *node.children) Visit(child, visit);
  }
  template <class Fn>
  static void Prune(Node& node, bool covers, Fn& touches, Pruned& pruned) {
    if (node.payload) {
      if (touches(std::as_const(node))) {
        pruned.bytes += Node::BytesOf(node.payload.get());
        ++pruned.cells;
        node.payload.reset();
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
    node.children.reset();
  }
  static uint64_t BytesOf(const Node& node) {
    uint64_t bytes = node.ByteSize();
    if (node.children) {
      for (const Node& child : *node.children) bytes += BytesOf(child);
    }
    return bytes;
  }

  std::vector<Node> roots_;
};

}  // namespace linetree
