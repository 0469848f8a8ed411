// Where sixteen lines cross polygons, discs and polyhedra. See shapes-inl.h.
#if defined(LINETREE_CORE_PACKET_PLANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_PACKET_PLANES_INL_H_
#undef LINETREE_CORE_PACKET_PLANES_INL_H_
#else
#define LINETREE_CORE_PACKET_PLANES_INL_H_
#endif

#include "core/packet/shapes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace linetree::HWY_NAMESPACE {

HWY_INLINE Floats DistanceOf(const FloatPlane& plane, const Vectors& p) {
  return MulAdd(p.z, Floats::All(plane[2]),
                MulAdd(p.y, Floats::All(plane[1]),
                       MulAdd(p.x, Floats::All(plane[0]), Floats::All(plane[3]))));
}
HWY_INLINE Floats SlopeOf(const FloatPlane& plane, const Vectors& d) {
  return MulAdd(d.z, Floats::All(plane[2]),
                MulAdd(d.y, Floats::All(plane[1]), d.x * Floats::All(plane[0])));
}

// Slopes smaller than this are as uncertain as a point at any distance: t stays finite.
inline constexpr float kLeastPlaneSlope = 0x1p-40f;

// Where lines meet a plane: t, and the share of kPlaneMargin in it.
struct LanePlane {
  Floats t, spread;
};

// Sets `at` for the lanes that may cross the plane with t in [0, last], which it returns: those
// that are not on one side of it for certain from end to end.
HWY_INLINE Mask MeetPlane(const FloatPlane& plane, const FloatRays& rays, float length,
                          const Floats& last, const Mask& lanes, LanePlane& at) {
  const Floats slope = SlopeOf(plane, rays.d);
  const Floats distance = DistanceOf(plane, rays.o);
  const Floats end = MulAdd(slope, last, distance);
  const Floats reach = Floats::All(length), margin = Floats::All(kPlaneMargin);
  const Floats near_margin = margin * reach, end_margin = margin * (reach + last);
  const Mask above = (distance > near_margin) & (end > end_margin);
  const Mask below = (distance < -near_margin) & (end < -end_margin);
  const Mask maybe = Without(lanes, above | below);
  if (!Any(maybe)) return maybe;
  const Floats inverse =
      Floats::All(1) / CopySign(Max(Abs(slope), Floats::All(kLeastPlaneSlope)), slope);
  at.t = -(distance * inverse);
  at.spread = (reach + Abs(at.t)) * Abs(inverse);
  return maybe;
}

HWY_INLINE void SetPlanar(const Mask& maybe, const Mask& sure, const LanePlane& at,
                          LaneCrossings& c) {
  const Floats error = at.spread * Floats::All(kPlaneMargin);
  c.in = {maybe, sure, at.t - error, at.t + error};
  c.out = {None(), None(), at.t, at.t};
  SetSingleFace(c);
}

