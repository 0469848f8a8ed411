// Where the rays of a bundle meet one face of an object: the intersection formulas in jets.
//
// A hit is evaluated on the face's whole surface (the plane, the quadric), whether or not all rays
// meet it inside the face; IsContained says whether they certainly do. Formulas are those in which
// jets stay narrow (DESIGN, section 5): the discriminant of a quadric as |q|^2 - |p x q|^2, its far
// side as -2B/A, containment in planar faces as a polynomial instead of at the rational hit point.
#if defined(LINETREE_CORE_CERTIFY_HIT_EVALUATOR_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_CERTIFY_HIT_EVALUATOR_INL_H_
#undef LINETREE_CORE_CERTIFY_HIT_EVALUATOR_INL_H_
#else
#define LINETREE_CORE_CERTIFY_HIT_EVALUATOR_INL_H_
#endif

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/certify/jet_hit-inl.h"
#include "core/certify/margins-inl.h"
#include "core/certify/surface_tangents-inl.h"

LINETREE_BEFORE_JETS();
namespace linetree::LINETREE_JETS {

template <size_t D>
class HitEvaluator {
 public:
  using Jet = CornerJet<D>;
  using Vector = JetVector<D>;

  explicit HitEvaluator(const JetRay<D>& ray) : ray_(ray) {}

  // The bundle's hits with the surface of one face, seen from `side`. `start_face` is the face of
  // the same object on which the rays start, or -1 when they start elsewhere. False where the jets
  // can't say that every ray meets it.
  bool Evaluate(const JetShape& shape, int face, Side side, int start_face, JetHit<D>& hit) const {
    hit.shape = &shape;
    hit.face = face;
    hit.side = side;
    if (const Plane* plane = shape.PlaneOf(face)) return EvaluatePlane(*plane, hit);
    hit.curved = true;
    return shape.kind == JetShape::Kind::kSphere ? EvaluateSphere(start_face >= 0, hit)
                                                 : EvaluateLateral(start_face == face, hit);
  }

  // Whether all of these hits certainly lie inside the face.
  bool IsContained(const JetHit<D>& hit) const {
    const JetShape& shape = *hit.shape;
    switch (shape.kind) {
      case JetShape::Kind::kSphere:
        return true;
      case JetShape::Kind::kFrustum:
        return hit.curved ? !hit.behind_wall && IsBetweenCaps(hit) : IsInsideCap(hit);
      case JetShape::Kind::kPlanes:
        return IsInsidePlanes(shape.planes, hit);
      case JetShape::Kind::kPolygon:
        return IsInsidePlanes(shape.edges, hit);
      case JetShape::Kind::kDisc:
        return IsInsideDisc(hit);
    }
    return false;
  }

  // A bundle whose rays start on the plane that they meet, as in the charts of planar shapes.
  bool EvaluateOnPlane(const JetShape& shape, JetHit<D>& hit) const {
    hit.shape = &shape;
    const Vec3d& n = shape.planes[0].normal;
    Jet slope = Dot(ray_.direction, n);
    if (IsNegative(slope, 1)) {
      hit.sign = 1;
    } else if (IsPositive(slope, 1)) {
      hit.sign = -1;
    } else {
      return false;
    }
    hit.point = ray_.origin;
    return SetPlaneNormal(n, slope, hit);
  }

 private:
  bool EvaluatePlane(const Plane& plane, JetHit<D>& hit) const {
    const Jet& slope = hit.slope = Dot(ray_.direction, plane.normal);
    const double scale = SlopeScale();
    const bool thin = hit.shape->IsThin();
    const bool against = IsNegative(slope, scale), along = IsPositive(slope, scale);
    if (!against && !along) return false;
    if (!thin && against != (hit.side == Side::kOutside)) return false;
    hit.sign = against ? 1 : -1;
    hit.distance = Dot(ray_.origin - plane.point, plane.normal);
    const Jet t = hit.distance * Inverse(slope) * -1.0;
    if (!IsAhead(t, *hit.shape)) return false;
    hit.point = ray_.origin + ray_.direction * t;
    return SetPlaneNormal(plane.normal, slope, hit);
  }

