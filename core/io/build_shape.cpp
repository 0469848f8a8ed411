#include "core/io/build_shape.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "core/io/scene_source.h"
#include "core/io/split_polygon.h"
#include "core/io/validate.h"
#include "core/scene/make_shape.h"
#include "core/scene/planar_loop.h"

namespace linetree {
namespace {

std::vector<Vec3d> ToPoints(const google::protobuf::RepeatedPtrField<v1::Vec3>& message) {
  std::vector<Vec3d> points;
  points.reserve(static_cast<size_t>(message.size()));
  for (const v1::Vec3& v : message) points.push_back(ToVec3(v));
  return points;
}

absl::StatusOr<std::vector<Shape>> One(absl::StatusOr<Shape> shape) {
  if (!shape.ok()) return shape.status();
  std::vector<Shape> shapes;
  shapes.push_back(*std::move(shape));
  return shapes;
}

absl::StatusOr<std::vector<Shape>> Polygons(const v1::Polygon& message, const AffineMap& map) {
  const std::vector<Vec3d> vertices = ToPoints(message.vertices());
  auto loop = MakePlanarLoop(vertices);
  if (!loop.ok()) return loop.status();
  if (loop->convex) return One(MakeConvexPolygon(vertices, map));
  auto pieces = SplitPolygon(*loop);
  if (!pieces.ok()) return pieces.status();
  std::vector<Shape> shapes;
  for (const std::vector<Vec3d>& piece : *pieces) {
    auto shape = MakeConvexPolygon(piece, map);
    if (!shape.ok()) return shape.status();
    shapes.push_back(*std::move(shape));
  }
  return shapes;
}

absl::StatusOr<Shape> Polyhedron(const v1::Polyhedron& message, const AffineMap& map) {
  std::vector<HalfSpace> half_spaces;
  for (const v1::HalfSpace& h : message.half_spaces()) {
    half_spaces.push_back({ToVec3(h.normal()), h.offset()});
  }
  return MakePolyhedron(half_spaces, map);
}

// Without places: errors name fields of the shape's message.
absl::StatusOr<std::vector<Shape>> Make(const v1::Object& o, const AffineMap& map) {
  switch (o.shape_case()) {
    case v1::Object::kSphere:
      return One(MakeSphere(ToVec3(o.sphere().center()), o.sphere().radius(), map));
    case v1::Object::kEllipsoid:
      return One(
          MakeEllipsoid(ToVec3(o.ellipsoid().center()), ToVec3(o.ellipsoid().semi_axes()), map));
    case v1::Object::kBox:
      return One(MakeBox(ToVec3(o.box().min()), ToVec3(o.box().max()), map));
    case v1::Object::kCylinder: {
      const v1::Cylinder& c = o.cylinder();
      // Here, because a cylinder's field is called radius.
      if (auto s = CheckLength("radius", c.radius()); !s.ok()) return s;
      return One(
          MakeFrustum({ToVec3(c.base()), ToVec3(c.top()), c.radius(), c.radius(), c.open()}, map));
    }
    case v1::Object::kCone: {
      const v1::Cone& c = o.cone();
      return One(MakeFrustum(
          {ToVec3(c.base()), ToVec3(c.top()), c.base_radius(), c.top_radius(), c.open()}, map));
    }
    case v1::Object::kDisc:
      return One(
          MakeDisc(ToVec3(o.disc().center()), ToVec3(o.disc().normal()), o.disc().radius(), map));
    case v1::Object::kPolygon:
      return Polygons(o.polygon(), map);
    case v1::Object::kTriangle:
      return One(
          MakeTriangle(ToPoints(o.triangle().vertices()), ToPoints(o.triangle().normals()), map));
    case v1::Object::kPolyhedron:
      return One(Polyhedron(o.polyhedron(), map));
    case v1::Object::SHAPE_NOT_SET:
      break;
  }
  return absl::InvalidArgumentError(
      "expected a shape (sphere, ellipsoid, box, cylinder, cone, disc, polygon, triangle or "
      "polyhedron)");
}

// The name of the shape's field in v1::Object: "sphere".
std::string ShapeField(const v1::Object& message) {
  const auto* descriptor = v1::Object::descriptor();
  return descriptor->FindFieldByNumber(message.shape_case())->name();
}

}  // namespace

absl::StatusOr<std::vector<Shape>> BuildShapes(const SceneSource& source, const std::string& path,
                                               const v1::Object& message,
                                               const SceneLimits& limits) {
  auto map = ReadTransform(source, path, message);
  if (!map.ok()) return map.status();
  if (auto s = CheckLimit(source, path + ".polygon.vertices",
                          static_cast<uint64_t>(message.polygon().vertices_size()),
                          limits.max_polygon_vertices);
      !s.ok())
    return s;
  if (auto s = CheckLimit(source, path + ".polyhedron.half_spaces",
                          static_cast<uint64_t>(message.polyhedron().half_spaces_size()),
                          limits.max_half_spaces);
      !s.ok())
    return s;
  auto shapes = Make(message, *map);
  if (shapes.ok()) return shapes;
  const bool of_object = message.shape_case() == v1::Object::SHAPE_NOT_SET ||
                         shapes.status().message().substr(0, 10) == "transform:";
  return InField(source, of_object ? path : absl::StrCat(path, ".", ShapeField(message)),
                 shapes.status());
}

}  // namespace linetree
