// What packet_kernels.h offers, for one of Highway's targets.
#if defined(LINETREE_CORE_PACKET_ENTRIES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_PACKET_ENTRIES_INL_H_
#undef LINETREE_CORE_PACKET_ENTRIES_INL_H_
#else
#define LINETREE_CORE_PACKET_ENTRIES_INL_H_
#endif

#include "core/packet/rays-inl.h"

HWY_BEFORE_NAMESPACE();
namespace linetree::HWY_NAMESPACE {

bool IsWideTarget() { return true; }

void EyePacket(const EyeRays& eye_rays, int column, int row, PacketRays& rays) {
  SetEyes(eye_rays, rays);
  EyeGrid(eye_rays, column, row).SetDirections(0, 0, rays);
  rays.active = LanesWithin(static_cast<int>(eye_rays.width()) - column,
                            static_cast<int>(eye_rays.height()) - row);
}

void RenderBlock(const PacketScene& scene, const BlockTask& task, PacketWorkspace& workspace,
                 PacketCounts& counts) {
  SearchedLights lights(scene, task.target.topology != nullptr, workspace, counts);
  BlockRenderer<SearchedLights>(scene, task, lights, workspace, counts).Render();
}

void FindRayHits(const PacketScene& scene, std::span<const Ray> rays,
                 std::span<const uint32_t> block, std::span<Hit> hits, PacketCounts& counts) {
  PacketRays packet;
  PacketHits found;
  counts.rays.eye += block.size();
  for (size_t first = 0; first < block.size(); first += kPacketLanes) {
    const auto lanes = block.subspan(first, std::min<size_t>(kPacketLanes, block.size() - first));
    SetRays(rays, lanes, packet);
    FindHitsOf(scene, packet, found, counts);
    for (size_t lane = 0; lane < lanes.size(); ++lane) {
      hits[lanes[lane]] = found.At(static_cast<int>(lane));
    }
  }
}

void TraceRayBlock(const PacketScene& scene, const RayTask& task, PacketWorkspace& workspace,
                   PacketCounts& counts) {
  SearchedLights lights(scene, false, workspace, counts);
  TraceRays(scene, task, ~uint64_t{0}, lights, workspace, counts);
}

void Radiance(const PacketScene& scene, const PacketRays& rays, const PathLimits& limits,
              PacketWorkspace& workspace, PacketRgb& radiance, PacketCounts& counts) {
  SearchedLights lights(scene, false, workspace, counts);
  Follower<SearchedLights> follower(scene, limits, lights, false, workspace, counts);
  ClearQueues(workspace);
  PathPacket packet;
  SetUpPaths(packet);
  SetPixels(0, packet);
  packet.rays = rays;
  counts.rays.eye += static_cast<uint64_t>(std::popcount(rays.active));
  follower.Follow(packet, 1);
  for (int c = 0; c < 3; ++c) follower.sum()[c].Store(workspace.radiance() + c * kBlockPixels);
  FollowQueues(follower, limits, workspace);
  float* const to[3] = {radiance.r, radiance.g, radiance.b};
  const Mask active = MaskOf(rays.active);
  for (int c = 0; c < 3; ++c) {
    const Floats sum = Floats::Load(workspace.radiance() + c * kBlockPixels);
    Select(active, sum, Floats::All(0)).Store(to[c]);
  }
}

void FindHits(const PacketScene& scene, const PacketRays& rays, PacketHits& hits,
              PacketCounts& counts) {
  FindHitsOf(scene, rays, hits, counts);
}

void CastShadows(const PacketScene& scene, const PacketHits& hits, LaneMask lanes, int light,
                 PacketWorkspace& workspace, PacketShadow& shadow, PacketCounts& counts) {
  const HitPoints at = PointsOf(hits);
  const auto index = static_cast<size_t>(light);
  const LaneLight seen = LightAt(scene, index, hits, at, lanes & hits.hit, counts.facing_again);
  CastAt(scene, hits, at, seen, light, workspace.LastBlockers(scene.lights().size())[index], shadow,
         counts);
}

void Shade(const PacketScene& scene, const PacketRays& rays, const PacketHits& hits,
           std::span<const PacketShadow> shadows, PacketRgb& radiance) {
  float* const to[3] = {radiance.r, radiance.g, radiance.b};
  if (hits.hit == 0) {
    for (float* channel : to) Floats::All(0).Store(channel);
    return;
  }
  const HitPoints at = PointsOf(hits);
  const LaneMaterials materials = MaterialsAt(scene, hits);
  const LaneView view = ViewAt(rays, at);
  LightSum sum(scene, rays, hits, materials, view);
  uint64_t again = 0;
  const LaneMask asked = hits.hit & materials.uses_lights;
  for (size_t i = 0; asked != 0 && i < scene.lights().size(); ++i) {
    PacketShadow shadow = shadows[i];
    shadow.lit &= asked;
    if (shadow.lit != 0) sum.Add(i, LightAt(scene, i, hits, at, asked, again), shadow);
  }
  for (int c = 0; c < 3; ++c) sum.sum()[c].Store(to[c]);
}

}  // namespace linetree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
