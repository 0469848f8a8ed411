// The frame path for every target of Highway; which one runs is decided at run time.
//
// Everything ordinary is included here, before code for special targets is: nothing of it may be
// compiled for one.
#include "core/frame/frame_kernels.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <variant>
#include <vector>

#include "core/cache/surface_cache.h"
#include "core/frame/frame_plan.h"
#include "core/jet/simd_targets.h"
#include "core/packet/margins.h"
#include "core/packet/packet_scene.h"
#include "core/packet/packet_shape.h"
#include "core/packet/topology.h"
#include "core/trace/intersect.h"
#include "core/trace/shade.h"
#include "core/trace/shadow_function.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/frame/frame_kernels.cpp"
#include "hwy/foreach_target.h"
// After foreach_target.h.
#include "hwy/highway.h"
#if HWY_TARGET != HWY_SCALAR
#include "core/frame/lights-inl.h"
#include "core/frame/once-inl.h"
#include "core/packet/block-inl.h"
#include "core/packet/rays-inl.h"
#endif

HWY_BEFORE_NAMESPACE();
namespace linetree::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR
void RenderFrameBlock(const PacketScene&, const BlockTask&, const SurfaceCache::Reader&, FramePlan&,
                      Asking, BookedPackets*, PacketWorkspace&, PacketCounts&) {}
void BookAgain(const PacketScene&, const BookedPackets&, const SurfaceCache::Reader&, FramePlan&,
               PacketWorkspace&) {}
void RenderOnce(const PacketScene&, const OnceTask&, const SurfaceCache::Reader&, const FramePlan&,
                PacketWorkspace&, PacketCounts&, OnceBlock&) {}
void TraceCachedRays(const PacketScene&, const RayTask&, uint64_t, const SurfaceCache::Reader&,
                     FramePlan&, Asking, PacketWorkspace&, PacketCounts&) {}
#else
void RenderFrameBlock(const PacketScene& scene, const BlockTask& task,
                      const SurfaceCache::Reader& reader, FramePlan& plan, Asking asking,
                      BookedPackets* booked, PacketWorkspace& workspace, PacketCounts& counts) {
  CachedLights lights(scene, reader, plan, asking, booked, true, workspace, counts);
  BlockRenderer<CachedLights>(scene, task, lights, workspace, counts).Render();
}
void BookAgain(const PacketScene& scene, const BookedPackets& booked,
               const SurfaceCache::Reader& reader, FramePlan& plan, PacketWorkspace& workspace) {
  PacketCounts none;
  CachedLights lights(scene, reader, plan, Asking::kBooked, nullptr, true, workspace, none);
  for (const BookedPacket& packet : booked.packets) lights.BookAgain(packet);
}
void RenderOnce(const PacketScene& scene, const OnceTask& task, const SurfaceCache::Reader& reader,
                const FramePlan& plan, PacketWorkspace& workspace, PacketCounts& counts,
                OnceBlock& block) {
  OnceRenderer(scene, task, reader, plan, workspace, counts, block).Render();
}
void TraceCachedRays(const PacketScene& scene, const RayTask& task, uint64_t packets,
                     const SurfaceCache::Reader& reader, FramePlan& plan, Asking asking,
                     PacketWorkspace& workspace, PacketCounts& counts) {
  CachedLights lights(scene, reader, plan, asking, nullptr, false, workspace, counts);
  TraceRays(scene, task, packets, lights, workspace, counts);
}
#endif

}  // namespace linetree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace linetree {

HWY_EXPORT(RenderFrameBlock);
HWY_EXPORT(BookAgain);
HWY_EXPORT(RenderOnce);
HWY_EXPORT(TraceCachedRays);

void RenderFrameBlockWide(const PacketScene& scene, const BlockTask& task,
                          const SurfaceCache::Reader& lights, FramePlan& plan, Asking asking,
                          BookedPackets* booked, PacketWorkspace& workspace, PacketCounts& counts) {
  HWY_DYNAMIC_DISPATCH(RenderFrameBlock)
  (scene, task, lights, plan, asking, booked, workspace, counts);
}
void BookAgainWide(const PacketScene& scene, const BookedPackets& booked,
                   const SurfaceCache::Reader& lights, FramePlan& plan,
                   PacketWorkspace& workspace) {
  HWY_DYNAMIC_DISPATCH(BookAgain)(scene, booked, lights, plan, workspace);
}
void RenderOnceWide(const PacketScene& scene, const OnceTask& task,
                    const SurfaceCache::Reader& lights, const FramePlan& plan,
                    PacketWorkspace& workspace, PacketCounts& counts, OnceBlock& block) {
  HWY_DYNAMIC_DISPATCH(RenderOnce)(scene, task, lights, plan, workspace, counts, block);
}
void TraceCachedRaysWide(const PacketScene& scene, const RayTask& task, uint64_t packets,
                         const SurfaceCache::Reader& lights, FramePlan& plan, Asking asking,
                         PacketWorkspace& workspace, PacketCounts& counts) {
  HWY_DYNAMIC_DISPATCH(TraceCachedRays)
  (scene, task, packets, lights, plan, asking, workspace, counts);
}

}  // namespace linetree
#endif
