// The hit itself, in double: the operations of TracerOf<double>::Complete and of what leads there,
// in their order.
#if defined(LINETREE_CORE_PACKET_FINISH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_PACKET_FINISH_INL_H_
#undef LINETREE_CORE_PACKET_FINISH_INL_H_
#else
#define LINETREE_CORE_PACKET_FINISH_INL_H_
#endif

#include <variant>

#include "core/packet/lanes-inl.h"
#include "core/packet/packet_scene.h"
#include "core/trace/intersect_quadric.h"

HWY_BEFORE_NAMESPACE();
namespace linetree::HWY_NAMESPACE {

HWY_INLINE Doubles RowTimes(const Vec3d& row, const WideVectors& v) { return Dot(v, Spread(row)); }
HWY_INLINE WideVectors Times(const Mat3& m, const WideVectors& v) {
  return {RowTimes(m.row[0], v), RowTimes(m.row[1], v), RowTimes(m.row[2], v)};
}
// As MultiplyTransposed.
HWY_INLINE WideVectors TransposedTimes(const Mat3& m, const WideVectors& v) {
  const auto column = [&](int i) HWY_ATTR {
    return v.x * Doubles::All(m.row[0][i]) + v.y * Doubles::All(m.row[1][i]) +
           v.z * Doubles::All(m.row[2][i]);
  };
  return {column(0), column(1), column(2)};
}

// The lanes of one packet that meet the same face of one object from the same side.
class Finisher {
 public:
  HWY_INLINE Finisher(const WideVectors& origin, const WideVectors& direction, int face,
                      bool inside)
      : origin_(origin), direction_(direction), face_(face), inside_(inside) {}

  HWY_INLINE Doubles T(const SphereShape& s) const {
    const auto [p, q] = ToObject(s.frame);
    const Doubles a = Dot(q, q);
    const WideVectors cross = {p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x};
    const Doubles discriminant = a - Dot(cross, cross);
    const Doubles c = Dot(p, p) - Doubles::All(1);
    return Root(a, Dot(p, q), c, Sqrt(discriminant));
  }
  HWY_INLINE Doubles T(const BoxShape& s) const {
    const Vec3d& row = s.frame.object_from_world.row[static_cast<size_t>(face_ / 2)];
    const Doubles p = RowTimes(row, origin_ - Spread(s.frame.center));
    const Doubles q = RowTimes(row, direction_);
    const Doubles one = Doubles::All(1);
    return face_ % 2 == 0 ? -(-p - one) / -q : -(p - one) / q;
  }
  HWY_INLINE Doubles T(const FrustumShape& s) const {
    const auto [p, q] = ToObject(s.frame);
    if (face_ == kBaseFace) return -p.z / q.z;
    if (face_ == kTopFace) return (Doubles::All(1) - p.z) / q.z;
    const Doubles from = -Dot(p, q) / Dot(q, q);
    const WideVectors near = p + q * from;
    const Doubles taper = Doubles::All(s.top_radius - s.base_radius);
    const Doubles w = Doubles::All(s.base_radius) + taper * near.z;
    const Doubles slope = taper * q.z;
    const Doubles xw = near.x * slope - w * q.x, yw = near.y * slope - w * q.y;
    const Doubles xy = near.x * q.y - near.y * q.x;
    const Doubles a = q.x * q.x + q.y * q.y - slope * slope;
    const Doubles b = near.x * q.x + near.y * q.y - w * slope;
    const Doubles c = near.x * near.x + near.y * near.y - w * w;
    return Root(a, b, c, Sqrt(xw * xw + yw * yw - xy * xy)) + from;
  }
  HWY_INLINE Doubles T(const DiscShape& s) const { return PlaneT(s.plane); }
  HWY_INLINE Doubles T(const PolygonShape& s) const { return PlaneT(s.plane); }
  HWY_INLINE Doubles T(const TriangleShape& s) const { return PlaneT(s.polygon.plane); }
  HWY_INLINE Doubles T(const PolyhedronShape& s) const {
    return PlaneT(s.faces[static_cast<size_t>(face_)]);
  }

