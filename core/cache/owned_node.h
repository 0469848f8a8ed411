// A cell that somebody owns (cell_tree.h) as long as this lives.
#pragma once

#include <utility>

namespace linetree {

template <class Node>
class OwnedNode {
 public:
  OwnedNode() = default;
  // Owns nothing where somebody else owns the node, or has just divided it.
  explicit OwnedNode(Node& node) {
    if (!node.Claim()) return;
    node_ = &node;
    if (!node.IsLeaf()) Release();
  }
  // A node that is the caller's already.
  static OwnedNode Adopt(Node& node) {
    OwnedNode owned;
    owned.node_ = &node;
    return owned;
  }
  ~OwnedNode() { Release(); }
  OwnedNode(OwnedNode&& o) noexcept : node_(std::exchange(o.node_, nullptr)) {}
  OwnedNode& operator=(OwnedNode&& o) noexcept {
    if (this != &o) Release();
    node_ = std::exchange(o.node_, nullptr);
    return *this;
  }

  explicit operator bool() const { return node_ != nullptr; }
  Node* get() const { return node_; }
  Node& operator*() const { return *node_; }
  Node* operator->() const { return node_; }

 private:
  void Release() {
    if (node_ != nullptr) std::exchange(node_, nullptr)->Release();
  }

  Node* node_ = nullptr;
};

}  // namespace linetree
