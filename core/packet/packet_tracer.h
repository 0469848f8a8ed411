// The classical tracer sixteen rays wide: the baseline of every speed figure and what frames fall
// back on.
//
// It decides in float and finishes in double. The search for what a ray meets runs in float with
// margins for everything that rounding may do (margins.h); a lane for which another outcome is
// possible is decided again by the scalar Tracer. The hit itself is computed in double, with the
// operations of Tracer in their order. So hits, spawned rays and light states are those of the
// scalar tracer, bit by bit, on every target, and ray trees cannot differ. Radiance is summed in
// float: see PacketRadianceRounding.
//
// Which instruction set runs is decided at run time (Highway).
#pragma once

#include <memory>
#include <span>

#include "core/packet/packet.h"
#include "core/packet/packet_workspace.h"
#include "core/scene/camera.h"
#include "core/trace/tracer.h"

namespace linetree {

class PacketScene;

// |packet - scalar| <= PacketRadianceRounding(m) * max(scalar, RadianceFloor(scene)) per channel,
// with m the largest exponent of a highlight in the scene and u = 2^-24. All terms are sums and
// products of what is not negative, so relative errors do not grow but add along a path:
//   * a light's term: 4 u for n.l, 8 for its distance and fall-off (magnified by a power of at most
//     8), 8 for colours, filter and sums: below 96 u;
//   * a highlight: 20 u of n.h count m times, and 6 u times the power's logarithm, which is at most
//     24 where the power counts: below 160 u;
//   * on the way to the eye: at most 4 u for each of up to 16 bounces.
inline double PacketRadianceRounding(double largest_exponent) {
  return 0x1p-24 * (320 + 24 * largest_exponent);
}

// Where the pixels of an image are traced to, row by row; any pointer may be null but `radiance`.
struct PixelTarget {
  float* radiance = nullptr;  // 3 per pixel
  int32_t* object = nullptr;  // kNoObject for the background
  // Distance along the eye ray, infinity for the background. Of tiles whose hits were not computed
  // (frames above epsilon 0) within 2^-20 of it.
  float* depth = nullptr;
  uint64_t* topology = nullptr;  // digests of the ray trees, see TopologyDigest
};

class PacketTracer {
 public:
  // Keeps a reference to the tracer, which must outlive it. `sees_squares`: whether squares of
  // pixels are looked at as a whole before their eye rays are searched for; no result depends on
  // it.
  explicit PacketTracer(const Tracer& tracer, bool sees_squares = true);
  ~PacketTracer();

  const Tracer& tracer() const { return tracer_; }
  const PacketScene& scene() const { return *scene_; }
  size_t ByteSize() const;
  // Whether the scene fits float; if not, every lane is traced by the scalar tracer.
  bool IsWide() const;
  bool sees_squares() const { return sees_squares_; }
  // PacketRadianceRounding of the scene's sharpest highlight.
  double radiance_rounding() const { return radiance_rounding_; }

  // The eye rays of sixteen pixels, 4 by 4, of which (column, row) is the top left one; those
  // outside the image are not active. Bit by bit EyeRays::ThroughPixel.
  void EyePacket(const EyeRays& eye_rays, int column, int row, PacketRays& rays) const;

  // What the active lanes meet.
  void FindHits(const PacketRays& rays, PacketHits& hits, PacketCounts& counts) const;

  // The light as seen from those of `lanes` that hit something (any materials). Counts the shadow
  // rays of lanes that face the light.
  void CastShadows(const PacketHits& hits, LaneMask lanes, int light, PacketWorkspace& workspace,
                   PacketShadow& shadow, PacketCounts& counts) const;

  // Ambient light and the sum over all lights of E_l V_l (kd (n.l) + ks (n.h)^m) in the lanes that
  // hit something; 0 elsewhere. `shadows`: one for every light of the scene; where a material
  // answers to no light they are not looked at.
  void Shade(const PacketRays& rays, const PacketHits& hits, std::span<const PacketShadow> shadows,
             PacketRgb& radiance) const;

  // Radiance along the active rays, as eye rays; 0 in the others.
  void Radiance(const PacketRays& rays, const PathLimits& limits, PacketWorkspace& workspace,
                PacketRgb& radiance, PacketCounts& counts) const;

  // The pixels [column, column + width) x [row, row + height) of the image. The target is the whole
  // image's, `stride` pixels a row.
  struct Region {
    int column = 0, row = 0, width = 0, height = 0;
  };
  void RenderRegion(const EyeRays& eye_rays, const Region& region, const PathLimits& limits,
                    size_t stride, const PixelTarget& target, PacketWorkspace& workspace,
                    PacketCounts& counts) const;

 private:
  const Tracer& tracer_;
  const std::unique_ptr<const PacketScene> scene_;
  const double radiance_rounding_;
  const bool sees_squares_;
};

}  // namespace linetree
