// plane_nodes.h for every target of Highway; which one runs is decided at run time.
//
// Everything ordinary is included here, before code for special targets is: nothing of it may be
// compiled for one.
#include "core/certify/plane_nodes.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/jet/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/certify/plane_nodes.cpp"
#include "hwy/foreach_target.h"
// After foreach_target.h.
#include "core/certify/plane_nodes-inl.h"
#include "hwy/highway.h"

#if HWY_ONCE
namespace linetree {

HWY_EXPORT(TakeLights);
HWY_EXPORT(AddPointLights);

void TakeLights(const PlaneView& plane, NodeLights& lights, TermSums& sums) {
  HWY_DYNAMIC_DISPATCH(TakeLights)(plane, lights, sums);
}
void AddPointLights(const NodePlaces& places, const NodeLights& lights, NodeSums& sums) {
  HWY_DYNAMIC_DISPATCH(AddPointLights)(places, lights, sums);
}

void NodeLights::Grow(size_t count) {
  const size_t blocks = (count + kBlock - 1) / kBlock;
  const size_t room = std::max<size_t>(4, 2 * blocks) * kBlock;
  // What lies beyond the last light is looked at with the others, and never taken.
  for (auto* column : {&x, &y, &z, &r, &g, &b}) column->resize(room);
  for (auto* bits : {&taken, &behind}) bits->resize(room / kBlock);
}

bool NodeLights::AreSettled(size_t count) const {
  for (size_t block = 0; block * kBlock < count; ++block) {
    const size_t lights = std::min(kBlock, count - block * kBlock);
    const unsigned all = (1u << lights) - 1;
    if (((taken[block] | behind[block]) & all) != all) return false;
  }
  return true;
}

Rgb TermSums::Lanes::Sum() const {
  Rgb sum;
  for (size_t i = 0; i < NodeLights::kBlock; ++i) sum += Rgb{r[i], g[i], b[i]};
  return sum;
}

LightReach ReachOf(const PlaneView& plane, const Vec3d& light) {
  const Vec3d away = light - plane.center;
  LightReach reach;
  reach.height = Dot(away, plane.normal);
  const double distance = Length(away);
  const double least_height = std::max(plane.slip, kLengthMargin * (distance + plane.radius));
  // Of a light in the plane itself rounding says which side it is on.
  if (reach.height <= -least_height) reach.side = LightReach::Side::kBehind;
  if (!(reach.height > least_height)) return reach;
  reach.nearest = std::max(reach.height, distance - plane.radius) * (1 - kLengthMargin);
  reach.farthest = (distance + plane.radius) * (1 + kLengthMargin);
  if (!(reach.nearest >= kLeastReach && reach.farthest <= kMostReach)) return reach;
  const double sizes = std::abs(light.x) + std::abs(light.y) + std::abs(light.z);
  reach.noise = (kHeightRounding * (plane.reach + sizes) + plane.slip) / reach.height;
  reach.side = LightReach::Side::kFront;
  return reach;
}

void TakeLightsScalar(const PlaneView& plane, NodeLights& lights, TermSums& sums) {
  size_t count = 0;
  for (size_t i = 0; i < lights.size; ++i) {
    const size_t lane = i % NodeLights::kBlock;
    uint8_t &taken = lights.taken[i / NodeLights::kBlock],
            &behind = lights.behind[i / NodeLights::kBlock];
    if (lane == 0) taken = behind = 0;
    const LightReach reach = ReachOf(plane, {lights.x[i], lights.y[i], lights.z[i]});
    if (reach.side == LightReach::Side::kBehind) behind |= static_cast<uint8_t>(1u << lane);
    if (reach.side != LightReach::Side::kFront) continue;
    const double most = 1 / reach.nearest, least = 1 / reach.farthest, square = most * most;
    const double error = plane.stretch * (24 * square * square * most) + reach.noise * most;
    if (!(error <= kMaxTermSpread * least)) continue;
    taken |= static_cast<uint8_t>(1u << lane);
    const auto add = [&](double strength, double& errors, double& leasts, double& mosts) {
      errors += strength * error;
      leasts += strength * least;
      mosts += strength * most;
      return strength;
    };
    lights.x[count] = lights.x[i];
    lights.y[count] = lights.y[i];
    lights.z[count] = lights.z[i];
    lights.r[count] =
        add(lights.r[i] * reach.height, sums.error.r[lane], sums.least.r[lane], sums.most.r[lane]);
    lights.g[count] =
        add(lights.g[i] * reach.height, sums.error.g[lane], sums.least.g[lane], sums.most.g[lane]);
    lights.b[count++] =
        add(lights.b[i] * reach.height, sums.error.b[lane], sums.least.b[lane], sums.most.b[lane]);
  }
  lights.size = count;
}

double InverseRoot(double x) {
  double y = std::bit_cast<double>(kInverseRootBits - (std::bit_cast<uint64_t>(x) >> 1));
  const double half = x * 0.5;
  for (int i = 0; i < kInverseRootSteps; ++i) y = y * (1.5 - half * y * y);
  return y;
}

void AddPointLightsScalar(const NodePlaces& places, const NodeLights& lights, NodeSums& sums) {
  for (size_t i = 0; i < lights.size; ++i) {
    for (size_t k = 0; k < kPlaneNodes; ++k) {
      const double dx = lights.x[i] - places.x[k], dy = lights.y[i] - places.y[k],
                   dz = lights.z[i] - places.z[k];
      const double inverse = InverseRoot(dx * dx + dy * dy + dz * dz);
      sums.r[k] += lights.r[i] * inverse;
      sums.g[k] += lights.g[i] * inverse;
      sums.b[k] += lights.b[i] * inverse;
    }
  }
}

}  // namespace linetree
#endif
