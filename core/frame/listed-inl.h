// Shadow rays of a packet towards a light that only the objects of a list may hide: asks their
// shadow functions, then the objects that these do not know in float, and at last in double.
#if defined(LINETREE_CORE_FRAME_LISTED_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_FRAME_LISTED_INL_H_
#undef LINETREE_CORE_FRAME_LISTED_INL_H_
#else
#define LINETREE_CORE_FRAME_LISTED_INL_H_
#endif

#include <bit>
#include <span>

#include "core/frame/shadows-inl.h"
#include "core/packet/shade-inl.h"
#include "core/tree/light_certifier.h"

HWY_BEFORE_NAMESPACE();
namespace linetree::HWY_NAMESPACE {

class ListedShadows {
 public:
  HWY_INLINE ListedShadows(const PacketScene& scene, const CellLights& known, const LightTask& task)
      : scene_(scene), known_(known), task_(task) {}

  // Adds those of `lanes`, which face the light, that it reaches to shadow.lit. s, t: within the
  // cell.
  void Cast(const Floats& s, const Floats& t, LaneMask lanes, const LaneLight& seen,
            const PacketHits& hits, const HitPoints& at, PacketShadow& shadow,
            PacketCounts& counts) const {
    Between between(MaskOf(lanes & ~seen.odd));
    LaneMask again = lanes & seen.odd;
    FloatRays rays;
    bool has_rays = false;
    for (uint32_t i = task_.first; i < task_.first + task_.count; ++i) {
      Between asked(between.open);
      if (!known_.functions.empty()) {
        const LaneShadowing known =
            ShadowingOf(known_.functions[i], known_.coefficients.data(), s, t);
        between.open = Without(between.open, known.blocks);
        asked.open = Without(between.open, known.misses);
      }
      if (!Any(asked.open)) {
        if (!Any(between.open)) break;
        continue;
      }
      if (!has_rays) {
        has_rays = true;
        NeedBounds(scene_, at);
        rays.o = at.from;
        rays.d = seen.to_light;
        rays.size = at.size;
      }
      const Mask before = asked.open;
      const PacketShape& shape = scene_.shapes()[static_cast<size_t>(known_.objects[i])];
      AddBlocker(scene_, shape, rays, at.object, seen.distance, asked.open, asked);
      between.open = Without(between.open, Without(before, asked.open));
      between.doubt = between.doubt | asked.doubt;
    }
    const LaneMask doubt = BitsOf(between.open & between.doubt);
    shadow.lit |= BitsOf(between.open) & ~doubt;
    again |= doubt;
    if (again != 0) CastAgain(again, hits, shadow, counts);
  }

 private:
  void CastAgain(LaneMask lanes, const PacketHits& hits, PacketShadow& shadow,
                 PacketCounts& counts) const {
    counts.shadows_again += static_cast<uint64_t>(std::popcount(lanes));
    const std::span<const int32_t> candidates(known_.objects.data() + task_.first, task_.count);
    for (LaneMask left = lanes; left != 0; left &= left - 1) {
      const int lane = std::countr_zero(left);
      const RayStart start{hits.object[lane], hits.face[lane], Side::kOutside};
      SetShadow(
          lane,
          scene_.tracer().CastShadowAmong(candidates, hits.point.At(lane), task_.light, start),
          shadow);
    }
  }

  const PacketScene& scene_;
  const CellLights& known_;
  const LightTask& task_;
};

}  // namespace linetree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