  bool SetPlaneNormal(const Vec3d& n, const Jet& slope, JetHit<D>& hit) const {
    if (hit.shape->corner_normals.empty()) {
      hit.flat = true;
      hit.flat_normal = n * hit.sign;
      hit.cosine = slope * -hit.sign;
      return true;
    }
    Vector sum = Vector::Constant({});
    for (size_t i = 0; i < 3; ++i) {
      const Plane& opposite = hit.shape->edges[(i + 1) % 3];
      const Jet weight =
          Dot(hit.point - opposite.point, opposite.normal) * (1 / hit.shape->heights[i]);
      sum = sum + hit.shape->corner_normals[i] * weight;
    }
    const Jet square = LengthSquared(sum);
    if (!(square.lo() > kSignMargin)) return false;
    const Vector normal = sum * InverseSquareRoot(square);
    const Jet facing = Dot(ray_.direction, normal);
    const bool against = IsNegative(facing, SlopeScale());
    if (!against && !IsPositive(facing, SlopeScale())) return false;
    hit.normal = against ? normal : -normal;
    hit.cosine = against ? -facing : facing;
    return true;
  }

  // Lengths that hits' parameters are measured in.
  double SlopeScale() const {
    return ray_.between_planes
               ? std::max({ray_.direction.x.v.Magnitude(), ray_.direction.y.v.Magnitude(),
                           ray_.direction.z.v.Magnitude()})
               : 1;
  }
  double OriginScale(const JetShape& shape) const { return shape.reach + SizeOf(ray_.origin); }
  bool IsAhead(const Jet& t, const JetShape& shape) const {
    return ray_.between_planes || IsPositive(t, OriginScale(shape));
  }

  struct Line {
    Vector p, q;
  };
  Line ToObject(const AffineFrame& frame) const {
    return {frame.object_from_world * (ray_.origin - frame.center),
            frame.object_from_world * ray_.direction};
  }
  static double SizeOf(const Vector& p) {
    return p.x.v.Magnitude() + p.y.v.Magnitude() + p.z.v.Magnitude();
  }
  // Object coordinates are in units of the object's size, whose rounding the world's distances set.
  double ObjectScale(const JetShape& shape, const Line& line) const {
    return 1 + shape.frame_rows * OriginScale(shape) + SizeOf(line.p);
  }

  bool EvaluateSphere(bool from_itself, JetHit<D>& hit) const {
    const JetShape& shape = *hit.shape;
    const Line line = ToObject(shape.frame);
    const auto& [p, q] = line;
    const Jet a = SquareOfDirection(shape, q);
    const Jet b = Dot(p, q);
    const double scale = ObjectScale(shape, line);
    const double slopes = std::sqrt(a.hi());
    if (!(a.lo() > 0)) return false;
    const bool entering = hit.side == Side::kOutside;
    if (from_itself) {
      if (entering || !IsNegative(b, scale * slopes)) return false;
      const Jet t = OverSquare(b, a, shape) * -2.0;
      return FinishCurved(-b, t, line, hit);
    }
    const Jet x = p.y * q.z - p.z * q.y, y = p.z * q.x - p.x * q.z, z = p.x * q.y - p.y * q.x;
    Jet discriminant = a - (Square(x) + Square(y) + Square(z));
    // Along each coordinate of a chart between two planes it is a quadratic polynomial whose
    // leading coefficient is the discriminant of a line in the plane of a face of the bounding box,
    // which the sphere does not cross: not positive.
    if (ray_.between_planes) discriminant.AssumeConcave();
    if (!IsPositive(discriminant, scale * (1 + SizeOf(p)) * a.hi())) return false;
    const Jet root = SquareRoot(discriminant);
    Jet t = OverSquare(entering ? -b - root : root - b, a, shape);
    if (ray_.between_planes) t.AssumeWithin(0, 1);
    if (!IsAhead(t, shape)) return false;
    return FinishCurved(root, t, line, hit);
  }

