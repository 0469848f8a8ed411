// Where sixteen lines cross one shape, in float, with what rounding leaves open. Derivations:
// margins.h.
#if defined(LINETREE_CORE_PACKET_SHAPES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_PACKET_SHAPES_INL_H_
#undef LINETREE_CORE_PACKET_SHAPES_INL_H_
#else
#define LINETREE_CORE_PACKET_SHAPES_INL_H_
#endif

#include "core/packet/lanes-inl.h"
#include "core/packet/margins.h"
#include "core/packet/packet_scene.h"

HWY_BEFORE_NAMESPACE();
namespace linetree::HWY_NAMESPACE {

// Lines relative to the scene's reference point.
struct FloatRays {
  Vectors o, d;     // d is unit
  Vectors inverse;  // of d, whose components are first moved off zero; see NeedInverse
  Vectors start;    // -o * inverse
  bool has_inverse = false;
  float size = 0;  // of the origins: the part of R that is not the shape's

  HWY_INLINE void NeedInverse() {
    if (has_inverse) return;
    has_inverse = true;
    const Floats one = Floats::All(1), least = Floats::All(kLeastSlope);
    const auto of = [&](const Floats& x) HWY_ATTR { return one / CopySign(Max(Abs(x), least), x); };
    inverse = {of(d.x), of(d.y), of(d.z)};
    start = {-(o.x * inverse.x), -(o.y * inverse.y), -(o.z * inverse.z)};
  }
};

// One of the two crossings of a line with a shape. In lanes of `sure` it exists for certain, and
// outside `maybe` it does not; where it does its parameter lies in [low, high].
struct LaneCrossing {
  Mask maybe, sure;
  Floats low, high;
};
struct LaneCrossings {
  LaneCrossing in, out;
  // kFaces: the face of each; where it is not certain, the crossing is not in `sure`.
  Ints in_face, out_face;
  Mask out_first;  // lanes in which `out` is the first crossing of the whole line
};

HWY_INLINE bool Any(const Mask& mask) { return BitsOf(mask) != 0; }
HWY_INLINE Mask None() { return MaskOf(0); }

HWY_INLINE void SetSingleFace(LaneCrossings& c) {
  c.in_face = c.out_face = Ints::All(0);
  c.out_first = None();
}

// A quadric's half chord: the square `half` of its root is within `off` of the truth.
struct HalfChord {
  Mask maybe, sure;
  Floats length;     // of a lane with half >= off
  Floats uncertain;  // its error
};
HWY_INLINE HalfChord RootOf(const Floats& half, const Floats& off, const Mask& lanes) {
  HalfChord r;
  r.maybe = Without(lanes, half < -off);
  r.sure = lanes & (half > off + off);
  const Floats square = Max(half, off);
  r.length = Sqrt(square);
  // 1.01 is more than what the estimate is off by.
  r.uncertain = off * NearInverseSqrt(square) * Floats::All(1.01f);
  return r;
}

HWY_INLINE void SetChord(const HalfChord& half, const Floats& middle, const Floats& error,
                         LaneCrossings& c) {
  c.in = {half.maybe, half.sure, middle - half.length - error, middle - half.length + error};
  c.out = {half.maybe, half.sure, middle + half.length - error, middle + half.length + error};
  SetSingleFace(c);
}

// Where the lines come nearest to a point: the parameter, and the way from the point to there.
struct NearestPoint {
  Floats t;
  Vectors from;
};
HWY_INLINE NearestPoint NearestTo(const FloatRays& rays, const float* center) {
  const Vectors p = rays.o - Spread(center);
  const Floats t = -Dot(p, rays.d);
  return {t, {MulAdd(t, rays.d.x, p.x), MulAdd(t, rays.d.y, p.y), MulAdd(t, rays.d.z, p.z)}};
}

// All of these: false when no lane may meet the shape.
HWY_INLINE bool MeetSphere(const PacketShape& shape, const FloatRays& rays, const Mask& lanes,
                           LaneCrossings& c) {
  const auto [middle, w] = NearestTo(rays, shape.center);
  const float margin = kLineMargin * (rays.size + shape.reach);
  const Floats off = Floats::All(margin * (kBallByRadius * shape.radius + kBallBySquare * margin));
  const Floats square = Floats::All(shape.radius * shape.radius) - Dot(w, w);
  if (!Any(Without(lanes, square < -off))) return false;
  const HalfChord half = RootOf(square, off, lanes);
  SetChord(half, middle, half.uncertain + Floats::All(margin), c);
  return true;
}

struct ObjectLines {
  Vectors p, q;
  float margin;  // of the line
};
HWY_INLINE Vectors Mapped(const float* m, const Vectors& v) {
  const auto row = [&](int i) HWY_ATTR {
    return MulAdd(v.z, Floats::All(m[3 * i + 2]),
                  MulAdd(v.y, Floats::All(m[3 * i + 1]), v.x * Floats::All(m[3 * i])));
  };
  return {row(0), row(1), row(2)};
}
HWY_INLINE ObjectLines ToObject(const PacketShape& shape, const FloatRays& rays) {
  return {Mapped(shape.map, rays.o - Spread(shape.center)), Mapped(shape.map, rays.d),
          kLineMargin * shape.map_norm * (rays.size + shape.reach)};
}

HWY_INLINE bool MeetEllipsoid(const PacketShape& shape, const FloatRays& rays, const Mask& lanes,
                              LaneCrossings& c) {
  const auto [p, q, margin] = ToObject(shape, rays);
  const Floats inverse = Floats::All(1) / Max(Dot(q, q), Floats::All(0x1p-100f));
  const Floats middle = -(Dot(p, q) * inverse);
  const Vectors w = {MulAdd(middle, q.x, p.x), MulAdd(middle, q.y, p.y), MulAdd(middle, q.z, p.z)};
  const Floats off = Floats::All(margin * (kBallByRadius + kBallBySquare * margin));
  const Floats square = Floats::All(1) - Dot(w, w);
  if (!Any(Without(lanes, square < -off))) return false;
  HalfChord half = RootOf(square, off, lanes);
  const Floats scale = Sqrt(inverse);
  half.length = half.length * scale;
  const Floats error = (half.uncertain + Floats::All(margin + margin)) * scale;
  SetChord(half, middle, error, c);
  return true;
}

// A chord as the intersection of what lies between pairs of planes, or behind planes.
struct LaneChord {
  Floats in_low, in_high, out_low, out_high;

