#include "core/io/tachyon_shape.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace linetree {
namespace {

// How far from round a map may be, relative: a few roundings of a transform.
constexpr double kRoundTolerance = 1e-9;
// How far from a face's plane its vertices may lie, relative to the polyhedron's size.
constexpr double kPlaneTolerance = 1e-9;

Vec3d Column(const Mat3& m, int i) { return {m.row[0][i], m.row[1][i], m.row[2][i]}; }
Vec3d ToWorld(const AffineFrame& frame, const Vec3d& p) {
  return frame.center + frame.world_from_object * p;
}

bool Perpendicular(const Vec3d& a, const Vec3d& b) {
  return std::abs(Dot(a, b)) <= kRoundTolerance * Length(a) * Length(b);
}
bool EquallyLong(const Vec3d& a, const Vec3d& b) {
  return std::abs(Length(a) - Length(b)) <= kRoundTolerance * Length(a);
}
// Whether object space's circles about the z axis are circles in the world.
bool HasRoundSection(const AffineFrame& frame) {
  const Vec3d x = Column(frame.world_from_object, 0), y = Column(frame.world_from_object, 1);
  return Perpendicular(x, y) && EquallyLong(x, y);
}
bool HasUprightAxis(const AffineFrame& frame) {
  const Vec3d axis = Column(frame.world_from_object, 2);
  return Perpendicular(Column(frame.world_from_object, 0), axis) &&
         Perpendicular(Column(frame.world_from_object, 1), axis);
}

class Writer {
 public:
  explicit Writer(const std::string& texture) : texture_(texture) {}

  TachyonShape Take() && { return std::move(shape_); }

  void Write(const SphereShape& s) {
    const Vec3d x = Column(s.frame.world_from_object, 0);
    if (HasRoundSection(s.frame) && HasUprightAxis(s.frame) &&
        EquallyLong(x, Column(s.frame.world_from_object, 2))) {
      Line(absl::StrCat("Sphere Center ", TachyonText(s.frame.center), " Rad ",
                        TachyonText(Length(x))));
      return;
    }
    shape_.is_approximate = true;
    constexpr int kRings = kTachyonSides / 2;
    // The sine of pi is not 0 in floating point: a pole has no radius.
    const auto rim = [](int ring) {
      const double angle = std::numbers::pi * ring / kRings;
      const double radius = ring == 0 || ring == kRings ? 0 : std::sin(angle);
      return Rim{-std::cos(angle), radius, -std::cos(angle), radius};
    };
    for (int ring = 0; ring < kRings; ++ring) Band(s.frame, rim(ring), rim(ring + 1));
  }