HWY_INLINE const Floats& Axis(const Vectors& v, int axis) {
  return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

// [first, last]: the range of t in which a crossing matters.
HWY_INLINE bool MeetPolygon(const PacketShape& shape, const FloatPlane* edges,
                            const FloatRays& rays, const Floats& last, const Mask& lanes,
                            LaneCrossings& c) {
  LanePlane at;
  Mask maybe = MeetPlane(shape.plane, rays, rays.size + shape.reach, last, lanes, at);
  if (!Any(maybe)) return false;
  const Floats u = MulAdd(at.t, Axis(rays.d, shape.u), Axis(rays.o, shape.u));
  const Floats v = MulAdd(at.t, Axis(rays.d, shape.v), Axis(rays.o, shape.v));
  Floats outside = Floats::All(-1e30f);
  for (int32_t i = 0; i < shape.count; ++i) {
    const FloatPlane& edge = edges[i];
    outside = Max(outside, MulAdd(u, Floats::All(edge[0]),
                                  MulAdd(v, Floats::All(edge[1]), Floats::All(edge[2]))));
  }
  const Floats margin = at.spread * Floats::All(kEdgeMargin);
  maybe = Without(maybe, outside > margin);
  if (!Any(maybe)) return false;
  SetPlanar(maybe, maybe & (outside < -margin), at, c);
  return true;
}

HWY_INLINE bool MeetDisc(const PacketShape& shape, const FloatRays& rays, const Floats& last,
                         const Mask& lanes, LaneCrossings& c) {
  LanePlane at;
  Mask maybe = MeetPlane(shape.plane, rays, rays.size + shape.reach, last, lanes, at);
  if (!Any(maybe)) return false;
  const Vectors p = {MulAdd(at.t, rays.d.x, rays.o.x), MulAdd(at.t, rays.d.y, rays.o.y),
                     MulAdd(at.t, rays.d.z, rays.o.z)};
  const Vectors r = Mapped(shape.map, p - Spread(shape.center));
  const Floats square = MulAdd(r.x, r.x, r.y * r.y);
  // With e the margin of r: |r| < 1 - 2 e when the square is below 1 - 4 e.
  const Floats four = at.spread * Floats::All(4 * kEdgeMargin * shape.map_norm);
  const Floats one = Floats::All(1);
  maybe = Without(maybe, square > one + four + four * four);
  if (!Any(maybe)) return false;
  SetPlanar(maybe, maybe & (square < one - four), at, c);
  return true;
}

template <bool kFaces>
HWY_INLINE bool MeetPolyhedron(const PacketShape& shape, const FloatPlane* planes,
                               const FloatRays& rays, const Mask& lanes, LaneCrossings& c) {
  const float length = rays.size + shape.reach;
  const Floats margin = Floats::All(kSlabMargin * length), one = Floats::All(1);
  const Floats far = Floats::All(1e30f);
  LaneChord chord = {-far, -far, far, far};
  // The ends that the second nearest plane could reach.
  Floats in_rival = -far, out_rival = far;
  c.in_face = c.out_face = Ints::All(0);
  for (int32_t i = 0; i < shape.count; ++i) {
    const Floats slope = SlopeOf(planes[i], rays.d);
    const Floats inverse = one / CopySign(Max(Abs(slope), Floats::All(kLeastPlaneSlope)), slope);
    const Floats t = -(DistanceOf(planes[i], rays.o) * inverse);
    const Floats error = margin * Abs(inverse);
    const Floats low = t - error, high = t + error;
    // By the sign bit: a slope of -0 goes with an inverse below zero.
    const Mask enters = inverse < Floats::All(0);
    const Floats in_low = Select(enters, low, -far), in_high = Select(enters, high, -far);
    const Floats out_low = Select(enters, far, low), out_high = Select(enters, far, high);
    if constexpr (kFaces) {
      const Mask later = in_low > chord.in_low;
      in_rival = Max(in_rival, Select(later, chord.in_high, in_high));
      c.in_face = Select(later, Ints::All(i), c.in_face);
      const Mask sooner = out_high < chord.out_high;
      out_rival = Min(out_rival, Select(sooner, chord.out_low, out_low));
      c.out_face = Select(sooner, Ints::All(i), c.out_face);
      // The highest end belongs to the face that is kept only if it is that face's own.
      chord.in_high = Select(later, in_high, chord.in_high);
      chord.out_low = Select(sooner, out_low, chord.out_low);
    } else {
      chord.in_high = Max(chord.in_high, in_high);
      chord.out_low = Min(chord.out_low, out_low);
    }
    chord.in_low = Max(chord.in_low, in_low);
    chord.out_high = Min(chord.out_high, out_high);
  }
  const Mask in_clear = chord.in_low > in_rival, out_clear = chord.out_high < out_rival;
  if constexpr (kFaces) {
    chord.in_high = Max(chord.in_high, in_rival);
    chord.out_low = Min(chord.out_low, out_rival);
  }
  const Mask maybe = chord.MayMeet(lanes), sure = chord.Meets(lanes);
  if (!Any(maybe)) return false;
  c.in = {maybe, kFaces ? sure & in_clear : sure, chord.in_low, chord.in_high};
  c.out = {maybe, kFaces ? sure & out_clear : sure, chord.out_low, chord.out_high};
  c.out_first = None();
  return true;
}

}  // namespace linetree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