  // Outward normals of faces that are not flat.
  HWY_INLINE WideVectors Curved(const SphereShape& s, const WideVectors& point) const {
    const Mat3& m = s.frame.object_from_world;
    return TransposedTimes(m, Times(m, point - Spread(s.frame.center)));
  }
  HWY_INLINE WideVectors Curved(const FrustumShape& s, const WideVectors& point) const {
    const Mat3& m = s.frame.object_from_world;
    const WideVectors p = Times(m, point - Spread(s.frame.center));
    const Doubles taper = Doubles::All(s.top_radius - s.base_radius);
    const Doubles w = Doubles::All(s.base_radius) + taper * p.z;
    return TransposedTimes(m, {p.x, p.y, -w * taper});
  }
  HWY_INLINE WideVectors Curved(const TriangleShape& s, const WideVectors& point) const {
    WideVectors sum = Spread(Vec3d{});
    for (size_t i = 0; i < 3; ++i) {
      const Plane& opposite = s.polygon.edges[(i + 1) % 3];
      const double height = SignedDistance(opposite, s.polygon.vertices[i]);
      const Doubles weight =
          Dot(point - Spread(opposite.point), Spread(opposite.normal)) / Doubles::All(height);
      sum = sum + Spread(s.normals[i]) * weight;
    }
    return sum;
  }

 private:
  struct Line {
    WideVectors p, q;
  };
  HWY_INLINE Line ToObject(const AffineFrame& frame) const {
    return {Times(frame.object_from_world, origin_ - Spread(frame.center)),
            Times(frame.object_from_world, direction_)};
  }
  HWY_INLINE Doubles PlaneT(const Plane& plane) const {
    const WideVectors normal = Spread(plane.normal);
    return -Dot(origin_ - Spread(plane.point), normal) / Dot(direction_, normal);
  }
  // One of StableRoots, for roots that are clearly apart.
  HWY_INLINE Doubles Root(const Doubles& a, const Doubles& b, const Doubles& c,
                          const Doubles& s) const {
    const WideMask positive = b >= Doubles::All(0);
    const Doubles k = Select(positive, -(b + s), s - b);
    // k / a is the first root where b >= 0 and the second one elsewhere, c / k the other.
    return inside_ ? Select(positive, c, k) / Select(positive, k, a)
                   : Select(positive, k, c) / Select(positive, a, k);
  }

  const WideVectors& origin_;
  const WideVectors& direction_;
  const int face_;
  const bool inside_;
};

// As Normalized.
HWY_INLINE WideVectors Normalized(const WideVectors& v, const Doubles& square) {
  return v * (Doubles::All(1) / Sqrt(square));
}

struct FinishedHit {
  Doubles t;
  WideVectors point, normal;
  WideMask good;  // elsewhere there is no normal
};

// `known_t`: the parameter, where some lanes have one already (with `known`).
HWY_INLINE FinishedHit Finish(const PacketScene& scene, int32_t object, int face, bool inside,
                              const WideVectors& origin, const WideVectors& direction,
                              const double* known_t, const WideMask& known) {
  const Shape& shape = scene.scene().objects[static_cast<size_t>(object)].shape;
  const Finisher finisher(origin, direction, face, inside);
  FinishedHit hit;
  const Doubles zero = Doubles::All(0);
  hit.good = zero <= zero;
  std::visit(
      [&](const auto& s) HWY_ATTR {
        hit.t = finisher.T(s);
        if (known_t != nullptr) hit.t = Select(known, Doubles::Load(known_t), hit.t);
        hit.point = origin + direction * hit.t;
        if constexpr (requires { finisher.Curved(s, hit.point); }) {
          if (!scene.IsFlat(object, face)) {
            const WideVectors outward = finisher.Curved(s, hit.point);
            const Doubles square = Dot(outward, outward);
            hit.good = square > zero;
            hit.normal = Normalized(outward, square);
            return;
          }
        }
        hit.normal = Spread(scene.FlatNormal(object, face));
      },
      shape);
  hit.normal = Select(Dot(hit.normal, direction) > zero, -hit.normal, hit.normal);
  return hit;
}

}  // namespace linetree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
