// The packet tracer for every target of Highway; which one runs is decided at run time.
//
// Everything ordinary is included here, before code for special targets is: nothing of it may be
// compiled for one.
#include "core/packet/packet_kernels.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <variant>
#include <vector>

#include "core/jet/simd_targets.h"
#include "core/packet/margins.h"
#include "core/packet/packet_scene.h"
#include "core/packet/packet_shape.h"
#include "core/packet/topology.h"
#include "core/trace/intersect.h"
#include "core/trace/shade.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/packet/packet_kernels.cpp"
#include "hwy/foreach_target.h"
// After foreach_target.h.
#include "hwy/highway.h"
#if HWY_TARGET != HWY_SCALAR
#include "core/packet/entries-inl.h"
#else
// A machine without vectors is served by the scalar tracer.
HWY_BEFORE_NAMESPACE();
namespace linetree::HWY_NAMESPACE {

bool IsWideTarget() { return false; }
void EyePacket(const EyeRays&, int, int, PacketRays&) {}
void FindHits(const PacketScene&, const PacketRays&, PacketHits&, PacketCounts&) {}
void CastShadows(const PacketScene&, const PacketHits&, LaneMask, int, PacketWorkspace&,
                 PacketShadow&, PacketCounts&) {}
void Shade(const PacketScene&, const PacketRays&, const PacketHits&, std::span<const PacketShadow>,
           PacketRgb&) {}
void Radiance(const PacketScene&, const PacketRays&, const PathLimits&, PacketWorkspace&,
              PacketRgb&, PacketCounts&) {}
void RenderBlock(const PacketScene&, const BlockTask&, PacketWorkspace&, PacketCounts&) {}
void FindRayHits(const PacketScene&, std::span<const Ray>, std::span<const uint32_t>,
                 std::span<Hit>, PacketCounts&) {}
void TraceRayBlock(const PacketScene&, const RayTask&, PacketWorkspace&, PacketCounts&) {}

}  // namespace linetree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE
namespace linetree {

HWY_EXPORT(IsWideTarget);
HWY_EXPORT(EyePacket);
HWY_EXPORT(FindHits);
HWY_EXPORT(CastShadows);
HWY_EXPORT(Shade);
HWY_EXPORT(Radiance);
HWY_EXPORT(RenderBlock);
HWY_EXPORT(FindRayHits);
HWY_EXPORT(TraceRayBlock);

bool HaveWideKernels() { return HWY_DYNAMIC_DISPATCH(IsWideTarget)(); }
void EyePacketWide(const EyeRays& eye_rays, int column, int row, PacketRays& rays) {
  HWY_DYNAMIC_DISPATCH(EyePacket)(eye_rays, column, row, rays);
}
void FindHitsWide(const PacketScene& scene, const PacketRays& rays, PacketHits& hits,
                  PacketCounts& counts) {
  HWY_DYNAMIC_DISPATCH(FindHits)(scene, rays, hits, counts);
}
void CastShadowsWide(const PacketScene& scene, const PacketHits& hits, LaneMask lanes, int light,
                     PacketWorkspace& workspace, PacketShadow& shadow, PacketCounts& counts) {
  HWY_DYNAMIC_DISPATCH(CastShadows)(scene, hits, lanes, light, workspace, shadow, counts);
}
void ShadeWide(const PacketScene& scene, const PacketRays& rays, const PacketHits& hits,
               std::span<const PacketShadow> shadows, PacketRgb& radiance) {
  HWY_DYNAMIC_DISPATCH(Shade)(scene, rays, hits, shadows, radiance);
}
void RadianceWide(const PacketScene& scene, const PacketRays& rays, const PathLimits& limits,
                  PacketWorkspace& workspace, PacketRgb& radiance, PacketCounts& counts) {
  HWY_DYNAMIC_DISPATCH(Radiance)(scene, rays, limits, workspace, radiance, counts);
}
void RenderBlockWide(const PacketScene& scene, const BlockTask& task, PacketWorkspace& workspace,
                     PacketCounts& counts) {
  HWY_DYNAMIC_DISPATCH(RenderBlock)(scene, task, workspace, counts);
}
void FindRayHitsWide(const PacketScene& scene, std::span<const Ray> rays,
                     std::span<const uint32_t> block, std::span<Hit> hits, PacketCounts& counts) {
  HWY_DYNAMIC_DISPATCH(FindRayHits)(scene, rays, block, hits, counts);
}
void TraceRayBlockWide(const PacketScene& scene, const RayTask& task, PacketWorkspace& workspace,
                       PacketCounts& counts) {
  HWY_DYNAMIC_DISPATCH(TraceRayBlock)(scene, task, workspace, counts);
}

}  // namespace linetree
#endif
