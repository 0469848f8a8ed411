// plane_nodes.h for every target of Highway; which one runs is decided at run time.
//
// Everything ordinary is included here, before code for special targets is: nothing of it may be
// compiled for one.
#include "core/certify/plane_nodes.h"

#include <cmath>

#include "core/jet/simd_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/certify/plane_nodes.cpp"
#include "hwy/foreach_target.h"
// After foreach_target.h.
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace linetree::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// A vector of nodes, under all lights.
void AddPointLights(const NodePlaces& places, std::span<const NodeLight> lights, NodeSums& sums) {
  const hn::CappedTag<double, kPlaneNodes> d;
  const auto one = hn::Set(d, 1.0);
  for (size_t k = 0; k < kPlaneNodes; k += hn::Lanes(d)) {
    const auto x = hn::LoadU(d, &places.x[k]);
    const auto y = hn::LoadU(d, &places.y[k]);
    const auto z = hn::LoadU(d, &places.z[k]);
    auto r = hn::LoadU(d, &sums.r[k]);
    auto g = hn::LoadU(d, &sums.g[k]);
    auto b = hn::LoadU(d, &sums.b[k]);
    for (const NodeLight& light : lights) {
      const auto dx = hn::Sub(hn::Set(d, light.position.x), x);
      const auto dy = hn::Sub(hn::Set(d, light.position.y), y);
      const auto dz = hn::Sub(hn::Set(d, light.position.z), z);
      const auto square = hn::Add(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)), hn::Mul(dz, dz));
      const auto inverse = hn::Div(one, hn::Sqrt(square));
      r = hn::Add(r, hn::Mul(hn::Set(d, light.strength.r), inverse));
      g = hn::Add(g, hn::Mul(hn::Set(d, light.strength.g), inverse));
      b = hn::Add(b, hn::Mul(hn::Set(d, light.strength.b), inverse));
    }
    hn::StoreU(r, d, &sums.r[k]);
    hn::StoreU(g, d, &sums.g[k]);
    hn::StoreU(b, d, &sums.b[k]);
  }
}

}  // namespace linetree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace linetree {

HWY_EXPORT(AddPointLights);

void AddPointLights(const NodePlaces& places, std::span<const NodeLight> lights, NodeSums& sums) {
  HWY_DYNAMIC_DISPATCH(AddPointLights)(places, lights, sums);
}

void AddPointLightsScalar(const NodePlaces& places, std::span<const NodeLight> lights,
                          NodeSums& sums) {
  for (const NodeLight& light : lights) {
    for (size_t k = 0; k < kPlaneNodes; ++k) {
      const Vec3d segment = light.position - Vec3d{places.x[k], places.y[k], places.z[k]};
      const double inverse =
          1 / std::sqrt(segment.x * segment.x + segment.y * segment.y + segment.z * segment.z);
      sums.r[k] += light.strength.r * inverse;
      sums.g[k] += light.strength.g * inverse;
      sums.b[k] += light.strength.b * inverse;
    }
  }
}

}  // namespace linetree
#endif
