#include "core/packet/topology.h"

namespace linetree {

uint64_t TopologyDigest(const RayTree& tree) {
  uint64_t digest = 0;
  std::vector<uint32_t> paths(tree.nodes.size(), kEyePath);
  // Lights of one node follow each other; the last node's reach to the end.
  size_t surfaces = 0;
  for (const RayTreeNode& node : tree.nodes) surfaces += node.kind == NodeKind::kSurface;
  const size_t lights = surfaces == 0 ? 0 : tree.lights.size() / surfaces;
  for (size_t i = 0; i < tree.nodes.size(); ++i) {
    const RayTreeNode& node = tree.nodes[i];
    if (node.parent >= 0) paths[i] = PathOf(paths[static_cast<size_t>(node.parent)], node.branch);
    if (node.kind == NodeKind::kCutOff) continue;
    digest += DigestOfNode(paths[i], node.object, node.face, node.side, node.total_reflection);
    if (node.kind != NodeKind::kSurface) continue;
    for (size_t light = 0; light < lights; ++light) {
      const LightTerm& term = tree.lights[static_cast<size_t>(node.first_light) + light];
      digest += DigestOfLight(paths[i], light, term.state, term.crossings != 0);
    }
  }
  return digest;
}

}  // namespace linetree
