#include "tests/packet/crossing_bounds.h"

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
#include "core/packet/packet_kernels.h"
#include "core/packet/packet_shape.h"
#include "core/packet/topology.h"
#include "core/trace/intersect.h"
#include "core/trace/shade.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/packet/crossing_bounds.cpp"
#include "hwy/foreach_target.h"
// After foreach_target.h.
#include "hwy/highway.h"
#if HWY_TARGET != HWY_SCALAR
#include "core/packet/hits-inl.h"
#include "core/packet/shade-inl.h"
#endif

HWY_BEFORE_NAMESPACE();
namespace linetree::HWY_NAMESPACE {

#if HWY_TARGET != HWY_SCALAR
void Put(const LaneCrossing& crossing, test::CrossingBounds& bounds) {
  bounds.maybe = BitsOf(crossing.maybe);
  bounds.sure = BitsOf(crossing.sure);
  crossing.low.Store(bounds.low.data());
  crossing.high.Store(bounds.high.data());
}

FloatRays LinesOf(const PacketScene& scene, const PacketRays& rays) {
  FloatRays lines;
  lines.o = Filled(Demoted(Load(rays.origin) - Spread(scene.reference())), rays.active);
  lines.d = Filled(Demoted(Load(rays.direction)), rays.active);
  lines.size = SizeOf(BoundsOf(lines.o)) + scene.least_length();
  return lines;
}

bool CrossingBoundsOf(const PacketScene& scene, int shape, const PacketRays& rays,
                      std::array<test::CrossingBounds, 2>& bounds) {
  bounds = {};
  FloatRays lines = LinesOf(scene, rays);
  LaneCrossings c;
  const PacketShape& met = scene.shapes()[static_cast<size_t>(shape)];
  if (!Meet<false>(scene, met, lines, Floats::All(kFarAway), MaskOf(rays.active), c)) return true;
  Put(c.in, bounds[0]);
  Put(c.out, bounds[1]);
  return true;
}

void PutNearest(const PacketScene& scene, int ball, const FloatRays& lines,
                test::NearestPoints& nearest) {
  const PacketShape& shape = scene.shapes()[static_cast<size_t>(ball)];
  const auto [t, from] = NearestTo(lines, shape.center);
  t.Store(nearest.t.data());
  from.x.Store(nearest.x.data());
  from.y.Store(nearest.y.data());
  from.z.Store(nearest.z.data());
  nearest.size = lines.size + shape.reach;
}
bool NearestOfRays(const PacketScene& scene, int ball, const PacketRays& rays,
                   test::NearestPoints& nearest) {
  PutNearest(scene, ball, LinesOf(scene, rays), nearest);
  return true;
}
bool NearestOfShadows(const PacketScene& scene, int ball, const PacketHits& hits,
                      test::NearestPoints& nearest) {
  const HitPoints at = PointsOf(hits);
  uint64_t again = 0;
  const LaneLight seen = LightAt(scene, 0, hits, at, hits.hit, again);
  NeedBounds(scene, at);
  FloatRays lines;
  lines.o = at.from;
  lines.d = seen.to_light;
  lines.size = at.size;
  PutNearest(scene, ball, lines, nearest);
  return true;
}
#else
bool CrossingBoundsOf(const PacketScene&, int, const PacketRays&,
                      std::array<test::CrossingBounds, 2>&) {
  return false;
}
bool NearestOfRays(const PacketScene&, int, const PacketRays&, test::NearestPoints&) {
  return false;
}
bool NearestOfShadows(const PacketScene&, int, const PacketHits&, test::NearestPoints&) {
  return false;
}
#endif

}  // namespace linetree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace linetree {

HWY_EXPORT(CrossingBoundsOf);
HWY_EXPORT(NearestOfRays);
HWY_EXPORT(NearestOfShadows);

bool test::FindCrossingBounds(const PacketScene& scene, int shape, const PacketRays& rays,
                              std::array<CrossingBounds, 2>& bounds) {
  return HWY_DYNAMIC_DISPATCH(CrossingBoundsOf)(scene, shape, rays, bounds);
}
bool test::FindNearestPoints(const PacketScene& scene, int ball, const PacketRays& rays,
                             NearestPoints& nearest) {
  return HWY_DYNAMIC_DISPATCH(NearestOfRays)(scene, ball, rays, nearest);
}
bool test::FindNearestPoints(const PacketScene& scene, int ball, const PacketHits& hits,
                             NearestPoints& nearest) {
  return HWY_DYNAMIC_DISPATCH(NearestOfShadows)(scene, ball, hits, nearest);
}

}  // namespace linetree
#endif
