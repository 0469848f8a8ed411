// Spheres (ellipsoids) and frustums (cylinders, cones), in their object frames.
//
// Both are quadratic forms F(t) = a t^2 + 2 b t + c along a line, F < 0 inside. Where F crosses
// zero downwards the line enters, upwards it leaves:
//   t_in = (-b - s) / a,  t_out = (-b + s) / a,  s = sqrt(b^2 - a c), whatever the sign of a.
// The discriminant is never computed as b^2 - a c, which cancels, but as a sum of squares of
// components of p x q (Lagrange's identity). With a taper one of the squares is subtracted, and
// they grow with |p|^2: there p is taken where the line is nearest to the object first. From a
// start on the surface (c = 0) the other root is -2 b / a exactly.
#pragma once

#include <cmath>

#include "core/trace/crossings.h"

namespace linetree {

template <class S>
struct QuadraticRoots {
  S in, out;
};

// The roots as above without cancellation: the larger -b -+ s first, the other by Vieta.
template <class S>
QuadraticRoots<S> StableRoots(const S& a, const S& b, const S& c, const S& s) {
  if (b >= 0) {
    const S k = -(b + s);
    return k == 0 ? QuadraticRoots<S>{S(0), S(0)} : QuadraticRoots<S>{k / a, c / k};
  }
  const S k = s - b;
  return {c / k, k / a};
}

template <class S>
Crossings<S> LineCrossings(const SphereShape& shape, const Vec3<S>& origin,
                           const Vec3<S>& direction) {
  using std::sqrt;
  const auto [p, q] = ToObject(shape.frame, origin, direction);
  const S a = LengthSquared(q);
  const S discriminant = a - LengthSquared(Cross(p, q));
  Crossings<S> crossings;
  if (!(discriminant >= 0)) return crossings;
  const auto [in, out] =
      StableRoots(a, S(Dot(p, q)), S(LengthSquared(p) - S(1)), S(sqrt(discriminant)));
  // Nearly equal roots may come out in the wrong order.
  crossings.Add(in < out ? in : out, 0, Side::kOutside);
  crossings.Add(out, 0, Side::kInside);
  return crossings;
}

template <class S>
Crossing<S> ExitCrossing(const SphereShape& shape, const Vec3<S>& origin, const Vec3<S>& direction,
                         int face) {
  const auto [p, q] = ToObject(shape.frame, origin, direction);
  Chord<S> chord;
  chord.Leave(S(-2) * Dot(p, q) / LengthSquared(q), face);
  return chord.Exit(face);
}

// Frustum faces.
inline constexpr int kLateralFace = 0, kBaseFace = 1, kTopFace = 2;

// A frustum's lateral form along a line: F = x^2 + y^2 - w^2 with w = w(z).
template <class S>
struct LateralForm {
  S a, b, c, discriminant;
  S slope;  // dw/dt
};
template <class S>
LateralForm<S> LateralFormOf(const FrustumShape& shape, const ObjectLine<S>& line) {
  const auto& [p, q] = line;
  const double taper = shape.top_radius - shape.base_radius;
  const S w = S(shape.base_radius) + S(taper) * p.z;
  const S slope = S(taper) * q.z;
  const S xw = p.x * slope - w * q.x;
  const S yw = p.y * slope - w * q.y;
  const S xy = p.x * q.y - p.y * q.x;
  return {q.x * q.x + q.y * q.y - slope * slope, p.x * q.x + p.y * q.y - w * slope,
          p.x * p.x + p.y * p.y - w * w, xw * xw + yw * yw - xy * xy, slope};
}

// The form of the whole line from its point nearest to the base's centre, which lies at t = from.
template <class S>
struct WholeLateralForm {
  LateralForm<S> form;
  S from;
};
template <class S>
WholeLateralForm<S> WholeLateralFormOf(const FrustumShape& shape, const ObjectLine<S>& line) {
  const S square = LengthSquared(line.q);
  const S from = square > 0 ? S(-Dot(line.p, line.q) / square) : S(0);
  return {LateralFormOf(shape, ObjectLine<S>{line.p + line.q * from, line.q}), from};
}

// The part of a line inside the endless cone, one nappe (w >= 0) of it; false when there is none.
//
// With a > 0 the line cuts one nappe only; that it is the right one is left to the caller's test of
// z. With a <= 0 the line is steeper than the cone's generators and is inside from t_in on, when w
// grows along it, or else up to t_out; its other root lies on the other nappe. The discriminant is
// then non-negative but for rounding.
template <class S>
bool InsideCone(const LateralForm<S>& f, S& in, S& out) {
  using std::abs;
  using std::sqrt;
  if (f.a > 0) {
    if (!(f.discriminant >= 0)) return false;
    const auto roots = StableRoots(f.a, f.b, f.c, S(sqrt(f.discriminant)));
    in = roots.in < roots.out ? roots.in : roots.out;
    out = roots.out;
    return true;
  }
  in = -Chord<S>::kInf;
  out = Chord<S>::kInf;
  if (f.slope == 0) return f.c <= 0;  // parallel to a cylinder's axis
  if (f.b == 0 && f.discriminant <= 0 && f.c > 0)
    return false;  // beside a generator, parallel to it
  const S s = f.discriminant > 0 ? S(sqrt(f.discriminant)) : S(0);
  // -|a|, so that a zero has the sign that sends the root which does not exist to the right end.
  const auto roots = StableRoots(S(-abs(f.a)), f.b, f.c, s);
  (f.slope > 0 ? in : out) = f.slope > 0 ? roots.in : roots.out;
  return true;
}

template <class S>
Crossings<S> OpenFrustumCrossings(const FrustumShape& shape, const ObjectLine<S>& line) {
  Crossings<S> crossings;
  const auto [form, from] = WholeLateralFormOf(shape, line);
  S in, out;
  if (!InsideCone(form, in, out)) return crossings;
  in += from;
  out += from;
  // Also false where the line stays inside for ever: z is then infinite or not a number.
  const auto between_rims = [&](const S& t) {
    const S z = line.p.z + t * line.q.z;
    return z >= 0 && z <= 1;
  };
  if (between_rims(in)) crossings.Add(in, kLateralFace, Side::kOutside);
  if (between_rims(out)) crossings.Add(out, kLateralFace, Side::kInside);
  return crossings;
}

template <class S>
Crossings<S> LineCrossings(const FrustumShape& shape, const Vec3<S>& origin,
                           const Vec3<S>& direction) {
  const ObjectLine<S> line = ToObject(shape.frame, origin, direction);
  if (shape.open) return OpenFrustumCrossings(shape, line);
  const auto [form, from] = WholeLateralFormOf(shape, line);
  S in, out;
  if (!InsideCone(form, in, out)) return {};
  Chord<S> chord;
  chord.Enter(in + from, kLateralFace);
  chord.Leave(out + from, kLateralFace);
  const auto& [p, q] = line;
  if (q.z == 0) {
    if (p.z < 0 || p.z > 1) return {};
  } else {
    const S base = -p.z / q.z;
    const S top = (S(1) - p.z) / q.z;
    const bool upwards = q.z > 0;
    chord.Enter(upwards ? base : top, upwards ? kBaseFace : kTopFace);
    chord.Leave(upwards ? top : base, upwards ? kTopFace : kBaseFace);
  }
  return chord.ToCrossings();
}

// Where a line that starts inside a closed frustum, on `face`, leaves the cone.
template <class S>
S ConeExit(const LateralForm<S>& f, int face) {
  if (face == kLateralFace) {
    if (f.a > 0) return S(-2) * f.b / f.a;
    return f.slope < 0 ? S(0) : Chord<S>::kInf;
  }
  S in, out;
  return InsideCone(f, in, out) ? out : S(0);
}

template <class S>
Crossing<S> ExitCrossing(const FrustumShape& shape, const Vec3<S>& origin, const Vec3<S>& direction,
                         int face) {
  const ObjectLine<S> line = ToObject(shape.frame, origin, direction);
  const auto& [p, q] = line;
  Chord<S> chord;
  chord.Leave(ConeExit(LateralFormOf(shape, line), face), kLateralFace);
  if (q.z > 0 && face != kTopFace) chord.Leave((S(1) - p.z) / q.z, kTopFace);
  if (q.z < 0 && face != kBaseFace) chord.Leave(-p.z / q.z, kBaseFace);
  return chord.Exit(face);
}

// The far wall of an open frustum as seen from inside, from a start on the near one.
template <class S>
Crossings<S> FarWallCrossing(const FrustumShape& shape, const Vec3<S>& origin,
                             const Vec3<S>& direction) {
  const ObjectLine<S> line = ToObject(shape.frame, origin, direction);
  const LateralForm<S> f = LateralFormOf(shape, line);
  Crossings<S> crossings;
  if (!(f.a > 0)) return crossings;
  const S t = S(-2) * f.b / f.a;
  const S z = line.p.z + t * line.q.z;
  if (t > 0 && z >= 0 && z <= 1) crossings.Append({t, kLateralFace, Side::kInside});
  return crossings;
}

}  // namespace linetree