  void Write(const BoxShape& s) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const double side : {-1.0, 1.0}) {
        std::vector<Vec3d> corners;
        for (const auto& [u, v] : {std::pair(-1.0, -1.0), std::pair(1.0, -1.0), std::pair(1.0, 1.0),
                                   std::pair(-1.0, 1.0)}) {
          Vec3d p;
          p[axis] = side;
          p[(axis + 1) % 3] = u;
          p[(axis + 2) % 3] = v;
          corners.push_back(ToWorld(s.frame, p));
        }
        Fan(corners);
      }
    }
  }

  void Write(const FrustumShape& s) {
    const bool is_round = HasRoundSection(s.frame) && HasUprightAxis(s.frame);
    if (is_round && s.base_radius == s.top_radius) {
      Line(absl::StrCat("FCylinder Base ", TachyonText(s.frame.center), " Apex ",
                        TachyonText(ToWorld(s.frame, {0, 0, 1})), " Rad ",
                        TachyonText(Length(Column(s.frame.world_from_object, 0)))));
    } else {
      shape_.is_approximate = true;
      const double taper = s.top_radius - s.base_radius;
      Band(s.frame, {0, s.base_radius, -taper, 1}, {1, s.top_radius, -taper, 1});
    }
    if (s.open) return;
    if (s.base_radius > 0) Circle(s.frame, 0, s.base_radius);
    if (s.top_radius > 0) Circle(s.frame, 1, s.top_radius);
  }

  void Write(const DiscShape& s) { Circle(s.frame, 0, 1); }
  void Write(const PolygonShape& s) { Fan(s.vertices); }
  void Write(const TriangleShape& s) {
    SmoothTriangle({s.polygon.vertices[0], s.polygon.vertices[1], s.polygon.vertices[2]},
                   s.normals);
  }
  void Write(const PolyhedronShape& s) {
    const double size = Length(Bounds(Shape(s)).Extent());
    for (const Plane& face : s.faces) {
      std::vector<Vec3d> corners;
      for (const Vec3d& v : s.vertices) {
        if (std::abs(SignedDistance(face, v)) <= kPlaneTolerance * size) corners.push_back(v);
      }
      if (corners.size() < 3) continue;
      SortAround(face.normal, corners);
      Fan(corners);
    }
  }

 private:
  // A circle about the z axis in object space and the normal there: height, radius, and the
  // normal's parts along the axis and away from it.
  struct Rim {
    double z, radius, normal_z, normal_radius;
  };

  void Line(const std::string& what) { absl::StrAppend(&shape_.text, what, " ", texture_, "\n"); }

  void Fan(std::span<const Vec3d> corners) {
    for (size_t i = 1; i + 1 < corners.size(); ++i) {
      Line(absl::StrCat("TRI V0 ", TachyonText(corners[0]), " V1 ", TachyonText(corners[i]), " V2 ",
                        TachyonText(corners[i + 1])));
    }
  }

  // Tachyon turns smooth normals by the order of the vertices: it must agree with them.
  void SmoothTriangle(std::array<Vec3d, 3> v, std::array<Vec3d, 3> n) {
    const Vec3d plane = Cross(v[1] - v[0], v[2] - v[0]);
    if (!(LengthSquared(plane) > 0)) return;
    if (Dot(plane, n[0] + n[1] + n[2]) < 0) {
      std::swap(v[1], v[2]);
      std::swap(n[1], n[2]);
    }
    std::string text = "STRI";
    for (int i = 0; i < 3; ++i) {
      absl::StrAppend(&text, " V", i, " ", TachyonText(v[static_cast<size_t>(i)]));
    }
    for (int i = 0; i < 3; ++i) {
      absl::StrAppend(&text, " N", i, " ", TachyonText(n[static_cast<size_t>(i)]));
    }
    Line(text);
  }

  static Vec3d PointOn(const AffineFrame& frame, const Rim& rim, double angle) {
    return ToWorld(frame, {rim.radius * std::cos(angle), rim.radius * std::sin(angle), rim.z});
  }
  static Vec3d NormalOn(const AffineFrame& frame, const Rim& rim, double angle) {
    const Vec3d object{rim.normal_radius * std::cos(angle), rim.normal_radius * std::sin(angle),
                       rim.normal_z};
    return Normalized(MultiplyTransposed(frame.object_from_world, object));
  }

  void Band(const AffineFrame& frame, const Rim& low, const Rim& high) {
    for (int side = 0; side < kTachyonSides; ++side) {
      const double from = 2 * std::numbers::pi * side / kTachyonSides;
      const double to = 2 * std::numbers::pi * (side + 1) / kTachyonSides;
      // At a pole or apex all sides meet: there the side's middle normal stands for its own.
      const double middle = (from + to) / 2;
      const auto normal = [&](const Rim& rim, double angle) {
        return NormalOn(frame, rim, rim.radius > 0 ? angle : middle);
      };
      const Vec3d a = PointOn(frame, low, from), b = PointOn(frame, low, to);
      const Vec3d c = PointOn(frame, high, to), d = PointOn(frame, high, from);
      const Vec3d na = normal(low, from), nb = normal(low, to);
      const Vec3d nc = normal(high, to), nd = normal(high, from);
      if (low.radius > 0) SmoothTriangle({a, b, c}, {na, nb, nc});
      if (high.radius > 0) SmoothTriangle({a, c, d}, {na, nc, nd});
    }
  }

  void Circle(const AffineFrame& frame, double z, double radius) {
    const Vec3d x = Column(frame.world_from_object, 0), y = Column(frame.world_from_object, 1);
    if (HasRoundSection(frame)) {
      Line(absl::StrCat("Ring Center ", TachyonText(ToWorld(frame, {0, 0, z})), " Normal ",
                        TachyonText(Normalized(Cross(x, y))), " Inner 0 Outer ",
                        TachyonText(radius * Length(x))));
      return;
    }
    shape_.is_approximate = true;
    std::vector<Vec3d> corners;
    corners.reserve(kTachyonSides);
    for (int side = 0; side < kTachyonSides; ++side) {
      corners.push_back(
          PointOn(frame, {z, radius, 1, 0}, 2 * std::numbers::pi * side / kTachyonSides));
    }
    Fan(corners);
  }

  static void SortAround(const Vec3d& normal, std::vector<Vec3d>& corners) {
    Vec3d middle;
    for (const Vec3d& v : corners)
      middle = middle + v * (1.0 / static_cast<double>(corners.size()));
    const Vec3d x = corners[0] - middle;
    const Vec3d y = Cross(normal, x);
    const auto angle = [&](const Vec3d& v) {
      return std::atan2(Dot(v - middle, y), Dot(v - middle, x));
    };
    std::sort(corners.begin(), corners.end(),
              [&](const Vec3d& a, const Vec3d& b) { return angle(a) < angle(b); });
  }

  const std::string& texture_;
  TachyonShape shape_;
};

}  // namespace

// Nine significant digits carry a float exactly. The sum has no negative zeros.
std::string TachyonText(double value) { return absl::StrFormat("%.9g", value + 0.0); }
std::string TachyonText(const Vec3d& v) {
  return absl::StrCat(TachyonText(v.x), " ", TachyonText(v.y), " ", TachyonText(v.z));
}

TachyonShape ToTachyonShape(const Shape& shape, const std::string& texture) {
  Writer writer(texture);
  std::visit([&](const auto& s) { writer.Write(s); }, shape);
  return std::move(writer).Take();
}

}  // namespace linetree
