// plane_nodes.h on the vectors of one of Highway's targets. Included by plane_nodes.cpp.
#if defined(LINETREE_CORE_CERTIFY_PLANE_NODES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_CERTIFY_PLANE_NODES_INL_H_
#undef LINETREE_CORE_CERTIFY_PLANE_NODES_INL_H_
#else
#define LINETREE_CORE_CERTIFY_PLANE_NODES_INL_H_
#endif

#include "core/certify/plane_nodes.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace linetree::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using LightTag = hn::CappedTag<double, NodeLights::kBlock>;
using LightVector = hn::Vec<LightTag>;

// What TakeLights finds out of as many lights as a vector holds.
struct FoundLights {
  LightVector height, error, least, most;
  hn::Mask<LightTag> taken, behind;
};
inline FoundLights FindLights(const PlaneView& plane, const LightVector x, const LightVector y,
                              const LightVector z) {
  const LightTag d;
  const auto all = [&](double value) { return hn::Set(d, value); };
  const auto dot = [](const auto& a, const auto& b) {
    return hn::Add(hn::Add(hn::Mul(a[0], b[0]), hn::Mul(a[1], b[1])), hn::Mul(a[2], b[2]));
  };
  const LightVector away[3] = {hn::Sub(x, all(plane.center.x)), hn::Sub(y, all(plane.center.y)),
                               hn::Sub(z, all(plane.center.z))};
  const LightVector normal[3] = {all(plane.normal.x), all(plane.normal.y), all(plane.normal.z)};
  FoundLights found;
  found.height = dot(away, normal);
  const auto distance = hn::Sqrt(dot(away, away)), radius = all(plane.radius);
  const auto span = hn::Add(distance, radius), slip = all(plane.slip);
  const auto least_height = hn::Max(slip, hn::Mul(all(kLengthMargin), span));
  const auto nearest =
      hn::Mul(hn::Max(found.height, hn::Sub(distance, radius)), all(1 - kLengthMargin));
  const auto farthest = hn::Mul(span, all(1 + kLengthMargin));
  const auto sizes = hn::Add(hn::Add(hn::Abs(x), hn::Abs(y)), hn::Abs(z));
  const auto rounding = hn::Mul(all(kHeightRounding), hn::Add(all(plane.reach), sizes));
  const auto noise = hn::Div(hn::Add(rounding, slip), found.height);
  found.most = hn::Div(all(1), nearest);
  found.least = hn::Div(all(1), farthest);
  const auto square = hn::Mul(found.most, found.most);
  const auto fourth = hn::Mul(hn::Mul(hn::Mul(all(24), square), square), found.most);
  found.error = hn::Add(hn::Mul(all(plane.stretch), fourth), hn::Mul(noise, found.most));
  const auto is_ordinary =
      hn::And(hn::Ge(nearest, all(kLeastReach)), hn::Le(farthest, all(kMostReach)));
  const auto is_good = hn::Le(found.error, hn::Mul(all(kMaxTermSpread), found.least));
  found.taken = hn::And(hn::Gt(found.height, least_height), hn::And(is_ordinary, is_good));
  found.behind = hn::Le(found.height, hn::Neg(least_height));
  return found;
}

// One channel of those that are taken: their strengths go to `to`, their terms to the lanes. Where
// all are, nothing moves within the vector.
inline void TakeChannel(const FoundLights& found, bool is_whole, const double* irradiance,
                        double* to, double* errors, double* leasts, double* mosts) {
  const LightTag d;
  const auto strength = hn::Mul(hn::LoadU(d, irradiance), found.height);
  const auto kept = hn::IfThenElseZero(found.taken, strength);
  if (is_whole) {
    hn::StoreU(strength, d, to);
  } else {
    hn::CompressStore(strength, found.taken, d, to);
  }
  const auto add = [&](double* lanes, const LightVector share) {
    // Not a product of what is not taken, which may be infinite.
    const auto term = hn::IfThenElseZero(found.taken, hn::Mul(kept, share));
    hn::StoreU(hn::Add(hn::LoadU(d, lanes), term), d, lanes);
  };
  add(errors, found.error);
  add(leasts, found.least);
  add(mosts, found.most);
}

