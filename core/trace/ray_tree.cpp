#include "core/trace/ray_tree.h"

namespace linetree {

bool SameLabel(const RayTreeNode& a, const RayTreeNode& b) {
  return a.kind == b.kind && a.branch == b.branch && a.side == b.side && a.object == b.object &&
         a.face == b.face && a.total_reflection == b.total_reflection && a.parent == b.parent;
}

bool SameTopology(const RayTree& a, const RayTree& b) {
  if (a.nodes.size() != b.nodes.size() || a.lights.size() != b.lights.size()) return false;
  for (size_t i = 0; i < a.nodes.size(); ++i) {
    if (!SameLabel(a.nodes[i], b.nodes[i])) return false;
  }
  for (size_t i = 0; i < a.lights.size(); ++i) {
    const LightTerm& p = a.lights[i];
    const LightTerm& q = b.lights[i];
    if (p.state != q.state || p.crossings != q.crossings) return false;
  }
  return true;
}

}  // namespace linetree
