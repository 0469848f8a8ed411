#include "core/scene/planar_loop.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "core/math/box3.h"
#include "core/scene/make_shape.h"

namespace linetree {
namespace {

double Extent(const std::vector<Vec3d>& vertices) {
  Box3 box;
  for (const Vec3d& v : vertices) box.Add(v);
  return Length(box.Extent());
}

double Magnitude(const std::vector<Vec3d>& vertices) {
  double magnitude = 0;
  for (const Vec3d& v : vertices) {
    magnitude = std::max({magnitude, std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  }
  return magnitude;
}

// Distance of b from the line through a and c, or from a when they coincide.
double DistanceFromLine(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d line = c - a;
  const double length = Length(line);
  return length > 0 ? Length(Cross(b - a, line)) / length : Length(b - a);
}

// Whether b adds nothing to the loop between a and c: it repeats a neighbour, lies between them, or
// is the tip of a spike without area.
bool IsIdle(const Vec3d& a, const Vec3d& b, const Vec3d& c, double tolerance) {
  return Length(b - a) <= tolerance || Length(c - a) <= tolerance ||
         DistanceFromLine(a, b, c) <= tolerance;
}

std::vector<Vec3d> WithoutIdle(std::vector<Vec3d> loop, double tolerance) {
  // Dropping a vertex can make its neighbours idle: look again at them.
  size_t unchanged = 0;
  size_t i = 0;
  while (loop.size() >= 3 && unchanged < loop.size()) {
    const size_t n = loop.size();
    i %= n;
    if (IsIdle(loop[(i + n - 1) % n], loop[i], loop[(i + 1) % n], tolerance)) {
      loop.erase(loop.begin() + static_cast<std::ptrdiff_t>(i));
      i += loop.size() - 1;
      unchanged = 0;
    } else {
      ++i;
      ++unchanged;
    }
  }
  return loop;
}

// All turns to the left, and one full turn in sum.
bool IsConvex(const std::vector<Vec3d>& loop, const Vec3d& normal) {
  double turned = 0;
  const size_t n = loop.size();
  for (size_t i = 0; i < n; ++i) {
    const Vec3d before = loop[(i + 1) % n] - loop[i];
    const Vec3d after = loop[(i + 2) % n] - loop[(i + 1) % n];
    const double sine = Dot(Cross(before, after), normal);
    if (!(sine > 0)) return false;
    turned += std::atan2(sine, Dot(before, after));
  }
  // A star turns by at least two full turns.
  return turned < 3 * std::numbers::pi;
}

absl::Status Degenerate() {
  return absl::InvalidArgumentError(
      "vertices: expected a polygon with an area, got one whose vertices lie on a line");
}

absl::Status CheckVertices(const std::vector<Vec3d>& vertices) {
  if (vertices.size() < 3) {
    return absl::InvalidArgumentError(
        absl::StrCat("vertices: expected at least 3, got ", vertices.size()));
  }
  for (size_t i = 0; i < vertices.size(); ++i) {
    if (auto s = CheckPoint(absl::StrCat("vertices[", i, "]"), vertices[i]); !s.ok()) return s;
  }
  return absl::OkStatus();
}

}  // namespace

Vec3d AreaVector(const std::vector<Vec3d>& vertices) {
  Vec3d sum;
  for (size_t i = 1; i + 1 < vertices.size(); ++i) {
    sum = sum + Cross(vertices[i] - vertices[0], vertices[i + 1] - vertices[0]);
  }
  return sum;
}

double LoopTolerance(const std::vector<Vec3d>& vertices) {
  return std::max(kLoopTolerance * Extent(vertices), kMagnitudeTolerance * Magnitude(vertices));
}

absl::StatusOr<PlanarLoop> MakePlanarLoop(const std::vector<Vec3d>& vertices) {
  if (auto s = CheckVertices(vertices); !s.ok()) return s;
  const double magnitude = Magnitude(vertices);
  const double extent = Extent(vertices);
  const double tolerance = LoopTolerance(vertices);
  if (!(extent >= 1 / kMaxMagnitude)) return Degenerate();

  const Vec3d area = AreaVector(vertices);
  if (!(Length(area) > tolerance * extent)) return Degenerate();
  PlanarLoop loop;
  loop.normal = Unit(area);
  loop.vertices = vertices;
  for (size_t i = 0; i < vertices.size(); ++i) {
    const double off = Dot(vertices[i] - vertices[0], loop.normal);
    if (std::abs(off) > kPlanarityTolerance * magnitude) {
      return absl::InvalidArgumentError(
          absl::StrCat("vertices[", i, "]: expected a point in the polygon's plane, got one at ",
                       std::abs(off), " from it"));
    }
    loop.vertices[i] = vertices[i] - loop.normal * off;
  }
  loop.vertices = WithoutIdle(std::move(loop.vertices), tolerance);
  if (loop.vertices.size() < 3) return Degenerate();
  loop.convex = IsConvex(loop.vertices, loop.normal);
  return loop;
}

}  // namespace linetree
