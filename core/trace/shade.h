// The shading formula's terms (DESIGN: scene and shading), as pure functions: whoever evaluates a
// term again, from the same arguments, gets the same bits.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/math/rgb.h"
#include "core/math/vec3.h"
#include "core/scene/light.h"
#include "core/scene/material.h"

namespace linetree {

// Rounding of this file's functions against the same formulas in exact arithmetic on the same
// arguments, unit vectors up to their own rounding; u = 2^-53.
// ViewOf: every component of to_light, relative: one u for the segment, 5 for its length; and the
// fall-off, whose distance has 3.5 u that are raised to a power of 8 at most, besides its own 12.
inline constexpr double kToLightRounding = 0x1p-50;
inline constexpr double kViewFallOffRounding = 0x1p-47;
// Highlight, absolute, times 1 + exponent: 8 u for n.h (1 sum, 3 product, 2.5 length, 1 quotient),
// which the power magnifies by the exponent, and 2 for pow.
inline constexpr double kHighlightRounding = 0x1p-49;
// Reflected, length of the difference: 3 u of n.d count twice, 2 for the product, 1 for the sum.
inline constexpr double kReflectedRounding = 0x1p-49;
// Refracted, with eta = ior_from / ior_into: whether the reflection is total may be wrong only
// where the square of the transmitted ray's cosine c is within kRefractedRounding * (1 + eta^2) of
// 0 (16 u: 8 of 1 - cos^2, 4 of eta^2, 1 of the sum, and the normal's own length); the direction is
// off by at most the same over c.
inline constexpr double kRefractedRounding = 0x1p-48;

// How a light is seen from a point.
template <class S>
struct LightView {
  Vec3<S> to_light;  // unit; zero where the light itself is, which faces nothing
  S fall_off;        // factor on Light::irradiance
};

// Below this distance the squares of its components lose bits to underflow, in the end all of them.
// At 2^-484 the square is 2^-968: its last bit is 2^-1021, a normal number.
inline constexpr double kNearLight = 0x1p-484;

template <class S>
LightView<S> ViewOf(const Light& light, const Vec3<S>& point) {
  if (light.kind == LightKind::kDirectional) return {CastVec3<S>(light.to_light), S(1)};
  const Vec3<S> segment = -(point - light.position);
  const S distance = Length(segment);
  if (distance < kNearLight) {
    // Scaled up by a power of two, which is exact.
    const Vec3<S> scaled = segment * S(0x1p+600);
    const S length = Length(scaled);
    const Vec3<S> to_light = length > 0 ? scaled * (S(1) / length) : Vec3<S>{};
    return {to_light, FallOff(light, S(length * S(0x1p-600)))};
  }
  return {segment * (S(1) / distance), FallOff(light, distance)};
}

// Whether a material answers to lights at all.
inline bool UsesLights(const Material& material) {
  return !IsBlack(material.diffuse) || !IsBlack(material.specular);
}

template <class S>
RgbOf<S> AmbientTerm(const Material& material, const Rgb& ambient) {
  return Scaled(material.ambient * ambient, S(1));
}

// (n.h)^exponent with n.h clamped to [0, 1], h halfway between the unit vectors l and v.
template <class S>
S Highlight(double exponent, const Vec3<S>& n, const Vec3<S>& l, const Vec3<S>& v) {
  using std::pow;
  const Vec3<S> sum = l + v;
  const S length = Length(sum);
  if (!(length > 0)) return S(0);
  return pow(std::clamp(S(Dot(n, sum) / length), S(0), S(1)), S(exponent));
}

// E_l ( kd (n.l) + ks (n.h)^m ) for cosine = n.l > 0, before the filter V_l.
template <class S>
RgbOf<S> LightTermRadiance(const Material& material, const Light& light, const LightView<S>& view,
                           const S& cosine, const Vec3<S>& n, const Vec3<S>& v) {
  RgbOf<S> reflectance = Scaled(material.diffuse, cosine);
  if (!IsBlack(material.specular)) {
    reflectance += Scaled(material.specular, Highlight(material.exponent, n, view.to_light, v));
  }
  return Scaled(light.irradiance, view.fall_off) * reflectance;
}

// The highlight's part of it.
template <class S>
RgbOf<S> HighlightRadiance(const Material& material, const Light& light, const LightView<S>& view,
                           const Vec3<S>& n, const Vec3<S>& v) {
  return Scaled(light.irradiance, view.fall_off) *
         Scaled(material.specular, Highlight(material.exponent, n, view.to_light, v));
}

// Mirror direction of unit d about unit n.
template <class S>
Vec3<S> Reflected(const Vec3<S>& d, const Vec3<S>& n) {
  return d - n * (S(2) * Dot(n, d));
}

// Snell's direction of unit d at unit normal n (n.d <= 0), from index ior_from into ior_into;
// nothing under total internal reflection.
template <class S>
std::optional<Vec3<S>> Refracted(const Vec3<S>& d, const Vec3<S>& n, double ior_from,
                                 double ior_into) {
  using std::sqrt;
  if (ior_from == ior_into) return d;
  const S eta = S(ior_from) / S(ior_into);
  const S cosine = -Dot(n, d);
  const S squared = S(1) - eta * eta * (S(1) - cosine * cosine);
  if (squared < 0) return std::nullopt;
  return d * eta + n * (eta * cosine - sqrt(squared));
}

}  // namespace linetree
