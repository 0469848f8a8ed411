#include "core/tree/ray_space.h"

#include <algorithm>
#include <cmath>

#include "core/math/check.h"

namespace linetree {
namespace {

// A box thinner than a quarter of its longest side gets thicker planes' distance: two planes that
// nearly coincide would spend all subdivision on directions.
constexpr double kMinThickness = 0.25;

// Coordinates may leave [0, 1] by rounding and by a planar object's inset; they are clamped. Beyond
// this the line misses.
constexpr double kCoordSlack = 0x1p-32;

using Axes = std::array<Vec3d, 3>;

Vec3d AnyPerpendicular(const Vec3d& n) {
  const Vec3d a{std::abs(n.x), std::abs(n.y), std::abs(n.z)};
  const Vec3d t = a.x <= a.y && a.x <= a.z ? Vec3d{1, 0, 0}
                  : a.y <= a.z             ? Vec3d{0, 1, 0}
                                           : Vec3d{0, 0, 1};
  return Normalized(Cross(n, t));
}

Axes AxesFromNormal(const Vec3d& normal, const Vec3d& first) {
  const Vec3d e0 = Normalized(first - normal * Dot(first, normal));
  return {e0, Cross(normal, e0), normal};
}

// Gram-Schmidt on the columns of world_from_object: z first, because it is a frustum's axis.
Axes AxesFromFrame(const AffineFrame& frame) {
  const auto column = [&](int i) {
    const auto& r = frame.world_from_object.row;
    return Vec3d{r[0][i], r[1][i], r[2][i]};
  };
  const Vec3d e2 = Normalized(column(2));
  const Vec3d x = column(0) - e2 * Dot(column(0), e2);
  // A sheared column may end up almost parallel to the axis; any perpendicular serves as well.
  const Vec3d e0 = Length(x) > 1e-6 * Length(column(0)) ? Normalized(x) : AnyPerpendicular(e2);
  return {e0, Cross(e2, e0), e2};
}

constexpr Axes kWorldAxes = {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};

struct Extent {
  Vec3d min{Box3::kInf, Box3::kInf, Box3::kInf};
  Vec3d max{-Box3::kInf, -Box3::kInf, -Box3::kInf};
};

void Widen(Extent& extent, const Axes& e, const Vec3d& p, double radius_along[3]) {
  for (int i = 0; i < 3; ++i) {
    const double y = Dot(p, e[static_cast<size_t>(i)]);
    extent.min[i] = std::min(extent.min[i], y - radius_along[i]);
    extent.max[i] = std::max(extent.max[i], y + radius_along[i]);
  }
}

// The ellipsoid or disc-like set center + world_from_object * {|p_axes| <= 1}: its half width along
// e.
double HalfWidth(const Mat3& world_from_object, const Vec3d& e, bool use_x, bool use_y,
                 bool use_z) {
  const Vec3d g = MultiplyTransposed(world_from_object, e);
  return std::sqrt((use_x ? g.x * g.x : 0) + (use_y ? g.y * g.y : 0) + (use_z ? g.z * g.z : 0));
}

struct ExtentOf {
  const Axes& e;
  Vec3d
      origin;  // extents are relative to it, which keeps them accurate far from the world's origin

