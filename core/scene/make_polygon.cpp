#include <algorithm>

#include "absl/strings/str_cat.h"
#include "core/scene/make_shape.h"
#include "core/scene/planar_loop.h"

namespace linetree {
namespace {

absl::StatusOr<PolygonShape> ToWorld(std::vector<Vec3d> vertices, const AffineMap& map) {
  for (Vec3d& v : vertices) {
    v = Apply(map, v);
    if (auto s = CheckPoint("transform", v); !s.ok()) return s;
  }
  return MakePolygon(std::move(vertices));
}

}  // namespace

absl::StatusOr<Shape> MakeConvexPolygon(const std::vector<Vec3d>& vertices, const AffineMap& map) {
  if (auto inverse = InverseLinear(map); !inverse.ok()) return inverse.status();
  auto loop = MakePlanarLoop(vertices);
  if (!loop.ok()) return loop.status();
  if (!loop->convex) return absl::InvalidArgumentError("vertices: expected a convex polygon");
  auto polygon = ToWorld(std::move(loop->vertices), map);
  if (!polygon.ok()) return polygon.status();
  return *std::move(polygon);
}

absl::StatusOr<Shape> MakeTriangle(const std::vector<Vec3d>& vertices,
                                   const std::vector<Vec3d>& normals, const AffineMap& map) {
  auto inverse = InverseLinear(map);
  if (!inverse.ok()) return inverse.status();
  if (vertices.size() != 3) {
    return absl::InvalidArgumentError(absl::StrCat("vertices: expected 3, got ", vertices.size()));
  }
  if (!normals.empty() && normals.size() != 3) {
    return absl::InvalidArgumentError(
        absl::StrCat("normals: expected 0 or 3, got ", normals.size()));
  }
  // The vertices are taken as they are: normals[i] belongs to vertices[i].
  if (auto loop = MakePlanarLoop(vertices); !loop.ok()) return loop.status();
  auto polygon = ToWorld(vertices, map);
  if (!polygon.ok()) return polygon.status();
  if (normals.empty()) return *std::move(polygon);
  TriangleShape triangle{*std::move(polygon), {}};
  for (size_t i = 0; i < 3; ++i) {
    if (auto s = CheckDirection(absl::StrCat("normals[", i, "]"), normals[i]); !s.ok()) return s;
    triangle.normals[i] = Unit(MultiplyTransposed(*inverse, Unit(normals[i])));
  }
  return triangle;
}

}  // namespace linetree