  // |q|^2 in the object frame, which for unit directions and spheres is a constant: 1 / radius^2.
  bool HasConstantSquare(const JetShape& shape) const {
    return !ray_.between_planes && shape.radius > 0;
  }
  Jet SquareOfDirection(const JetShape& shape, const Vector& q) const {
    if (!HasConstantSquare(shape)) return LengthSquared(q);
    const double square = 1 / (shape.radius * shape.radius);
    return AlmostConstant(square, kSimilarity * square);
  }
  Jet OverSquare(const Jet& f, const Jet& a, const JetShape& shape) const {
    if (!HasConstantSquare(shape)) return f * Inverse(a);
    const double factor = shape.radius * shape.radius;
    Jet r = f * factor;
    r.Widen(kSimilarity * r.v.Magnitude());
    return r;
  }

  bool EvaluateLateral(bool from_itself, JetHit<D>& hit) const {
    const JetShape& shape = *hit.shape;
    const Line line = ToObject(shape.frame);
    const auto& [p, q] = line;
    const Jet w = p.z * shape.taper + shape.base_radius;
    const Jet slope = q.z * shape.taper;
    const Jet a = Square(q.x) + Square(q.y) - Square(slope);
    const Jet b = p.x * q.x + p.y * q.y - w * slope;
    const double scale = ObjectScale(shape, line);
    const double squares = a.v.Magnitude() + Square(q.z.v).hi;
    if (!IsPositive(a, squares)) return false;
    const bool entering = hit.side == Side::kOutside;
    if (from_itself) {
      if (entering || !IsNegative(b, scale * std::sqrt(squares))) return false;
      const Jet t = b * Inverse(a) * -2.0;
      return IsAhead(t, shape) && FinishCurved(-b, t, line, hit);
    }
    const Jet discriminant = Square(p.x * slope - w * q.x) + Square(p.y * slope - w * q.y) -
                             Square(p.x * q.y - p.y * q.x);
    if (!IsPositive(discriminant, scale * (1 + SizeOf(p)) * squares)) return false;
    const Jet root = SquareRoot(discriminant);
    if (shape.open && !entering) {
      const Jet before = Jet(-b - root) * Inverse(a);
      hit.behind_wall = !ComesThroughEnd(line, before, shape);
    }
    const Jet t = Jet(entering ? -b - root : root - b) * Inverse(a);
    return IsAhead(t, shape) && FinishCurved(root, t, line, hit);
  }

  // Whether no ray crosses the lateral surface between its ends at `t`, or all do so behind their
  // origins.
  bool ComesThroughEnd(const Line& line, const Jet& t, const JetShape& shape) const {
    if (!ray_.between_planes && IsNegative(t, OriginScale(shape))) return true;
    const double scale = ObjectScale(shape, line);
    const Jet z = line.p.z + line.q.z * t;
    return IsNegative(z, scale) || IsPositive(Jet(z + -1.0), scale);
  }

  // `root` is the square root of the discriminant: at a hit the quadratic form's derivative along
  // the ray, q.gradient, is -root on entry and +root on exit.
  bool FinishCurved(const Jet& root, Jet t, const Line& line, JetHit<D>& hit) const {
    const JetShape& shape = *hit.shape;
    hit.sign = hit.side == Side::kOutside ? 1 : -1;
    Vector& m = hit.object_point = line.p + line.q * t;
    if (shape.kind == JetShape::Kind::kSphere) {
      for (Jet* c : {&m.x, &m.y, &m.z}) c->AssumeWithin(-1, 1);
    }
    QuadricAt at{{m.x.v, m.y.v, m.z.v}, 1, root.v * -hit.sign};
    if (shape.kind == JetShape::Kind::kFrustum) {
      at.gradient[2] = (m.z.v * shape.taper + shape.base_radius) * -shape.taper;
      at.z_square = -shape.taper * shape.taper;
    }
    TightenOnSurface(line.p, line.q, at, t, m);
    Vector gradient = m;
    Jet w = Jet::Constant(1);
    if (shape.kind == JetShape::Kind::kFrustum) {
      w = m.z * shape.taper + shape.base_radius;
      if (!(w.lo() > kApexShare * shape.FrameScale())) return false;
      gradient.z = w * -shape.taper;
    }
    const Vector outward = MultiplyTransposed(shape.frame.object_from_world, gradient);
    if (shape.radius > 0) {
      // The object point turned and scaled: the world point is center + radius * outward normal.
      const Vector normal = outward * shape.radius;
      hit.point = normal * shape.radius - -shape.frame.center;
      for (Jet* c : {&hit.point.x, &hit.point.y, &hit.point.z}) c->Widen(kSimilarity * shape.reach);
      hit.normal = normal * hit.sign;
      hit.cosine = root * shape.radius;
      return true;
    }
    hit.point = ray_.origin + ray_.direction * t;
    if (shape.slant > 0) {
      hit.inverse_length = Inverse(w) * (1 / shape.slant);
      hit.inverse_length.Widen(kSimilarity * hit.inverse_length.hi());
    } else {
      const Jet square = LengthSquared(outward);
      if (!(square.lo() > 0)) return false;
      hit.inverse_length = InverseSquareRoot(square);
    }
    hit.normal = outward * hit.inverse_length * hit.sign;
    hit.cosine = root * hit.inverse_length;
    return true;
  }

