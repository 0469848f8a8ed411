// Sixteen rays from their origins to the light they carry and the rays they spawn.
#if defined(LINETREE_CORE_PACKET_FOLLOW_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_PACKET_FOLLOW_INL_H_
#undef LINETREE_CORE_PACKET_FOLLOW_INL_H_
#else
#define LINETREE_CORE_PACKET_FOLLOW_INL_H_
#endif

#include "core/packet/packet_workspace.h"
#include "core/packet/shade-inl.h"
#include "core/packet/sight-inl.h"
#include "core/packet/spawn-inl.h"
#include "core/packet/topology.h"

HWY_BEFORE_NAMESPACE();
namespace linetree::HWY_NAMESPACE {

// What was done for the lanes of a packet: see PixelUse.
struct LaneUses {
  LaneMask searched = 0, listed = 0, summed = 0;
};

// Notes it for their pixels.
HWY_INLINE void MarkUses(const PathPacket& packet, const LaneUses& uses,
                         PacketWorkspace& workspace) {
  const auto bits = [](LaneMask lanes, int use)
                        HWY_ATTR { return Select(MaskOf(lanes), Ints::All(use), Ints::All(0)); };
  const Ints all =
      bits(uses.searched, kSearched) | bits(uses.listed, kListed) | bits(uses.summed, kSummed);
  uint8_t* to = workspace.uses();
  if (packet.is_tile) {
    to += packet.pixel[0];
    for (size_t k = 0; k < LanesOf<int32_t>::kVectors; ++k) {
      const hn::Rebind<uint8_t, Ints::Tag> bytes;
      uint8_t* at = to + k * LanesOf<int32_t>::kWidth;
      hn::StoreU(hn::Or(hn::LoadU(bytes, at), hn::DemoteTo(bytes, all.v[k])), bytes, at);
    }
    return;
  }
  alignas(64) int32_t use[kPacketLanes];
  all.Store(use);
  for (LaneMask left = packet.rays.active; left != 0; left &= left - 1) {
    const int lane = std::countr_zero(left);
    to[packet.pixel[lane]] |= static_cast<uint8_t>(use[lane]);
  }
}

// The lights by searching the scene for what is in between.
class SearchedLights {
 public:
  static constexpr bool kHasSheets = false;

  HWY_INLINE SearchedLights(const PacketScene& scene, bool digested, PacketWorkspace& workspace,
                            PacketCounts& counts)
      : scene_(scene),
        digested_(digested),
        workspace_(workspace),
        last_blockers_(workspace.LastBlockers(scene.lights().size())),
        counts_(counts) {}

  void Add(const PathPacket& packet, const PacketHits& hits, const HitPoints& at,
           const LaneMaterials& /*materials*/, LaneMask lanes, LightSum& sum) {
    for (size_t i = 0; i < scene_.lights().size(); ++i) {
      const LaneLight seen = LightAt(scene_, i, hits, at, lanes, counts_.facing_again);
      PacketShadow shadow;
      CastAt(scene_, hits, at, seen, static_cast<int>(i), last_blockers_[i], shadow, counts_);
      sum.Add(i, seen, shadow);
      if (digested_) DigestLight(packet, i, lanes, shadow);
    }
  }

 private:
  void DigestLight(const PathPacket& packet, size_t light, LaneMask lanes,
                   const PacketShadow& shadow) {
    for (LaneMask left = lanes; left != 0; left &= left - 1) {
      const int lane = std::countr_zero(left);
      const LaneMask bit = LaneMask{1} << lane;
      const LightState state = (shadow.facing & bit) == 0 ? LightState::kFacingAway
                               : (shadow.lit & bit) == 0  ? LightState::kBlocked
                                                          : LightState::kLit;
      workspace_.digest()[packet.pixel[lane]] +=
          DigestOfLight(packet.path[lane], light, state, (shadow.filtered & bit) != 0);
    }
  }