// Those that are taken move to the front, never past one that is still to be looked at: whole
// vectors may be written there.
inline void TakeLights(const PlaneView& plane, NodeLights& lights, TermSums& sums) {
  const LightTag d;
  const size_t lanes = hn::Lanes(d);
  size_t count = 0;
  for (size_t at = 0; at < lights.size; at += lanes) {
    const size_t block = at / NodeLights::kBlock, lane = at % NodeLights::kBlock;
    const auto x = hn::LoadU(d, &lights.x[at]), y = hn::LoadU(d, &lights.y[at]),
               z = hn::LoadU(d, &lights.z[at]);
    FoundLights found = FindLights(plane, x, y, z);
    const auto is_light = hn::FirstN(d, lights.size - at);
    found.taken = hn::And(found.taken, is_light);
    uint8_t taken = 0, behind = 0;
    hn::StoreMaskBits(d, found.taken, &taken);
    hn::StoreMaskBits(d, hn::And(found.behind, is_light), &behind);
    if (lane == 0) lights.taken[block] = lights.behind[block] = 0;
    lights.taken[block] |= static_cast<uint8_t>(taken << lane);
    lights.behind[block] |= static_cast<uint8_t>(behind << lane);
    if (taken == 0) continue;
    const bool is_whole = hn::AllTrue(d, found.taken);
    if (!is_whole || count != at) {
      hn::CompressStore(x, found.taken, d, &lights.x[count]);
      hn::CompressStore(y, found.taken, d, &lights.y[count]);
      hn::CompressStore(z, found.taken, d, &lights.z[count]);
    }
    TakeChannel(found, is_whole, &lights.r[at], &lights.r[count], &sums.error.r[lane],
                &sums.least.r[lane], &sums.most.r[lane]);
    TakeChannel(found, is_whole, &lights.g[at], &lights.g[count], &sums.error.g[lane],
                &sums.least.g[lane], &sums.most.g[lane]);
    TakeChannel(found, is_whole, &lights.b[at], &lights.b[count], &sums.error.b[lane],
                &sums.least.b[lane], &sums.most.b[lane]);
    count += hn::CountTrue(d, found.taken);
  }
  lights.size = count;
}

// As the scalar one, operation by operation.
template <class D>
HWY_INLINE hn::Vec<D> InverseRoot(D d, hn::Vec<D> x) {
  const hn::RebindToUnsigned<D> du;
  const auto half = hn::Mul(x, hn::Set(d, 0.5));
  const auto bits = hn::ShiftRight<1>(hn::BitCast(du, x));
  auto y = hn::BitCast(d, hn::Sub(hn::Set(du, kInverseRootBits), bits));
  for (int i = 0; i < kInverseRootSteps; ++i) {
    y = hn::Mul(y, hn::Sub(hn::Set(d, 1.5), hn::Mul(hn::Mul(half, y), y)));
  }
  return y;
}

// A vector of nodes, under all lights.
inline void AddPointLights(const NodePlaces& places, const NodeLights& lights, NodeSums& sums) {
  const hn::CappedTag<double, kPlaneNodes> d;
  for (size_t k = 0; k < kPlaneNodes; k += hn::Lanes(d)) {
    const auto x = hn::LoadU(d, &places.x[k]);
    const auto y = hn::LoadU(d, &places.y[k]);
    const auto z = hn::LoadU(d, &places.z[k]);
    auto r = hn::LoadU(d, &sums.r[k]);
    auto g = hn::LoadU(d, &sums.g[k]);
    auto b = hn::LoadU(d, &sums.b[k]);
    for (size_t i = 0; i < lights.size; ++i) {
      const auto dx = hn::Sub(hn::Set(d, lights.x[i]), x);
      const auto dy = hn::Sub(hn::Set(d, lights.y[i]), y);
      const auto dz = hn::Sub(hn::Set(d, lights.z[i]), z);
      const auto square = hn::Add(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)), hn::Mul(dz, dz));
      const auto inverse = InverseRoot(d, square);
      r = hn::Add(r, hn::Mul(hn::Set(d, lights.r[i]), inverse));
      g = hn::Add(g, hn::Mul(hn::Set(d, lights.g[i]), inverse));
      b = hn::Add(b, hn::Mul(hn::Set(d, lights.b[i]), inverse));
    }
    hn::StoreU(r, d, &sums.r[k]);
    hn::StoreU(g, d, &sums.g[k]);
    hn::StoreU(b, d, &sums.b[k]);
  }
}

}  // namespace linetree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
