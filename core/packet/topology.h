// Ray trees as one number, so that those of two tracers can be compared pixel by pixel.
#pragma once

#include <cstdint>

#include "core/math/mixed_bits.h"
#include "core/trace/ray_tree.h"

namespace linetree {

// A node's place in its tree: 1 for the eye ray, 2 p for the reflected and 2 p + 1 for the
// transmitted ray from the end of ray p.
inline constexpr uint32_t kEyePath = 1;
inline uint32_t PathOf(uint32_t parent, Branch branch) {
  return 2 * parent + (branch == Branch::kTransmitted ? 1 : 0);
}

// What the digest sums over all nodes but those that were cut off, and over their lights (with
// whether something transparent lies in between).
inline uint64_t DigestOfNode(uint32_t path, int32_t object, int32_t face, Side side,
                             bool total_reflection) {
  const uint64_t label = static_cast<uint64_t>(static_cast<uint32_t>(object)) << 16 ^
                         static_cast<uint64_t>(face) << 2 ^ (side == Side::kInside ? 2u : 0u) ^
                         (total_reflection ? 1u : 0u);
  return MixedBits(MixedBits(label) + path);
}
inline uint64_t DigestOfLight(uint32_t path, size_t light, LightState state, bool filtered) {
  const uint64_t label =
      static_cast<uint64_t>(light) << 8 ^ static_cast<uint64_t>(state) << 1 ^ (filtered ? 1u : 0u);
  return MixedBits(MixedBits(~label) + path);
}

// Equal for isomorphic ray trees; different ones are as good as never equal.
uint64_t TopologyDigest(const RayTree& tree);

}  // namespace linetree
