#include "core/scene/shape.h"

#include "core/math/check.h"

namespace linetree {
namespace {

template <class... F>
struct Overloaded : F... {
  using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;

Box3 BoundsOf(const SphereShape& s) {
  Box3 box;
  Vec3d half;
  for (int i = 0; i < 3; ++i)
    half[i] = Length(s.frame.world_from_object.row[static_cast<size_t>(i)]);
  box.Add(s.frame.center - half);
  box.Add(s.frame.center + half);
  return box;
}

Box3 BoundsOf(const BoxShape& s) {
  Box3 box;
  Vec3d half;
  for (int i = 0; i < 3; ++i) {
    const Vec3d& row = s.frame.world_from_object.row[static_cast<size_t>(i)];
    half[i] = std::abs(row.x) + std::abs(row.y) + std::abs(row.z);
  }
  box.Add(s.frame.center - half);
  box.Add(s.frame.center + half);
  return box;
}

// The ellipse of object radius r at height z.
void AddEllipse(const AffineFrame& frame, double z, double r, Box3& box) {
  Vec3d half, middle;
  for (int i = 0; i < 3; ++i) {
    const Vec3d& row = frame.world_from_object.row[static_cast<size_t>(i)];
    half[i] = r * std::sqrt(row.x * row.x + row.y * row.y);
    middle[i] = frame.center[i] + row.z * z;
  }
  box.Add(middle - half);
  box.Add(middle + half);
}

Box3 BoundsOf(const FrustumShape& s) {
  Box3 box;
  AddEllipse(s.frame, 0, s.base_radius, box);
  AddEllipse(s.frame, 1, s.top_radius, box);
  return box;
}

Box3 BoundsOf(const DiscShape& s) {
  Box3 box;
  AddEllipse(s.frame, 0, 1, box);
  return box;
}

Box3 BoundsOfPoints(const std::vector<Vec3d>& points) {
  Box3 box;
  for (const Vec3d& p : points) box.Add(p);
  return box;
}
Box3 BoundsOf(const PolygonShape& s) { return BoundsOfPoints(s.vertices); }
Box3 BoundsOf(const TriangleShape& s) { return BoundsOfPoints(s.polygon.vertices); }
Box3 BoundsOf(const PolyhedronShape& s) { return BoundsOfPoints(s.vertices); }

// Newell's normal: the area-weighted one, which also serves nearly collinear corners.
Vec3d NewellNormal(const std::vector<Vec3d>& vertices) {
  Vec3d sum;
  for (size_t i = 1; i + 1 < vertices.size(); ++i) {
    sum = sum + Cross(vertices[i] - vertices[0], vertices[i + 1] - vertices[0]);
  }
  return Normalized(sum);
}

}  // namespace

bool IsSolid(const Shape& shape) {
  return std::visit(
      Overloaded{[](const SphereShape&) { return true; }, [](const BoxShape&) { return true; },
                 [](const FrustumShape& s) { return !s.open; },
                 [](const DiscShape&) { return false; }, [](const PolygonShape&) { return false; },
                 [](const TriangleShape&) { return false; },
                 [](const PolyhedronShape&) { return true; }},
      shape);
}

bool IsPlanar(const Shape& shape) {
  return std::holds_alternative<DiscShape>(shape) || std::holds_alternative<PolygonShape>(shape) ||
         std::holds_alternative<TriangleShape>(shape);
}

int FaceCount(const Shape& shape) {
  return std::visit(
      Overloaded{[](const BoxShape&) { return 6; },
                 [](const FrustumShape& s) { return s.open ? 1 : 3; },
                 [](const PolyhedronShape& s) { return static_cast<int>(s.faces.size()); },
                 [](const auto&) { return 1; }},
      shape);
}

Box3 Bounds(const Shape& shape) {
  Box3 box = std::visit([](const auto& s) { return BoundsOf(s); }, shape);
  for (int i = 0; i < 3; ++i) {
    const double pad = kBoundsPad * std::max(std::abs(box.min[i]), std::abs(box.max[i]));
    box.min[i] -= pad;
    box.max[i] += pad;
  }
  return box;
}

PolygonShape MakePolygon(std::vector<Vec3d> vertices) {
  LT_CHECK(vertices.size() >= 3);
  PolygonShape polygon;
  polygon.plane = {NewellNormal(vertices), vertices[0]};
  polygon.edges.reserve(vertices.size());
  for (size_t i = 0; i < vertices.size(); ++i) {
    const Vec3d& a = vertices[i];
    const Vec3d& b = vertices[(i + 1) % vertices.size()];
    polygon.edges.push_back({Normalized(Cross(b - a, polygon.plane.normal)), a});
  }
  polygon.vertices = std::move(vertices);
  return polygon;
}

}  // namespace linetree