  HWY_INLINE Mask MayMeet(const Mask& lanes) const { return Without(lanes, in_low > out_high); }
  HWY_INLINE Mask Meets(const Mask& lanes) const { return lanes & (in_high < out_low); }
};

// One pair of planes of a box.
struct LaneSlab {
  Floats near, far, error;
};

template <bool kFaces>
HWY_INLINE bool MeetSlabs(const LaneSlab* slab, const Vectors& d,
                          const std::array<uint8_t, 6>& faces, const Mask& lanes,
                          LaneCrossings& c) {
  const auto sum = [&](int i, const Floats& t) HWY_ATTR { return t + slab[i].error; };
  const auto less = [&](int i, const Floats& t) HWY_ATTR { return t - slab[i].error; };
  LaneChord chord;
  chord.in_low = Max(Max(less(0, slab[0].near), less(1, slab[1].near)), less(2, slab[2].near));
  chord.out_high = Min(Min(sum(0, slab[0].far), sum(1, slab[1].far)), sum(2, slab[2].far));
  const Mask maybe = chord.MayMeet(lanes);
  if (!Any(maybe)) return false;
  const Floats highs[3] = {sum(0, slab[0].near), sum(1, slab[1].near), sum(2, slab[2].near)};
  const Floats lows[3] = {less(0, slab[0].far), less(1, slab[1].far), less(2, slab[2].far)};
  chord.in_high = Max(Max(highs[0], highs[1]), highs[2]);
  chord.out_low = Min(Min(lows[0], lows[1]), lows[2]);
  const Mask sure = chord.Meets(lanes);
  c.in = {maybe, sure, chord.in_low, chord.in_high};
  c.out = {maybe, sure, chord.out_low, chord.out_high};
  c.out_first = None();
  if constexpr (kFaces) {
    const auto only = [&](const Mask& x, const Mask& y, const Mask& z)
                          HWY_ATTR { return Without(Without(x | y | z, x & y), (x | y) & z); };
    const auto face = [&](const Mask& x, const Mask& y, bool entering) HWY_ATTR {
      const auto along = [&](size_t axis, const Floats& slope) HWY_ATTR {
        const int32_t low = faces[2 * axis], high = faces[2 * axis + 1];
        return Select(slope > Floats::All(0), Ints::All(entering ? low : high),
                      Ints::All(entering ? high : low));
      };
      return Select(x, along(0, d.x), Select(y, along(1, d.y), along(2, d.z)));
    };
    const Mask in_x = highs[0] >= chord.in_low, in_y = highs[1] >= chord.in_low,
               in_z = highs[2] >= chord.in_low;
    c.in.sure = sure & only(in_x, in_y, in_z);
    c.in_face = face(in_x, in_y, true);
    const Mask out_x = lows[0] <= chord.out_high, out_y = lows[1] <= chord.out_high,
               out_z = lows[2] <= chord.out_high;
    c.out.sure = sure & only(out_x, out_y, out_z);
    c.out_face = face(out_x, out_y, false);
  }
  return true;
}

template <bool kFaces>
HWY_INLINE bool MeetBox(const PacketShape& shape, FloatRays& rays, const Mask& lanes,
                        LaneCrossings& c) {
  rays.NeedInverse();
  const Floats margin = Floats::All(kSlabMargin * (rays.size + shape.reach));
  const auto slab = [&](int i, const Floats& inverse, const Floats& start) HWY_ATTR {
    const Floats a = MulAdd(Floats::All(shape.low[i]), inverse, start);
    const Floats b = MulAdd(Floats::All(shape.high[i]), inverse, start);
    return LaneSlab{Min(a, b), Max(a, b), margin * Abs(inverse)};
  };
  const LaneSlab slabs[3] = {slab(0, rays.inverse.x, rays.start.x),
                             slab(1, rays.inverse.y, rays.start.y),
                             slab(2, rays.inverse.z, rays.start.z)};
  return MeetSlabs<kFaces>(slabs, rays.d, shape.faces, lanes, c);
}

template <bool kFaces>
HWY_INLINE bool MeetSlabShape(const PacketShape& shape, const FloatRays& rays, const Mask& lanes,
                              LaneCrossings& c) {
  const auto [p, q, line_margin] = ToObject(shape, rays);
  const Floats margin = Floats::All(line_margin * (kSlabMargin / kLineMargin));
  const Floats one = Floats::All(1), least = Floats::All(kLeastSlope);
  const auto slab = [&](const Floats& from, const Floats& slope) HWY_ATTR {
    const Floats inverse = one / CopySign(Max(Abs(slope), least), slope);
    const Floats a = (-one - from) * inverse, b = (one - from) * inverse;
    return LaneSlab{Min(a, b), Max(a, b), margin * Abs(inverse)};
  };
  const LaneSlab slabs[3] = {slab(p.x, q.x), slab(p.y, q.y), slab(p.z, q.z)};
  constexpr std::array<uint8_t, 6> kFacesInOrder = {0, 1, 2, 3, 4, 5};
  return MeetSlabs<kFaces>(slabs, q, kFacesInOrder, lanes, c);
}

}  // namespace linetree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
