#include "core/packet/packet_tracer.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "core/packet/packet_kernels.h"
#include "core/packet/packet_scene.h"
#include "core/packet/topology.h"
#include "core/trace/shade.h"

namespace linetree {
namespace {

// Calls fn(lane) for every lane of the mask.
template <class Fn>
void ForLanes(LaneMask lanes, Fn&& fn) {
  for (; lanes != 0; lanes &= lanes - 1) fn(std::countr_zero(lanes));
}

double LargestExponent(const Scene& scene) {
  double largest = 0;
  for (const Material& material : scene.materials) {
    if (!IsBlack(material.specular)) largest = std::max(largest, material.exponent);
  }
  return largest;
}

// The scalar twins, for scenes that do not fit float.
void FindHitsScalar(const Tracer& tracer, const PacketRays& rays, PacketHits& hits,
                    PacketCounts& counts) {
  hits.hit = hits.inside = hits.first_on_line = 0;
  ForLanes(rays.active, [&](int lane) {
    hits.Set(lane,
             tracer.Intersect(rays.origin.At(lane), rays.direction.At(lane), rays.StartAt(lane)));
    ++counts.hits_again;
    ++counts.rays.intersect;
  });
  ++counts.packets;
}

void CastShadowsScalar(const Tracer& tracer, const PacketHits& hits, LaneMask lanes, int light,
                       PacketShadow& shadow, PacketCounts& counts) {
  shadow.facing = shadow.lit = shadow.filtered = 0;
  const Light& from = tracer.scene().lights[static_cast<size_t>(light)];
  ForLanes(lanes & hits.hit, [&](int lane) {
    const Hit hit = hits.At(lane);
    if (!(Dot(hit.normal, ViewOf(from, hit.point).to_light) > 0)) return;
    const LaneMask bit = LaneMask{1} << lane;
    shadow.facing |= bit;
    ++counts.rays.shadow;
    ++counts.rays.intersect;
    ++counts.shadows_again;
    const auto cast = tracer.CastShadow(hit.point, light, {hit.object, hit.face, hit.side});
    if (cast.term.state != LightState::kLit) return;
    shadow.lit |= bit;
    if (cast.term.crossings != 0) shadow.filtered |= bit;
    for (int c = 0; c < 3; ++c) shadow.filter[c][lane] = static_cast<float>(cast.filter[c]);
  });
}

Rgb ShadeScalar(const Scene& scene, const Hit& hit, const Vec3d& direction, int lane,
                std::span<const PacketShadow> shadows) {
  const Material& material = scene.MaterialOf(hit.object);
  Rgb sum = AmbientTerm<double>(material, scene.ambient);
  if (!UsesLights(material)) return sum;
  for (size_t i = 0; i < scene.lights.size(); ++i) {
    const PacketShadow& shadow = shadows[i];
    if ((shadow.lit >> lane & 1) == 0) continue;
    const auto view = ViewOf(scene.lights[i], hit.point);
    Rgb term = LightTermRadiance(material, scene.lights[i], view, Dot(hit.normal, view.to_light),
                                 hit.normal, -direction);
    if ((shadow.filtered >> lane & 1) != 0) {
      for (int c = 0; c < 3; ++c) term[c] *= static_cast<double>(shadow.filter[c][lane]);
    }
    sum += term;
  }
  return sum;
}

void SetLane(PacketRgb& radiance, int lane, const Rgb& value) {
  radiance.r[lane] = static_cast<float>(value.r);
  radiance.g[lane] = static_cast<float>(value.g);
  radiance.b[lane] = static_cast<float>(value.b);
}

void RenderScalar(const Tracer& tracer, const BlockTask& task, PacketCounts& counts) {
  const auto& [column, row, width, height] = task.region;
  RayTree tree;
  for (int y = row; y < row + height; ++y) {
    for (int x = column; x < column + width; ++x) {
      const Ray ray = task.eye_rays.ThroughPixel(x, y);
      const size_t at = static_cast<size_t>(y) * task.stride + static_cast<size_t>(x);
      const PixelTarget& target = task.target;
      const bool digested = target.topology != nullptr;
      const Hit hit = tracer.Intersect(ray.origin, ray.direction, RayStart{});
      ++counts.rays.eye;
      ++counts.rays.intersect;
      ++counts.hits_again;
      const Rgb rgb = tracer.RadianceFromHit(hit, ray.origin, ray.direction, task.limits,
                                             counts.rays, digested ? &tree : nullptr);
      for (int c = 0; c < 3; ++c) {
        target.radiance[3 * at + static_cast<size_t>(c)] = static_cast<float>(rgb[c]);
      }
      if (digested) target.topology[at] = TopologyDigest(tree);
      if (target.object != nullptr) target.object[at] = hit.object;
      if (target.depth != nullptr) {
        target.depth[at] =
            hit.IsHit() ? static_cast<float>(hit.t) : std::numeric_limits<float>::infinity();
      }
    }
  }
}

}  // namespace

PacketTracer::PacketTracer(const Tracer& tracer, bool sees_squares)
    : tracer_(tracer),
      scene_(std::make_unique<const PacketScene>(tracer)),
      radiance_rounding_(PacketRadianceRounding(LargestExponent(tracer.scene()))),
      sees_squares_(sees_squares) {}
PacketTracer::~PacketTracer() = default;

size_t PacketTracer::ByteSize() const {
  return sizeof(PacketTracer) + sizeof(PacketScene) + scene_->ByteSize();
}
bool PacketTracer::IsWide() const { return scene_->usable() && HaveWideKernels(); }

void PacketTracer::EyePacket(const EyeRays& eye_rays, int column, int row, PacketRays& rays) const {
  if (HaveWideKernels()) {
    EyePacketWide(eye_rays, column, row, rays);
    return;
  }
  rays.active = rays.start_inside = 0;
  for (int lane = 0; lane < kPacketLanes; ++lane) {
    const int x = column + lane % 4, y = row + lane / 4;
    const Ray ray = eye_rays.ThroughPixel(x, y);
    rays.SetRay(lane, ray.origin, ray.direction, RayStart{});
    if (x >= eye_rays.width() || y >= eye_rays.height()) rays.active &= ~(LaneMask{1} << lane);
  }
}

void PacketTracer::FindHits(const PacketRays& rays, PacketHits& hits, PacketCounts& counts) const {
  if (IsWide()) {
    FindHitsWide(*scene_, rays, hits, counts);
  } else {
    FindHitsScalar(tracer_, rays, hits, counts);
  }
}

void PacketTracer::CastShadows(const PacketHits& hits, LaneMask lanes, int light,
                               PacketWorkspace& workspace, PacketShadow& shadow,
                               PacketCounts& counts) const {
  if (IsWide()) {
    CastShadowsWide(*scene_, hits, lanes, light, workspace, shadow, counts);
  } else {
    CastShadowsScalar(tracer_, hits, lanes, light, shadow, counts);
  }
}

void PacketTracer::Shade(const PacketRays& rays, const PacketHits& hits,
                         std::span<const PacketShadow> shadows, PacketRgb& radiance) const {
  if (IsWide()) {
    ShadeWide(*scene_, rays, hits, shadows, radiance);
    return;
  }
  radiance = {};
  ForLanes(hits.hit, [&](int lane) {
    SetLane(radiance, lane,
            ShadeScalar(tracer_.scene(), hits.At(lane), rays.direction.At(lane), lane, shadows));
  });
}

void PacketTracer::Radiance(const PacketRays& rays, const PathLimits& limits,
                            PacketWorkspace& workspace, PacketRgb& radiance,
                            PacketCounts& counts) const {
  if (IsWide()) {
    RadianceWide(*scene_, rays, limits, workspace, radiance, counts);
    return;
  }
  radiance = {};
  ForLanes(rays.active, [&](int lane) {
    ++counts.hits_again;
    SetLane(radiance, lane,
            tracer_.Radiance(rays.origin.At(lane), rays.direction.At(lane), limits, counts.rays));
  });
}

void PacketTracer::RenderRegion(const EyeRays& eye_rays, const Region& region,
                                const PathLimits& limits, size_t stride, const PixelTarget& target,
                                PacketWorkspace& workspace, PacketCounts& counts) const {
  for (int y = 0; y < region.height; y += kBlockSide) {
    for (int x = 0; x < region.width; x += kBlockSide) {
      const Region block = {region.column + x, region.row + y,
                            std::min(kBlockSide, region.width - x),
                            std::min(kBlockSide, region.height - y)};
      const BlockTask task = {eye_rays, block, limits, stride, target, sees_squares_};
      if (IsWide()) {
        RenderBlockWide(*scene_, task, workspace, counts);
      } else {
        RenderScalar(tracer_, task, counts);
      }
    }
  }
}

}  // namespace linetree