  static Jet AlmostConstant(double c, double error) {
    Jet jet = Jet::Constant(c);
    jet.Widen(error);
    return jet;
  }

  bool IsBetweenCaps(const JetHit<D>& hit) const {
    const Jet& z = hit.object_point.z;
    const double margin = MarginOf(z, ObjectScale(*hit.shape, ToObject(hit.shape->frame)));
    return z.lo() > margin && z.hi() < 1 - margin;
  }
  // x^2 + y^2 - w^2 < 0 at the hit point in the object frame.
  bool IsInsideCap(const JetHit<D>& hit) const {
    const JetShape& shape = *hit.shape;
    const Vector p = shape.frame.object_from_world * (hit.point - shape.frame.center);
    const double w = hit.face == 1 ? shape.base_radius : shape.base_radius + shape.taper;
    return IsNegative(Jet(Square(p.x) + Square(p.y) + -(w * w)),
                      ObjectScale(shape, ToObject(shape.frame)));
  }
  bool IsInsideDisc(const JetHit<D>& hit) const {
    const JetShape& shape = *hit.shape;
    const Vector p = shape.frame.object_from_world * (hit.point - shape.frame.center);
    return IsNegative(Jet(Square(p.x) + Square(p.y) + -1.0),
                      ObjectScale(shape, ToObject(shape.frame)));
  }

  bool IsInsidePlanes(const std::vector<Plane>& sides, const JetHit<D>& hit) const {
    const Plane* own = hit.shape->PlaneOf(hit.face);
    return std::all_of(sides.begin(), sides.end(), [&](const Plane& side) {
      return &side == own || IsClearlyInside(side, hit) || IsInsidePlane(side, hit);
    });
  }
  // By the ranges of the hit point alone: cheap, and enough for most sides of most faces.
  bool IsClearlyInside(const Plane& side, const JetHit<D>& hit) const {
    const double steepest = hit.slope.v.Magnitude();
    const double flattest = std::max(hit.slope.lo(), -hit.slope.hi());
    double margin = kSignMargin * OriginScale(*hit.shape) * steepest / flattest;
    Interval distance;
    const Jet* point[3] = {&hit.point.x, &hit.point.y, &hit.point.z};
    for (int i = 0; i < 3; ++i) {
      const double n = side.normal[i];
      distance = distance + (point[i]->v + -side.point[i]) * n;
      margin += kDrift * std::abs(n) * point[i]->Variation();
    }
    return distance.hi < -margin;
  }
  // With distances f, slopes f' from the hit's plane and e, e' from a side's, the hit's distance
  // from the side is e - e' f / f': of the sign of e |f'| + e' f where f' < 0, else of e |f'| - e'
  // f.
  bool IsInsidePlane(const Plane& side, const JetHit<D>& hit) const {
    const bool against = hit.slope.hi() < 0;
    const double scale = OriginScale(*hit.shape) * hit.slope.v.Magnitude();
    const Jet e = Dot(ray_.origin - side.point, side.normal);
    const Jet rise = Dot(ray_.direction, side.normal);
    const Jet f =
        against ? rise * hit.distance - e * hit.slope : e * hit.slope - rise * hit.distance;
    return IsNegative(f, scale);
  }

  const JetRay<D>& ray_;
};

}  // namespace linetree::LINETREE_JETS
LINETREE_AFTER_JETS();

#endif