  Extent Points(const std::vector<Vec3d>& points) const {
    Extent extent;
    double none[3] = {0, 0, 0};
    for (const Vec3d& p : points) Widen(extent, e, p - origin, none);
    return extent;
  }
  Extent operator()(const SphereShape& s) const {
    Extent extent;
    double r[3];
    for (size_t i = 0; i < 3; ++i)
      r[i] = HalfWidth(s.frame.world_from_object, e[i], true, true, true);
    Widen(extent, e, s.frame.center - origin, r);
    return extent;
  }
  Extent operator()(const BoxShape& s) const {
    Extent extent;
    double r[3];
    for (size_t i = 0; i < 3; ++i) {
      const Vec3d g = MultiplyTransposed(s.frame.world_from_object, e[i]);
      r[i] = std::abs(g.x) + std::abs(g.y) + std::abs(g.z);
    }
    Widen(extent, e, s.frame.center - origin, r);
    return extent;
  }
  Extent operator()(const FrustumShape& s) const {
    Extent extent;
    for (int end = 0; end < 2; ++end) {
      const double radius = end == 0 ? s.base_radius : s.top_radius;
      double r[3];
      for (size_t i = 0; i < 3; ++i) {
        r[i] = radius * HalfWidth(s.frame.world_from_object, e[i], true, true, false);
      }
      const Vec3d axis = s.frame.world_from_object * Vec3d{0, 0, static_cast<double>(end)};
      Widen(extent, e, s.frame.center - origin + axis, r);
    }
    return extent;
  }
  Extent operator()(const DiscShape& s) const {
    Extent extent;
    double r[3];
    for (size_t i = 0; i < 3; ++i)
      r[i] = HalfWidth(s.frame.world_from_object, e[i], true, true, false);
    Widen(extent, e, s.frame.center - origin, r);
    return extent;
  }
  Extent operator()(const PolygonShape& s) const { return Points(s.vertices); }
  Extent operator()(const TriangleShape& s) const { return Points(s.polygon.vertices); }
  Extent operator()(const PolyhedronShape& s) const { return Points(s.vertices); }
};

struct AxesOf {
  Axes operator()(const SphereShape&) const { return kWorldAxes; }
  Axes operator()(const BoxShape& s) const { return AxesFromFrame(s.frame); }
  Axes operator()(const FrustumShape& s) const { return AxesFromFrame(s.frame); }
  Axes operator()(const DiscShape& s) const {
    return AxesFromNormal(s.plane.normal, AnyPerpendicular(s.plane.normal));
  }
  Axes operator()(const PolygonShape& s) const {
    return AxesFromNormal(s.plane.normal, s.vertices[1] - s.vertices[0]);
  }
  Axes operator()(const TriangleShape& s) const { return (*this)(s.polygon); }
  Axes operator()(const PolyhedronShape&) const { return kWorldAxes; }
};

double Clamped(double x) { return std::clamp(x, 0.0, 1.0); }

bool InUnit(double x) { return x >= -kCoordSlack && x <= 1 + kCoordSlack; }

}  // namespace

ObjectChart::ObjectChart(const Object& object)
    : e_(std::visit(AxesOf{}, object.shape)), planar_(IsPlanar(object.shape)) {
  const Vec3d origin = object.bounds.Center();
  const Extent extent = std::visit(ExtentOf{e_, origin}, object.shape);
  center_ = origin + ToWorld((extent.min + extent.max) * 0.5);
  half_ = (extent.max - extent.min) * 0.5;
  const double longest = std::max({half_.x, half_.y, half_.z});
  for (int i = 0; i < 3; ++i) {
    if (planar_) {
      half_[i] -= kRimInset * longest;
    } else {
      half_[i] = std::max(half_[i] + Length(origin) * kBoundsPad, kMinThickness * longest);
    }
  }
}

int ObjectChart::PairOf(const Vec3d& direction) const {
  const Vec3d d = ToChart(direction);
  int k = 0;
  if (std::abs(d.y) > std::abs(d[k])) k = 1;
  if (std::abs(d.z) > std::abs(d[k])) k = 2;
  return 2 * k + (d[k] < 0 ? 1 : 0);
}

std::optional<RayCoords> ObjectChart::CoordsOf(int pair, const Vec3d& origin,
                                               const Vec3d& direction) const {
  const Vec3d o = ToChart(origin - center_);
  const Vec3d d = ToChart(direction);
  const int k = pair / 2, i = (k + 1) % 3, j = (k + 2) % 3;
  RayCoords x;
  if (planar_) {
    if (d.z == 0) return std::nullopt;
    const double t = -o.z / d.z;
    const double size = std::abs(d[k]);
    x = {((o.x + t * d.x) / half_.x + 1) / 2, ((o.y + t * d.y) / half_.y + 1) / 2,
         (d[i] / size + 1) / 2, (d[j] / size + 1) / 2};
  } else {
    const double entry = pair % 2 == 0 ? -half_[k] : half_[k];
    const double t0 = (entry - o[k]) / d[k];
    const double t1 = (-entry - o[k]) / d[k];
    const double hi = half_[i] + 2 * half_[k], hj = half_[j] + 2 * half_[k];
    x = {((o[i] + t0 * d[i]) / hi + 1) / 2, ((o[j] + t0 * d[j]) / hj + 1) / 2,
         ((o[i] + t1 * d[i]) / hi + 1) / 2, ((o[j] + t1 * d[j]) / hj + 1) / 2};
  }
  for (double& v : x) {
    if (!InUnit(v)) return std::nullopt;  // also NaN
    v = Clamped(v);
  }
  return x;
}

Ray ObjectChart::LineOf(int pair, const RayCoords& coords) const {
  const int k = pair / 2, i = (k + 1) % 3, j = (k + 2) % 3;
  const double sign = pair % 2 == 0 ? 1 : -1;
  Vec3d from, direction;
  if (planar_) {
    from = {(2 * coords[0] - 1) * half_.x, (2 * coords[1] - 1) * half_.y, 0};
    direction[k] = sign;
    direction[i] = 2 * coords[2] - 1;
    direction[j] = 2 * coords[3] - 1;
  } else {
    const double hi = half_[i] + 2 * half_[k], hj = half_[j] + 2 * half_[k];
    from[k] = -sign * half_[k];
    from[i] = (2 * coords[0] - 1) * hi;
    from[j] = (2 * coords[1] - 1) * hj;
    direction[k] = 2 * sign * half_[k];
    direction[i] = 2 * (coords[2] - coords[0]) * hi;
    direction[j] = 2 * (coords[3] - coords[1]) * hj;
  }
  return {center_ + ToWorld(from), Normalized(ToWorld(direction))};
}

LineForm ObjectChart::FormOf(int pair) const {
  const int k = pair / 2, i = (k + 1) % 3, j = (k + 2) % 3;
  const double sign = pair % 2 == 0 ? 1 : -1;
  LineForm form;
  form.between_planes = !planar_;
  Vec3d from, direction;
  if (planar_) {
    from = {-half_.x, -half_.y, 0};
    form.origin_by[0] = e_[0] * (2 * half_.x);
    form.origin_by[1] = e_[1] * (2 * half_.y);
    direction[k] = sign;
    direction[i] = -1;
    direction[j] = -1;
    form.direction_by[2] = e_[static_cast<size_t>(i)] * 2.0;
    form.direction_by[3] = e_[static_cast<size_t>(j)] * 2.0;
  } else {
    const double hi = half_[i] + 2 * half_[k], hj = half_[j] + 2 * half_[k];
    from[k] = -sign * half_[k];
    from[i] = -hi;
    from[j] = -hj;
    direction[k] = 2 * sign * half_[k];
    form.along_axis = 2 * half_[k];
    const Vec3d along_i = e_[static_cast<size_t>(i)] * (2 * hi);
    const Vec3d along_j = e_[static_cast<size_t>(j)] * (2 * hj);
    form.origin_by = {along_i, along_j, Vec3d{}, Vec3d{}};
    form.direction_by = {-along_i, -along_j, along_i, along_j};
  }
  form.origin = center_ + ToWorld(from);
  form.direction = ToWorld(direction);
  return form;
}

}  // namespace linetree
