// What the lights add to the radiance of a bundle's hits, in jets; formulas as in
// core/trace/shade.h but arranged so that jets stay narrow (DESIGN, section 5): n.(L - x) is
// constant on a plane and, but for the gradient's length, linear on a quadric.
#if defined(LINETREE_CORE_CERTIFY_LIGHT_TERMS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_CERTIFY_LIGHT_TERMS_INL_H_
#undef LINETREE_CORE_CERTIFY_LIGHT_TERMS_INL_H_
#else
#define LINETREE_CORE_CERTIFY_LIGHT_TERMS_INL_H_
#endif

#include <vector>

#include "core/certify/cell_paths.h"
#include "core/certify/fading_jet-inl.h"
#include "core/certify/highlight_jet-inl.h"
#include "core/certify/jet_hit-inl.h"
#include "core/certify/path_certifier.h"
#include "core/certify/radiance_sum-inl.h"
#include "core/certify/ray_bundle.h"
#include "core/trace/shade.h"

LINETREE_BEFORE_JETS();
namespace linetree::LINETREE_JETS {

// A unit vector across `normal`: where the longest of the cell's edges runs, along which its hits
// lie.
inline Vec3d AlongSurface(const PointCloud& cloud, const Vec3d& normal) {
  Vec3d longest;
  for (const size_t corner : {1, 2, 4, 8}) {
    const Vec3d edge = cloud.points[corner] - cloud.points[0];
    const Vec3d along = edge - normal * Dot(normal, edge);
    // What is left of much longer ones does not lie across the normal.
    if (LengthSquared(along) < LengthSquared(edge) / 16) continue;
    if (LengthSquared(along) > LengthSquared(longest)) longest = along;
  }
  const double length = Length(longest);
  if (length > 0) return longest * (1 / length);
  const Vec3d aside = std::abs(normal.x) < 0.5 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  return Normalized(Cross(normal, aside));
}

// An upright box about a cloud, two of its faces across `normal`, `margin` wider on all sides than
// it has to be: what is hidden by one convex object then stays away from the shadow's border.
inline PatchHull HullAbout(const PointCloud& cloud, const Vec3d& normal, double margin) {
  const Vec3d u = AlongSurface(cloud, normal);
  const Vec3d axes[3] = {normal, u, Cross(normal, u)};
  const Vec3d& origin = cloud.points[0];
  double from[3], to[3];
  for (size_t i = 0; i < 3; ++i) {
    from[i] = to[i] = 0;
    for (const Vec3d& p : cloud.points) {
      const double along = Dot(p - origin, axes[i]);
      from[i] = std::min(from[i], along);
      to[i] = std::max(to[i], along);
    }
    // The axes are orthonormal to a few roundings.
    const double wider = margin + cloud.slack + 8 * kOutward * (to[i] - from[i]);
    from[i] -= wider;
    to[i] += wider;
  }
  PatchHull hull;
  for (size_t m = 0; m < 8; ++m) {
    Vec3d p = origin;
    for (size_t i = 0; i < 3; ++i) p = p + axes[i] * ((m >> i & 1) != 0 ? to[i] : from[i]);
    hull.points[m] = p;
  }
  return hull;
}

template <size_t D>
class LightTerms {
 public:
  using Jet = CornerJet<D>;
  using Vector = JetVector<D>;

  LightTerms(const PathCertifier::Context& context, RadianceSum<D>& sum)
      : context_(context), sum_(sum) {}

  // Adds all lights at the hits of rays of unit `direction`; `colour` is the path's weight so far.
  // kNone, or the first reason why some light's part is not a smooth function of the ray.
  Doubt Add(const JetHit<D>& hit, const Vector& direction, int object, const Rgb& colour,
            const PointCloud& cloud) {
    const Scene& scene = context_.scene;
    if (!cloud.IsFinite()) return Doubt::kBound;
    const Vec3d normal = hit.MiddleNormal();
    if (!(LengthSquared(normal) > 0)) return Doubt::kBound;
    const PatchHull hull = HullAbout(cloud, Normalized(normal), kSurfaceSlack * hit.shape->reach);
    const Material& material = scene.MaterialOf(object);
    // All decisions first: most cells that are refused are refused by one of them.
    shining_.clear();
    for (size_t i = 0; i < scene.lights.size(); ++i) {
      const Light& light = scene.lights[i];
      const Jet facing = Facing(hit, light);
      const double scale = FacingScale(hit, light);
      if (IsNegative(facing, scale)) continue;
      const LightArrival arrival = context_.lights.ArrivalOf(object, hull, static_cast<int>(i));
      if (arrival.knowledge == LightKnowledge::kOff) continue;
      Rgb filter = arrival.filter;
      if (!IsLit(arrival.knowledge, hit, object, light, filter)) return Doubt::kShadow;
      if (IsBlack(filter)) continue;
      const bool faces = IsPositive(facing, scale);
      shining_.push_back({&light, colour * filter * light.irradiance, faces});
    }
    for (const Shining& s : shining_) {
      if (!AddLight(hit, direction, *s.light, material, s.arriving, s.faces)) return Doubt::kBound;
    }
    return Doubt::kNone;
  }

 private:
  // n.(L - x), or n.l for a directional light.
  Jet Facing(const JetHit<D>& hit, const Light& light) const {
    const bool directional = light.kind == LightKind::kDirectional;
    if (hit.curved) {
      return directional ? hit.CurvedFacingTo(light.to_light) : hit.CurvedFacing(light.position);
    }
    if (directional) return hit.NormalDot(light.to_light);
    if (hit.flat) {
      const Plane& plane = *hit.shape->PlaneOf(hit.face);
      return Jet::Constant(SignedDistance(plane, light.position) * hit.sign);
    }
    return -Dot(hit.normal, hit.point - light.position);
  }
  static double FacingScale(const JetHit<D>& hit, const Light& light) {
    if (light.kind == LightKind::kDirectional) return 1;
    const Vec3d& l = light.position;
    return hit.shape->reach + std::abs(l.x) + std::abs(l.y) + std::abs(l.z);
  }

