#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "absl/strings/str_cat.h"
#include "core/math/box3.h"
#include "core/scene/make_shape.h"

namespace linetree {
namespace {

// Two unit normals whose cross product is shorter than this are taken as parallel; the line in
// which their planes meet would be off by more than 2^-52 / 2^-26 of the coordinates.
constexpr double kParallelSine = 0x1p-26;

// Vertices closer than this fraction of the largest coordinate are one; also how far inside of
// every face the middle of the vertices must lie for the interior not to be empty.
constexpr double kMergeTolerance = 0x1p-36;

struct Edge {
  Vec3d from, to;
};

enum class Clipped { kNone, kBounded, kUnbounded };

// What the half-spaces leave of the line in which planes i and j meet. Every vertex of a polyhedron
// is the end of such an edge, and an unbounded polyhedron with an edge has an unbounded one.
Clipped ClipLine(const std::vector<Plane>& planes, size_t i, size_t j, double tolerance,
                 Edge& edge) {
  const Vec3d &a = planes[i].normal, &b = planes[j].normal;
  const Vec3d direction = Cross(a, b);
  const double square = LengthSquared(direction);
  if (square <= kParallelSine * kParallelSine) return Clipped::kNone;
  const double da = Dot(a, planes[i].point), db = Dot(b, planes[j].point);
  const Vec3d start = (Cross(b, direction) * da + Cross(direction, a) * db) * (1 / square);
  const Vec3d along = direction * (1 / std::sqrt(square));
  double lo = -std::numeric_limits<double>::infinity(), hi = -lo;
  for (size_t k = 0; k < planes.size(); ++k) {
    if (k == i || k == j) continue;
    const double slope = Dot(along, planes[k].normal);
    const double distance = SignedDistance(planes[k], start);
    if (std::abs(slope) <= kParallelSine) {
      if (distance > tolerance) return Clipped::kNone;
    } else if (slope > 0) {
      hi = std::min(hi, -distance / slope);
    } else {
      lo = std::max(lo, -distance / slope);
    }
    if (hi - lo <= tolerance) return Clipped::kNone;
  }
  if (std::isinf(lo) || std::isinf(hi)) return Clipped::kUnbounded;
  edge = {start + along * lo, start + along * hi};
  return Clipped::kBounded;
}

void AddVertex(const Vec3d& v, double tolerance, std::vector<Vec3d>& vertices) {
  const auto near = [&](const Vec3d& u) { return Length(u - v) <= tolerance; };
  if (std::none_of(vertices.begin(), vertices.end(), near)) vertices.push_back(v);
}

absl::Status Unbounded() {
  return absl::InvalidArgumentError("half_spaces: expected a bounded set of points");
}

// The corners, or why there are none.
absl::StatusOr<std::vector<Vec3d>> Vertices(const std::vector<Plane>& planes) {
  double magnitude = 0;
  for (const Plane& plane : planes) magnitude = std::max(magnitude, Length(plane.point));
  const double tolerance = kMergeTolerance * magnitude;
  std::vector<Vec3d> vertices;
  for (size_t i = 0; i < planes.size(); ++i) {
    for (size_t j = i + 1; j < planes.size(); ++j) {
      Edge edge;
      switch (ClipLine(planes, i, j, tolerance, edge)) {
        case Clipped::kNone:
          break;
        case Clipped::kUnbounded:
          return Unbounded();
        case Clipped::kBounded:
          AddVertex(edge.from, tolerance, vertices);
          AddVertex(edge.to, tolerance, vertices);
      }
    }
  }
  Vec3d middle;
  for (const Vec3d& v : vertices)
    middle = middle + v * (1.0 / static_cast<double>(vertices.size()));
  for (const Plane& plane : planes) {
    if (vertices.size() >= 4 && SignedDistance(plane, middle) < -tolerance) continue;
    return absl::InvalidArgumentError(
        "half_spaces: expected a bounded set of points with an interior, got none");
  }
  return vertices;
}

absl::StatusOr<std::vector<Plane>> ToPlanes(const std::vector<HalfSpace>& half_spaces) {
  if (half_spaces.size() < 4) {
    return absl::InvalidArgumentError(
        absl::StrCat("half_spaces: expected at least 4, got ", half_spaces.size()));
  }
  std::vector<Plane> planes;
  planes.reserve(half_spaces.size());
  for (size_t i = 0; i < half_spaces.size(); ++i) {
    const std::string field = absl::StrCat("half_spaces[", i, "].");
    const auto& [normal, offset] = half_spaces[i];
    if (auto s = CheckDirection(field + "normal", normal); !s.ok()) return s;
    const Vec3d unit = Unit(normal);
    // |normal| may overflow where its largest component does not; then the quotient is 0.
    const double distance = offset / Dot(unit, normal);
    if (!(std::abs(distance) <= kMaxMagnitude)) {
      return absl::InvalidArgumentError(
          absl::StrCat(field, "offset: expected a finite number within ", kMaxMagnitude,
                       " times the normal's length, got ", offset));
    }
    planes.push_back({unit, unit * distance});
  }
  return planes;
}

}  // namespace

absl::StatusOr<Shape> MakePolyhedron(const std::vector<HalfSpace>& half_spaces,
                                     const AffineMap& map) {
  auto inverse = InverseLinear(map);
  if (!inverse.ok()) return inverse.status();
  auto planes = ToPlanes(half_spaces);
  if (!planes.ok()) return planes.status();
  auto vertices = Vertices(*planes);
  if (!vertices.ok()) return vertices.status();

  PolyhedronShape shape{*std::move(planes), *std::move(vertices)};
  Vec3d middle;
  for (Vec3d& v : shape.vertices) {
    if (auto s = CheckPoint("half_spaces", v); !s.ok()) return s;
    middle = middle + v * (1.0 / static_cast<double>(shape.vertices.size()));
    v = Apply(map, v);
    if (auto s = CheckPoint("transform", v); !s.ok()) return s;
  }
  for (Plane& plane : shape.faces) {
    // The reference point is moved next to the shape, where distances to it round least.
    plane.point = Apply(map, middle - plane.normal * SignedDistance(plane, middle));
    plane.normal = Unit(MultiplyTransposed(*inverse, plane.normal));
  }
  return shape;
}

}  // namespace linetree
