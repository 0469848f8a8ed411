#include "core/tree/surface_tree.h"

namespace linetree {

SurfaceTree::SurfaceTree(const Object& object) : chart_(object), cells_(chart_.patches()) {}

const LightList* SurfaceTree::Find(const Hit& hit, uint32_t now) const {
  if (!chart_.IsOn(hit.face, hit.point)) return nullptr;
  const SurfacePoint point = chart_.Locate(hit.face, hit.point);
  const SurfaceNode& node = cells_.Find(point.patch, CellAt(point, kMaxSurfaceDepth), now);
  node.uses.fetch_add(1, std::memory_order_relaxed);
  return node.payload ? node.payload->lights.data() : nullptr;
}

uint64_t SurfaceTree::CountBytes() const {
  return sizeof(SurfaceTree) - sizeof(cells_) + cells_.CountBytes();
}

}  // namespace linetree
