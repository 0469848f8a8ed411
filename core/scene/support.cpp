#include "core/scene/support.h"

#include <algorithm>
#include <cmath>

namespace linetree {
namespace {

// Squares instead of std::hypot: lengths of shapes and normals keep them clear of the exponent's
// ends, and what underflows next to an end of a frustum is nothing beside the end's own rounding.
double FlatLength(const Vec3d& g) { return std::sqrt(g.x * g.x + g.y * g.y); }

// n.W p = (W^T n).p: the linear function that n is in object space.
Vec3d Gradient(const AffineFrame& frame, const Vec3d& n) {
  return MultiplyTransposed(frame.world_from_object, n);
}

// The supremum of g.p over the canonical sets of shape.h.
double ObjectSupport(const SphereShape&, const Vec3d& g) { return Length(g); }
double ObjectSupport(const BoxShape&, const Vec3d& g) {
  return std::abs(g.x) + std::abs(g.y) + std::abs(g.z);
}
double ObjectSupport(const FrustumShape& s, const Vec3d& g) {
  const double flat = FlatLength(g);
  return std::max(s.base_radius * flat, s.top_radius * flat + g.z);
}
double ObjectSupport(const DiscShape&, const Vec3d& g) { return FlatLength(g); }

// A point of the circle of this radius; its middle where all points are equally far.
Vec3d OnCircle(const Vec3d& g, double radius, double z) {
  const double flat = FlatLength(g);
  if (!(flat > 0)) return {0, 0, z};
  const double k = radius / flat;
  return {g.x * k, g.y * k, z};
}

// Where the supremum is reached.
Vec3d ObjectPoint(const SphereShape&, const Vec3d& g) {
  const double length = Length(g);
  return length > 0 ? g * (1 / length) : Vec3d{};
}
Vec3d ObjectPoint(const BoxShape&, const Vec3d& g) {
  return {std::copysign(1.0, g.x), std::copysign(1.0, g.y), std::copysign(1.0, g.z)};
}
Vec3d ObjectPoint(const FrustumShape& s, const Vec3d& g) {
  const double flat = FlatLength(g);
  const bool top = s.top_radius * flat + g.z > s.base_radius * flat;
  return top ? OnCircle(g, s.top_radius, 1) : OnCircle(g, s.base_radius, 0);
}
Vec3d ObjectPoint(const DiscShape&, const Vec3d& g) { return OnCircle(g, 1, 0); }

Vec3d ObjectMiddle(const FrustumShape&) { return {0, 0, 0.5}; }
template <class Affine>
Vec3d ObjectMiddle(const Affine&) {
  return {};
}

const std::vector<Vec3d>& VerticesOf(const PolygonShape& s) { return s.vertices; }
const std::vector<Vec3d>& VerticesOf(const TriangleShape& s) { return s.polygon.vertices; }
const std::vector<Vec3d>& VerticesOf(const PolyhedronShape& s) { return s.vertices; }

template <class T>
concept Affine = requires(const T& s) {
  s.frame;
};

template <Affine T>
double SupportOf(const T& s, const Vec3d& n, const Vec3d& origin) {
  return Dot(n, s.frame.center - origin) + ObjectSupport(s, Gradient(s.frame, n));
}
template <class T>
double SupportOf(const T& s, const Vec3d& n, const Vec3d& origin) {
  double most = -Box3::kInf;
  for (const Vec3d& v : VerticesOf(s)) most = std::max(most, Dot(n, v - origin));
  return most;
}

template <Affine T>
Vec3d PointOf(const T& s, const Vec3d& n, const Vec3d& origin) {
  const Vec3d p = ObjectPoint(s, Gradient(s.frame, n));
  return (s.frame.center - origin) + s.frame.world_from_object * p;
}
template <class T>
Vec3d PointOf(const T& s, const Vec3d& n, const Vec3d& origin) {
  Vec3d farthest;
  double most = -Box3::kInf;
  for (const Vec3d& v : VerticesOf(s)) {
    const Vec3d x = v - origin;
    const double along = Dot(n, x);
    if (along > most) {
      most = along;
      farthest = x;
    }
  }
  return farthest;
}

template <Affine T>
Vec3d MiddleFrom(const T& s, const Vec3d& origin) {
  return (s.frame.center - origin) + s.frame.world_from_object * ObjectMiddle(s);
}
template <class T>
Vec3d MiddleFrom(const T& s, const Vec3d& origin) {
  const std::vector<Vec3d>& vertices = VerticesOf(s);
  Vec3d sum;
  for (const Vec3d& v : vertices) sum = sum + (v - origin);
  return sum * (1 / static_cast<double>(vertices.size()));
}

template <Affine T>
double ReachOf(const T& s, const Vec3d& origin) {
  const auto& [x, y, z] = s.frame.world_from_object.row;
  return Length(s.frame.center - origin) + Length(Vec3d{x.x, y.x, z.x}) +
         Length(Vec3d{x.y, y.y, z.y}) + Length(Vec3d{x.z, y.z, z.z});
}
template <class T>
double ReachOf(const T& s, const Vec3d& origin) {
  double most = 0;
  for (const Vec3d& v : VerticesOf(s)) {
    const Vec3d x = v - origin;
    most = std::max(most, std::abs(x.x) + std::abs(x.y) + std::abs(x.z));
  }
  return most;
}

}  // namespace

double Support(const Shape& shape, const Vec3d& n, const Vec3d& origin) {
  return std::visit([&](const auto& s) { return SupportOf(s, n, origin); }, shape);
}

Vec3d SupportPoint(const Shape& shape, const Vec3d& direction, const Vec3d& origin) {
  const double scale =
      1 / std::max({std::abs(direction.x), std::abs(direction.y), std::abs(direction.z)});
  return std::visit([&](const auto& s) { return PointOf(s, direction * scale, origin); }, shape);
}

Vec3d MiddleOf(const Shape& shape, const Vec3d& origin) {
  return std::visit([&](const auto& s) { return MiddleFrom(s, origin); }, shape);
}

double Reach(const Shape& shape, const Vec3d& origin) {
  return std::visit([&](const auto& s) { return ReachOf(s, origin); }, shape);
}

}  // namespace linetree