  const PacketScene& scene_;
  const bool digested_;
  PacketWorkspace& workspace_;
  int32_t* const last_blockers_;
  PacketCounts& counts_;
};

// Follows packets of one block. Lights::Add(packet, hits, at, materials, lanes, sum) adds what all
// lights do at the hits in `lanes`.
template <class Lights>
class Follower {
 public:
  HWY_INLINE Follower(const PacketScene& scene, const PathLimits& limits, Lights& lights,
                      bool digested, PacketWorkspace& workspace, PacketCounts& counts)
      : scene_(scene),
        limits_(limits),
        lights_(lights),
        digested_(digested),
        workspace_(workspace),
        counts_(counts) {}

  // Leaves the rays that the packet spawns in the queues of level `depth` mod 2, and its light in
  // sum().
  void Follow(const PathPacket& packet, int depth) {
    FindHitsOf(scene_, packet.rays, hits_, counts_);
    Shade(packet, depth);
  }

  // The same where hits() are those of the packet already.
  void Shade(const PathPacket& packet, int depth) {
    const LaneMask active = packet.rays.active, missed = active & ~hits_.hit;
    total_ = asked_ = 0;
    if (hits_.hit != 0) {
      Light(packet);
      if (spawns_) {
        Spawner(scene_, limits_, workspace_, counts_).Spawn(packet, hits_, depth, total_);
      }
    } else {
      for (Floats& sum : sum_) sum = Floats::All(0);
    }
    if (missed != 0) {
      const Rgb& background = scene_.scene().background;
      for (int c = 0; c < 3; ++c) {
        sum_[c] = Select(MaskOf(missed), Floats::All(static_cast<float>(background[c])), sum_[c]);
      }
    }
    if (digested_) Digest(packet);
  }

  PacketHits& hits() { return hits_; }
  const Floats* sum() const { return sum_; }

 private:
  void Light(const PathPacket& packet) {
    counts_.rays.shade += static_cast<uint64_t>(std::popcount(hits_.hit));
    const HitPoints at = PointsOf(hits_);
    const LaneMaterials materials = MaterialsAt(scene_, hits_);
    spawns_ = materials.spawns;
    const LaneView view = ViewAt(packet.rays, at);
    LightSum sum(scene_, packet.rays, hits_, materials, view);
    const LaneMask asked = hits_.hit & materials.uses_lights;
    if (digested_) asked_ = asked;
    if (asked != 0) lights_.Add(packet, hits_, at, materials, asked, sum);
    for (int c = 0; c < 3; ++c) sum_[c] = sum.sum()[c];
  }

  void Digest(const PathPacket& packet) {
    for (LaneMask left = packet.rays.active; left != 0; left &= left - 1) {
      const int lane = std::countr_zero(left);
      const LaneMask bit = LaneMask{1} << lane;
      uint64_t& digest = workspace_.digest()[packet.pixel[lane]];
      const bool inside = (hits_.inside & hits_.hit & bit) != 0;
      const bool hit = (hits_.hit & bit) != 0;
      digest += DigestOfNode(packet.path[lane], hit ? hits_.object[lane] : kNoObject,
                             hit ? hits_.face[lane] : 0, inside ? Side::kInside : Side::kOutside,
                             (total_ & bit) != 0);
      if (!hit || (asked_ & bit) != 0) continue;
      for (size_t i = 0; i < scene_.lights().size(); ++i) {
        digest += DigestOfLight(packet.path[lane], i, LightState::kUnused, false);
      }
    }
  }

  const PacketScene& scene_;
  const PathLimits& limits_;
  Lights& lights_;
  const bool digested_;
  PacketWorkspace& workspace_;
  PacketCounts& counts_;
  PacketHits hits_;
  Floats sum_[3];
  bool spawns_ = false;
  LaneMask asked_ = 0;  // digested: lanes whose material answers to lights
  LaneMask total_ = 0;  // lanes that reflect totally
};

}  // namespace linetree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
