// Blocks of rays that come from anywhere: packets of sixteen of them first, then, leg by leg, what
// they spawn.
#if defined(LINETREE_CORE_PACKET_RAYS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_PACKET_RAYS_INL_H_
#undef LINETREE_CORE_PACKET_RAYS_INL_H_
#else
#define LINETREE_CORE_PACKET_RAYS_INL_H_
#endif

#include "core/packet/block-inl.h"

HWY_BEFORE_NAMESPACE();
namespace linetree::HWY_NAMESPACE {

// The rays block[0], block[1], ... of at most a packet; the last one again in the lanes that are
// left over, which are not active.
HWY_INLINE void SetRays(std::span<const Ray> rays, std::span<const uint32_t> block,
                        PacketRays& packet) {
  Ints::All(kNoObject).Store(packet.start_object);
  Ints::All(0).Store(packet.start_face);
  packet.start_inside = 0;
  for (size_t lane = 0; lane < kPacketLanes; ++lane) {
    const Ray& ray = rays[block[std::min(lane, block.size() - 1)]];
    packet.origin.Set(static_cast<int>(lane), ray.origin);
    packet.direction.Set(static_cast<int>(lane), ray.direction);
  }
  packet.active = kAllLanes >> (kPacketLanes - block.size());
}

// Takes the hits of a packet from where RayTask has them. Each of the block's rays has one.
HWY_INLINE void SetHits(std::span<const Hit> hits, std::span<const uint32_t> block,
                        PacketHits& packet) {
  packet.hit = packet.inside = packet.first_on_line = 0;
  for (size_t lane = 0; lane < kPacketLanes; ++lane) {
    packet.Set(static_cast<int>(lane), hits[block[std::min(lane, block.size() - 1)]]);
  }
  const LaneMask active = kAllLanes >> (kPacketLanes - block.size());
  packet.hit &= active;
  packet.inside &= active;
  packet.first_on_line &= active;
}

// Of the block's packets, those whose bit is set in `packets`.
template <class Lights>
HWY_INLINE void TraceRays(const PacketScene& scene, const RayTask& task, uint64_t packets,
                          Lights& lights, PacketWorkspace& workspace, PacketCounts& counts) {
  Follower<Lights> follower(scene, task.limits, lights, false, workspace, counts);
  ClearQueues(workspace);
  std::fill_n(workspace.uses(), kBlockPixels, 0);
  PathPacket packet;
  SetUpPaths(packet);
  const size_t size = task.block.size();
  for (size_t first = 0; first < size; first += kPacketLanes) {
    if ((packets >> (first / kPacketLanes) & 1) == 0) continue;
    const auto lanes = task.block.subspan(first, std::min<size_t>(kPacketLanes, size - first));
    SetRays(task.rays, lanes, packet.rays);
    SetPixels(static_cast<int>(first), packet);
    if (task.hits.empty()) {
      counts.rays.eye += lanes.size();
      follower.Follow(packet, 1);
    } else {
      SetHits(task.hits, lanes, follower.hits());
      follower.Shade(packet, 1);
    }
    for (size_t c = 0; c < 3; ++c) {
      follower.sum()[c].Store(workspace.radiance() + c * kBlockPixels + first);
    }
    const PacketHits& hits = follower.hits();
    for (size_t lane = 0; lane < lanes.size(); ++lane) {
      RayResult& result = task.results[first + lane];
      const bool hit = (hits.hit >> lane & 1) != 0;
      result.object = hit ? hits.object[lane] : kNoObject;
      result.depth = hits.t[lane];
    }
  }
  FollowQueues(follower, task.limits, workspace);
  for (size_t i = 0; i < size; ++i) {
    if ((packets >> (i / kPacketLanes) & 1) == 0) continue;
    RayResult& result = task.results[i];
    for (size_t c = 0; c < 3; ++c) {
      result.radiance[c] = workspace.radiance()[c * kBlockPixels + i];
    }
    result.uses = workspace.uses()[i];
  }
}

}  // namespace linetree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