  // Whether the light certainly arrives; what the object itself takes of it is added to `filter`.
  bool IsLit(LightKnowledge knowledge, const JetHit<D>& hit, int object, const Light& light,
             Rgb& filter) const {
    if (knowledge != LightKnowledge::kOn) return false;
    if (hit.side == Side::kOutside || hit.shape->IsThin()) return true;
    // From inside the object's own far side is in between, once, unless the light is inside too.
    const Shape& shape = context_.scene.objects[static_cast<size_t>(object)].shape;
    if (!IsSolid(shape)) return false;
    if (light.kind == LightKind::kPoint) {
      PointCloud at;
      at.points.fill(light.position);
      if (!IsCertainlyOutside(at, shape, context_.search().Surplus(object))) return false;
    }
    filter = filter * context_.scene.MaterialOf(object).transmit;
    return true;
  }

  bool AddLight(const JetHit<D>& hit, const Vector& direction, const Light& light,
                const Material& material, const Rgb& arriving, bool faces) {
    const Jet facing = Facing(hit, light);
    const bool shines = !IsBlack(material.specular);
    Jet cosine = facing, strength = Jet::Constant(1);
    Vector both;  // l + v
    if (light.kind == LightKind::kDirectional) {
      if (shines) both = -direction - -light.to_light;
    } else {
      const Vector segment = -(hit.point - light.position);
      const Jet square = SquaredDistance(hit, light, segment);
      if (!IsPositive(square, square.hi())) return false;
      const Jet inverse = InverseSquareRoot(square);
      if (shines) both = segment * inverse + -direction;
      cosine = facing * inverse;
      if (light.fade_distance > 0) {
        if (!FadeOver(light, square, strength)) return false;
      }
    }
    cosine.AssumeWithin(-1, 1);
    const bool fades = light.kind == LightKind::kPoint && light.fade_distance > 0;
    const auto faded = [&](const Jet& f) -> Jet { return fades ? Jet(f * strength) : f; };
    if (!IsBlack(material.diffuse)) {
      const Jet light_term = faded(cosine);
      if (faces) {
        sum_.Add(arriving * material.diffuse, light_term);
      } else {
        sum_.Add(arriving * material.diffuse, Positive(light_term), ExcessOfPositive(light_term));
      }
    }
    if (!shines) return true;
    Jet highlight;
    if (!HighlightOf(hit, both, cosine, material.exponent, highlight)) return false;
    highlight = faded(highlight);
    sum_.Add(arriving * material.specular, faces ? highlight : BrokenOff(highlight));
    return true;
  }

  static Jet SquaredDistance(const JetHit<D>& hit, const Light& light, const Vector& segment) {
    const JetShape& shape = *hit.shape;
    if (!(shape.radius > 0)) return LengthSquared(segment);
    // |L - x|^2 = |L - c|^2 + r^2 - 2 (L - c).(x - c), and x - c is the object point, turned.
    const Vec3d from_center = light.position - shape.frame.center;
    const Vec3d l = MultiplyTransposed(shape.frame.world_from_object, from_center);
    const double constant = LengthSquared(from_center) + shape.radius * shape.radius;
    Jet square = Dot(hit.object_point, l) * -2.0 + constant;
    // The two sides differ by rounding of what cancels.
    square.slack = Above(square.slack + 32 * kOutward * constant);
    square.v =
        Outward(square.v.lo - 32 * kOutward * constant, square.v.hi + 32 * kOutward * constant);
    return square;
  }

  // max(0, f), interpolated between max(0, k), for sums only. The interpolant Q+ is no less than
  // max(0, Q), being the mean of a convex function, and where the corners k lie in [-n, p] no more
  // than the chord of max(0, .) over that interval at Q, which exceeds max(0, Q) by n p / (n + p)
  // at most. With f - Q in [-L, U] at some place, U and L not negative, max(0, f) - max(0, Q) is in
  // [-L, U], too. So Q+ is below max(0, f) by at most U, and above it by at most L and that excess.
  static Jet Positive(const Jet& f) {
    const Pack<D> zero = Pack<D>::All(0);
    const IntervalPack<D> s = f.s();
    Jet r;
    r.v = {std::max(0.0, f.lo()), std::max(0.0, f.hi())};
    r.k = Max(Pack<Jet::kCorners>::All(0), f.k);
    r.slack = f.slack;
    r.ds = Combine(IntervalPack<D>::All({0, 0}), IntervalPack<D>{Min(zero, s.lo), Max(zero, s.hi)});
    return r;
  }
  static double ExcessOfPositive(const Jet& f) {
    const double n = std::max(0.0, -SmallestLane(f.k)), p = std::max(0.0, LargestLane(f.k));
    return n > 0 && p > 0 ? Above(n * (p / (n + p))) : 0;
  }
  // f at some rays and 0 at the others: anything in its range.
  static Jet BrokenOff(const Jet& f) {
    const double most = std::max(0.0, f.hi());
    Jet r = Jet::Constant(most / 2);
    r.v = {0, most};
    r.slack = Above(most / 2);
    return r;
  }

  // A light that arrives; `faces`: at all hits, not only at some.
  struct Shining {
    const Light* light;
    Rgb arriving;
    bool faces;
  };

  const PathCertifier::Context& context_;
  RadianceSum<D>& sum_;
  std::vector<Shining> shining_;  // of one call of Add; kept for its room
};

}  // namespace linetree::LINETREE_JETS
LINETREE_AFTER_JETS();

#endif
