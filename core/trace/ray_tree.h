// The ray tree of one ray (paper section 5): what its radiance is made of.
//
// Nodes are stored in the order in which they are visited (parent first, reflected before
// transmitted). Geometry is kept beside the labels because the judges need it: shafts are built
// from the points, peaks from directions and normals.
#pragma once

#include <cstdint>
#include <vector>

#include "core/math/rgb.h"
#include "core/math/vec3.h"
#include "core/trace/hit.h"

namespace linetree {

enum class LightState : uint8_t {
  kFacingAway,  // n.l <= 0
  kLit,         // n.l > 0 and nothing opaque in between
  kBlocked,     // n.l > 0 and `occluder` is opaque and in between
  kUnused,      // the material has neither diffuse nor specular: no shadow ray is cast
};

// One light as seen from one node.
struct LightTerm {
  LightState state = LightState::kUnused;
  int32_t occluder = kNoObject;
  // kLit: the transparent surfaces crossed on the way, as an order-independent hash of (object,
  // number of crossings); 0 when there are none.
  uint64_t crossings = 0;
};

enum class Branch : uint8_t { kEye, kReflected, kTransmitted };

enum class NodeKind : uint8_t {
  kSurface,     // the ray met an object
  kBackground,  // the ray met nothing
  kCutOff,      // the ray was not cast: depth or weight ended the path
};

struct RayTreeNode {
  NodeKind kind = NodeKind::kSurface;
  Branch branch = Branch::kEye;
  Side side = Side::kOutside;         // the side that the ray comes from
  bool total_reflection = false;      // this surface reflects totally: only a kReflected child
  bool leaves_denser_medium = false;  // refraction at this surface goes from dense to sparse
  int32_t object = kNoObject;
  int32_t face = 0;
  int32_t parent = -1;
  int32_t first_light = -1;  // index into lights of light 0's term; -1 unless kSurface
  Vec3d origin;              // of the ray
  Vec3d direction;           // of the ray, unit; zero for kCutOff
  Vec3d point;               // kSurface: the hit
  Vec3d normal;              // kSurface: shading normal, turned towards the origin
};

struct RayTree {
  std::vector<RayTreeNode> nodes;
  std::vector<LightTerm> lights;  // Scene::lights.size() for every surface node
  Rgb radiance;

  size_t ByteSize() const {
    return nodes.capacity() * sizeof(RayTreeNode) + lights.capacity() * sizeof(LightTerm);
  }
};

// Whether two nodes carry the same label (kind, branch, side, object, face, total reflection,
// parent). Lights are compared apart, because "blocked" needs one common occluder, not equal
// labels.
bool SameLabel(const RayTreeNode& a, const RayTreeNode& b);

// Isomorphic ray trees: node labels and light states agree. `occluder` is not compared.
bool SameTopology(const RayTree& a, const RayTree& b);

}  // namespace linetree
