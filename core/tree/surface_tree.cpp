#include "core/tree/surface_tree.h"

namespace linetree {
namespace {

void Visit(SurfaceNode& node, const std::function<void(SurfaceNode&)>& visit) {
  visit(node);
  if (!node.children) return;
  for (SurfaceNode& child : *node.children) Visit(child, visit);
}

uint64_t BytesOf(const SurfaceNode& node) {
  uint64_t bytes = node.ByteSize();
  if (node.children) {
    for (const SurfaceNode& child : *node.children) bytes += BytesOf(child);
  }
  return bytes;
}

}  // namespace

SurfaceTree::SurfaceTree(const Object& object)
    : chart_(object), roots_(static_cast<size_t>(chart_.patches())) {
  for (size_t i = 0; i < roots_.size(); ++i) roots_[i].patch = static_cast<int>(i);
}

const LightList* SurfaceTree::Find(const Hit& hit, uint32_t now) const {
  if (!chart_.IsOn(hit.face, hit.point)) return nullptr;
  const SurfacePoint point = chart_.Locate(hit.face, hit.point);
  const SurfaceCell deepest = CellAt(point, kMaxSurfaceDepth);
  const SurfaceNode* node = &roots_[static_cast<size_t>(point.patch)];
  while (node->children) {
    const int shift = kMaxSurfaceDepth - node->cell.depth - 1;
    const uint32_t child = ((deepest.i >> shift) & 1) | ((deepest.j >> shift) & 1) << 1;
    node = &(*node->children)[child];
  }
  node->uses.fetch_add(1, std::memory_order_relaxed);
  node->last_used.store(now, std::memory_order_relaxed);
  return node->certified ? node->lights.lights.data() : nullptr;
}

void SurfaceTree::ForEach(const std::function<void(SurfaceNode&)>& visit) {
  for (SurfaceNode& root : roots_) Visit(root, visit);
}

uint64_t SurfaceTree::CountBytes() const {
  uint64_t bytes = sizeof(SurfaceTree) + roots_.capacity() * sizeof(SurfaceNode);
  for (const SurfaceNode& root : roots_) bytes += BytesOf(root);
  return bytes;
}

}  // namespace linetree
