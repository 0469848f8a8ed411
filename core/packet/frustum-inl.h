// Where sixteen lines cross cylinders and cones. See shapes-inl.h.
#if defined(LINETREE_CORE_PACKET_FRUSTUM_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_PACKET_FRUSTUM_INL_H_
#undef LINETREE_CORE_PACKET_FRUSTUM_INL_H_
#else
#define LINETREE_CORE_PACKET_FRUSTUM_INL_H_
#endif

#include "core/packet/shapes-inl.h"
#include "core/trace/intersect_quadric.h"

HWY_BEFORE_NAMESPACE();
namespace linetree::HWY_NAMESPACE {

// Lines in a frustum's object space, from their point nearest to the base's centre, with directions
// of unit length there; s is the parameter along them.
struct FrustumLines {
  Vectors p, q;
  Floats from;   // t where s = 0
  Floats scale;  // t of s = 1
  float margin;
  float form;  // what its lateral form may be off by
};

// Along them: the lateral surface. A root that does not exist is far away.
struct LateralRoots {
  Mask maybe, sure;
  Floats in, out, error;
};

// Where a line crosses the planes of the caps.
struct CapPlanes {
  Floats near, far, error;
};
HWY_INLINE CapPlanes CapPlanesOf(const FrustumLines& line) {
  const Floats one = Floats::All(1);
  const Floats& slope = line.q.z;
  const Floats inverse = one / CopySign(Max(Abs(slope), Floats::All(kLeastSlope)), slope);
  const Floats base = -(line.p.z * inverse), top = (one - line.p.z) * inverse;
  return {Min(base, top), Max(base, top), Floats::All(2 * line.margin) * Abs(inverse)};
}

inline constexpr float kNoRoot = 1e20f;

// Lines that are steeper than the generators, or nearly so, cross the lateral surface at most once
// between the caps: the ends there tell. Their |q.z| is above 0.69, so that the ends are off by 4
// margins, and the form there by 24 of them. `b`, `c`: the form's; `square`: of its root.
HWY_INLINE void SetSteep(const PacketShape& shape, const FrustumLines& line, const Mask& steep,
                         const Floats& a, const Floats& b, const Floats& c, const HalfChord& half,
                         LateralRoots& r) {
  const CapPlanes caps = CapPlanesOf(line);
  const auto form = [&](const Floats& s) HWY_ATTR {
    const Floats x = MulAdd(s, line.q.x, line.p.x), y = MulAdd(s, line.q.y, line.p.y);
    const Floats z = MulAdd(s, line.q.z, line.p.z);
    const Floats w = MulAdd(Floats::All(shape.taper), z, Floats::All(shape.base_radius));
    return NegMulAdd(w, w, MulAdd(y, y, x * x));
  };
  const Floats at_near = form(caps.near), at_far = form(caps.far);
  const float off = 4 * kLateralForm * line.margin;
  const Mask near_in = at_near < Floats::All(-off), far_in = at_far < Floats::All(-off);
  // Between ends outside a concave form is positive. One that is bent upwards by less than
  // kLeastLateral sags by less than a quarter of that times the squared distance of the ends, which
  // is below 3.
  const Floats above = Floats::All(off) + Max(a, Floats::All(0));
  const Mask near_out = at_near > above, far_out = at_far > above;
  // The root that does not run away when a is near 0; the other one, where that is not between.
  const Floats k = -(b + CopySign(half.length, b));
  const Floats one_root = c / k, other_root = k / CopySign(Max(Abs(a), Floats::All(1e-20f)), a);
  const Floats slack = Floats::All(0.01f);
  const Mask between = (one_root > caps.near - slack) & (one_root < caps.far + slack);
  const Floats root = Select(between, one_root, other_root);
  const Mask through = near_in & far_in;
  const Mask once = ((near_in & far_out) | (near_out & far_in)) & half.sure & (Abs(b) > slack);
  const Mask sure = steep & (through | once);
  const Floats zero = Floats::All(0), none = Floats::All(kNoRoot);
  r.maybe = r.maybe | Without(steep, near_out & far_out);
  r.sure = Without(r.sure, steep) | sure;
  r.in = Select(steep, Select(sure, Select(near_in, -none, root), zero), r.in);
  r.out = Select(steep, Select(sure, Select(far_in, none, root), zero), r.out);
  // Otherwise both crossings are anywhere within 1.5 of the nearest point.
  r.error = Select(Without(steep, sure), Floats::All(1.5f), r.error);
}

HWY_INLINE LateralRoots LateralRootsOf(const PacketShape& shape, const FrustumLines& line,
                                       const Mask& lanes) {
  const auto& [p, q, from, scale, margin, form] = line;
  const Floats taper = Floats::All(shape.taper);
  const Floats w = MulAdd(taper, p.z, Floats::All(shape.base_radius));
  const Floats slope = taper * q.z;
  const Floats xw = NegMulAdd(w, q.x, p.x * slope), yw = NegMulAdd(w, q.y, p.y * slope);
  const Floats xy = NegMulAdd(p.y, q.x, p.x * q.y);
  const Floats a = NegMulAdd(slope, slope, MulAdd(q.y, q.y, q.x * q.x));
  const Floats b = NegMulAdd(w, slope, MulAdd(p.y, q.y, p.x * q.x));
  const Floats square = NegMulAdd(xy, xy, MulAdd(yw, yw, xw * xw));
  const Floats least = Floats::All(kLeastLateral);
  const Mask steep = lanes & (a < least);
  const HalfChord half = RootOf(square, Floats::All(form), lanes);
  LateralRoots r;
  r.maybe = Without(half.maybe, steep);
  r.sure = half.sure;
  const Floats inverse = Floats::All(1) / Max(a, least);
  r.in = (-b - half.length) * inverse;
  r.out = (half.length - b) * inverse;
  // Of a certain chord: uncertain = form / length. Of another one not even the
  // length is known.
  const Floats least_error = Floats::All(kLateralRoot * margin);
  const Floats certain =
      MulAdd(half.uncertain, Floats::All(kLateralRoot * margin / form), least_error);
  r.error = Select(half.sure, certain, (half.length + least_error) * inverse);
  if (Any(steep)) {
    const Floats c = NegMulAdd(w, w, MulAdd(p.y, p.y, p.x * p.x));
    SetSteep(shape, line, steep, a, b, c, half, r);
  }
  return r;
}

// Crossings of the walls of an open frustum count between its rims.
template <bool kFaces>
HWY_INLINE bool MeetOpenFrustum(const FrustumLines& line, const LateralRoots& root,
                                LaneCrossings& c) {
  const Floats one = Floats::All(1), rim = root.error + Floats::All(2 * line.margin);
  const auto at = [&](const Floats& s) HWY_ATTR {
    const Floats z = MulAdd(s, line.q.z, line.p.z);
    LaneCrossing r;
    r.maybe = Without(Without(root.maybe, z < -rim), z > one + rim);
    r.sure = root.sure & (z > rim) & (z < one - rim);
    const Floats t = MulAdd(s, line.scale, line.from), error = root.error * line.scale;
    r.low = t - error;
    r.high = t + error;
    return r;
  };
  c.in = at(root.in);
  c.out = at(root.out);
  SetSingleFace(c);
  c.out_first = Without(c.out.sure, c.in.maybe);
  // Which of the two is the first is open where the first one is.
  if constexpr (kFaces) c.out.sure = Without(c.out.sure, Without(c.in.maybe, c.in.sure));
  return Any(c.in.maybe | c.out.maybe);
}

template <bool kFaces>
HWY_INLINE bool MeetCappedFrustum(const FrustumLines& line, const LateralRoots& root,
                                  LaneCrossings& c) {
  const auto& [p, q, from, scale, margin, form] = line;
  const auto [near, far, cap_error] = CapPlanesOf(line);
  const Floats side_in_low = root.in - root.error, side_in_high = root.in + root.error;
  const Floats side_out_low = root.out - root.error, side_out_high = root.out + root.error;
  const Floats cap_in_low = near - cap_error, cap_in_high = near + cap_error;
  const Floats cap_out_low = far - cap_error, cap_out_high = far + cap_error;
  const LaneChord chord = {Max(side_in_low, cap_in_low), Max(side_in_high, cap_in_high),
                           Min(side_out_low, cap_out_low), Min(side_out_high, cap_out_high)};
  const Mask maybe = chord.MayMeet(root.maybe);
  if (!Any(maybe)) return false;
  const Mask sure = chord.Meets(root.sure);
  // Clang 14 takes no structured bindings into lambdas.
  const auto crossing = [&](const Mask& certain, const Floats& low, const Floats& high) HWY_ATTR {
    return LaneCrossing{maybe, certain, MulAdd(low, line.scale, line.from),
                        MulAdd(high, line.scale, line.from)};
  };
  c.in = crossing(sure, chord.in_low, chord.in_high);
  c.out = crossing(sure, chord.out_low, chord.out_high);
  c.out_first = None();
  if constexpr (kFaces) {
    const Mask up = q.z > Floats::All(0);
    const Mask in_side = side_in_low > cap_in_high, in_cap = cap_in_low > side_in_high;
    c.in.sure = sure & (in_side | in_cap);
    c.in_face = Select(in_side, Ints::All(kLateralFace),
                       Select(up, Ints::All(kBaseFace), Ints::All(kTopFace)));
    const Mask out_side = side_out_high < cap_out_low, out_cap = cap_out_high < side_out_low;
    c.out.sure = sure & (out_side | out_cap);
    c.out_face = Select(out_side, Ints::All(kLateralFace),
                        Select(up, Ints::All(kTopFace), Ints::All(kBaseFace)));
  }
  return true;
}

template <bool kFaces>
HWY_INLINE bool MeetFrustum(const PacketShape& shape, const FloatRays& rays, const Mask& lanes,
                            LaneCrossings& c) {
  const ObjectLines object = ToObject(shape, rays);
  const Floats one = Floats::All(1);
  const Floats square = Max(Dot(object.q, object.q), Floats::All(0x1p-100f));
  const Floats scale = one / Sqrt(square);
  FrustumLines line;
  line.margin = kFrustumLine * object.margin;
  line.form = (kLateralForm + kLateralTaper * std::abs(shape.taper)) * line.margin;
  line.scale = scale;
  line.q = object.q * scale;
  const Floats along = -Dot(object.p, line.q);
  line.from = along * scale;
  line.p = {MulAdd(along, line.q.x, object.p.x), MulAdd(along, line.q.y, object.p.y),
            MulAdd(along, line.q.z, object.p.z)};
  // No point of a frustum is farther than sqrt(2) from its base's centre. Beyond, the margins of
  // its lateral form would not hold.
  const float bound = 1.4143f + line.margin;
  const Mask near = Without(lanes, Dot(line.p, line.p) > Floats::All(bound * bound * 1.0001f));
  if (!Any(near)) return false;
  const LateralRoots root = LateralRootsOf(shape, line, near);
  if (!Any(root.maybe)) return false;
  return shape.open ? MeetOpenFrustum<kFaces>(line, root, c)
                    : MeetCappedFrustum<kFaces>(line, root, c);
}

}  // namespace linetree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
