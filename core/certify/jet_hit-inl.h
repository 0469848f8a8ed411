// Where the rays of a bundle meet one face of an object, in jets, and how the surface lies there.
#if defined(LINETREE_CORE_CERTIFY_JET_HIT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_CERTIFY_JET_HIT_INL_H_
#undef LINETREE_CORE_CERTIFY_JET_HIT_INL_H_
#else
#define LINETREE_CORE_CERTIFY_JET_HIT_INL_H_
#endif

#include "core/certify/jet_shape.h"
#include "core/jet/jet_vector-inl.h"
#include "core/trace/hit.h"

LINETREE_BEFORE_JETS();
namespace linetree::LINETREE_JETS {

template <size_t D>
struct JetRay {
  JetVector<D> origin, direction;
  // The bundle of a chart between two planes: directions reach from the one plane to the other, so
  // that hits of a solid lie at 0 <= t <= 1. Otherwise directions are of unit length.
  bool between_planes = false;
};

template <size_t D>
struct JetHit {
  const JetShape* shape = nullptr;
  int face = 0;
  Side side = Side::kOutside;
  bool curved = false;
  // Open frustums from inside: some rays may have met the near wall first, instead of coming in
  // through an open end.
  bool behind_wall = false;
  double sign = 1;  // of the facing normal against the plane's or the outward one
  JetVector<D> point;
  JetVector<D> object_point;  // curved: in the object frame, on the canonical surface
  // Curved, but for spheres: of the canonical surface's gradient, halved and in the world.
  CornerJet<D> inverse_length;
  // Facing, unit; one vector for all hits where `flat`.
  bool flat = false;
  Vec3d flat_normal;
  JetVector<D> normal;
  CornerJet<D> cosine;  // -direction.normal, for the ray's direction as it is
  // Planes: of the origins from the plane, and how it changes along the rays.
  CornerJet<D> distance, slope;

  JetVector<D> NormalTimes(const CornerJet<D>& f) const {
    return flat ? LooseVector<D>(flat_normal * f) : normal * f;
  }
  CornerJet<D> NormalDot(const Vec3d& v) const {
    if (!flat) return Dot(normal, v);
    CornerJet<D> dot = CornerJet<D>::Constant(Dot(flat_normal, v));
    dot.slack = 4 * kOutward * Length(v);
    dot.v = Outward(dot.v.lo - dot.slack, dot.v.hi + dot.slack);
    return dot;
  }
  // On curved surfaces: the facing normal times the way from the hits to a place, and times a
  // direction.
  CornerJet<D> CurvedFacing(const Vec3d& place) const {
    const AffineFrame& frame = shape->frame;
    const Vec3d l = frame.object_from_world * (place - frame.center);
    return PolarForm(l, 1, SumOfSizes(place) + SumOfSizes(frame.center));
  }
  CornerJet<D> CurvedFacingTo(const Vec3d& direction) const {
    return PolarForm(shape->frame.object_from_world * direction, 0, 1);
  }
  Vec3d MiddleNormal() const {
    if (flat) return flat_normal;
    return {normal.x.Middle(), normal.y.Middle(), normal.z.Middle()};
  }

 private:
  static double SumOfSizes(const Vec3d& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); }
  // Half the surface's gradient at m times l - affine m, affine 1 or 0, over the gradient's length.
  // On a quadric that is linear in m: the polar form of m and l, as m with itself gives 0. `l` was
  // computed from places of that `size`.
  CornerJet<D> PolarForm(const Vec3d& l, double affine, double size) const {
    const bool sphere = shape->kind == JetShape::Kind::kSphere;
    const double base = sphere ? 0 : shape->base_radius, taper = sphere ? 0 : shape->taper;
    const double w = base * affine + taper * l.z;
    CornerJet<D> form = sphere ? Dot(object_point, l) + -affine
                               : Dot(object_point, Vec3d{l.x, l.y, -taper * w}) + -base * w;
    const double largest = 1 + base + std::abs(taper);  // of m
    form.Widen(16 * kOutward * largest * largest * (1 + shape->frame_rows * size));
    if (shape->radius > 0) return form * (shape->radius * sign);
    const CornerJet<D> facing = form * inverse_length;
    return facing * sign;
  }
};

}  // namespace linetree::LINETREE_JETS
LINETREE_AFTER_JETS();

#endif
