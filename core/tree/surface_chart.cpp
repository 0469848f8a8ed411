#include "core/tree/surface_chart.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/math/check.h"

namespace linetree {
namespace {

constexpr double kPi = std::numbers::pi;

// Unit normals of one plane, the chart's and the tracer's, that are computed from edges at an angle
// of 2^-20 at least differ by less.
constexpr double kNormalRounding = 0x1p-30;

// Relative to the reach, per unit of the frame's condition: 64 roundings, which is more than there
// are operations between a world point, its coordinates and a hull's corners, together with the
// tracer's own on the way to the hit.
constexpr double kChartRounding = 0x1p-46;

// A pad is made this much larger, relatively, so that the rounding of offsets that are computed
// from it does not count: they are sums of fewer than 2^10 roundings but for the difference in
// the tangent of a cell's half width, which at depth kMaxSurfaceDepth loses 21 of 52 bits.
constexpr double kPadMargin = 0x1p-10;

// Vertices of a polyhedron this close to a face's plane, relative to the reach, are taken as its
// own. Too many only make the rectangle larger.
constexpr double kOnFace = 0x1p-20;

// An interval of a cell in [0, 1].
struct Range {
  double low, high;
};
Range RangeOf(uint32_t index, int depth) {
  const double width = 1.0 / static_cast<double>(uint32_t{1} << depth);
  return {index * width, (index + 1) * width};
}

uint32_t IndexAt(double x, int depth) {
  const double last = std::ldexp(1.0, depth) - 1;
  return static_cast<uint32_t>(std::clamp(std::floor(std::ldexp(x, depth)), 0.0, last));
}

Vec3d Column(const Mat3& m, int i) { return {m.row[0][i], m.row[1][i], m.row[2][i]}; }

double FrobeniusNorm(const Mat3& m) {
  return std::sqrt(LengthSquared(m.row[0]) + LengthSquared(m.row[1]) + LengthSquared(m.row[2]));
}

// From [-half, half]; a cap of radius 0 has only its middle.
double ToUnit(double x, double half) {
  return half > 0 ? std::clamp((x / half + 1) / 2, 0.0, 1.0) : 0.5;
}

// Where the equi-angular map puts u on the face z = 1 of the cube.
double TanOf(double u) { return std::tan(kPi / 4 * (2 * u - 1)); }
double FromTan(double y, double x) {
  return std::clamp((std::atan2(y, x) / (kPi / 4) + 1) / 2, 0.0, 1.0);
}

Vec3d LongestEdge(const std::vector<Vec3d>& vertices) {
  Vec3d longest;
  for (size_t i = 0; i < vertices.size(); ++i) {
    const Vec3d edge = vertices[(i + 1) % vertices.size()] - vertices[i];
    if (LengthSquared(edge) > LengthSquared(longest)) longest = edge;
  }
  return longest;
}

}  // namespace

SurfaceCell CellAt(const SurfacePoint& point, int depth) {
  LT_CHECK(depth >= 0 && depth <= kMaxSurfaceDepth);
  return {static_cast<uint8_t>(depth), IndexAt(point.u, depth), IndexAt(point.v, depth)};
}

struct SurfaceChart::Builder {
  SurfaceChart& chart;

  void operator()(const SphereShape& s) const { chart.SetFrame(Curved::kSphere, s.frame); }
  void operator()(const FrustumShape& s) const {
    chart.SetFrame(Curved::kLateral, s.frame);
    chart.base_radius_ = s.base_radius;
    chart.taper_ = s.top_radius - s.base_radius;
    if (s.open) return;
    const Mat3& m = s.frame.world_from_object;
    const Vec3d x = Column(m, 0), y = Column(m, 1), top = s.frame.center + Column(m, 2);
    chart.planes_.push_back(MakeSide(top, s.frame.center, x, y, s.base_radius));
    chart.planes_.push_back(MakeSide(s.frame.center, top, x, y, s.top_radius));
  }
  void operator()(const BoxShape& s) const {
    for (int face = 0; face < 6; ++face) {
      const int k = face / 2;
      const auto column = [&](int i) { return Column(s.frame.world_from_object, i % 3); };
      const Vec3d center = s.frame.center + column(k) * (face % 2 == 0 ? -1.0 : 1.0);
      chart.planes_.push_back(MakeSide(s.frame.center, center, column(k + 1), column(k + 2), 1));
    }
  }
  void operator()(const DiscShape& s) const {
    const Mat3& m = s.frame.world_from_object;
    chart.planes_.push_back(MakePlane(s.frame.center, Column(m, 0), Column(m, 1), 1));
  }
  void operator()(const PolygonShape& s) const {
    chart.planes_.push_back(MakeRectangle(s.plane, LongestEdge(s.vertices), s.vertices,
                                          kRectangleMargin * chart.reach_));
  }
  void operator()(const TriangleShape& s) const { (*this)(s.polygon); }
  void operator()(const PolyhedronShape& s) const {
    for (const Plane& face : s.faces) {
      std::vector<Vec3d> own;
      std::copy_if(s.vertices.begin(), s.vertices.end(), std::back_inserter(own),
                   [&](const Vec3d& v) {
                     return std::abs(SignedDistance(face, v)) <= kOnFace * chart.reach_;
                   });
      // A face that no vertex is near is not part of the surface.
      if (own.size() < 3) own = s.vertices;
      chart.planes_.push_back(
          MakeRectangle(face, LongestEdge(own), own, kRectangleMargin * chart.reach_));
    }
  }
};

SurfaceChart::SurfaceChart(const Object& object)
    : is_thin_(IsPlanar(object.shape)),
      reach_(Length(object.bounds.Extent()) + Length(object.bounds.Center())),
      slack_(kSurfaceSlack * reach_),
      pad_(slack_) {
  std::visit(Builder{*this}, object.shape);
  for (PlanePatch& plane : planes_) plane.pad = PadOf(plane);
}

void SurfaceChart::SetFrame(Curved curved, const AffineFrame& frame) {
  curved_ = curved;
  curved_patches_ = curved == Curved::kSphere ? 6 : 4;
  frame_ = frame;
  // A rounding of the world point is seen through the thinnest axis of the object and brought back
  // through the longest: a point off the surface of a flat ellipsoid is far from the surface point
  // with the same direction.
  const double condition =
      FrobeniusNorm(frame.object_from_world) * FrobeniusNorm(frame.world_from_object);
  pad_ = slack_ * (1 + kPadMargin) + kChartRounding * condition * reach_;
  max_stretch_ = FrobeniusNorm(frame.world_from_object);
}

SurfaceChart::PlanePatch SurfaceChart::MakePlane(const Vec3d& center, const Vec3d& ex,
                                                 const Vec3d& ey, double half) {
  PlanePatch plane{center, ex, ey, {}, {}, {}, half, half, 0};
  // Lengths are taken out first: their products could leave the range of double.
  const double lx = Length(ex), ly = Length(ey);
  const Vec3d ux = ex * (1 / lx), uy = ey * (1 / ly);
  plane.normal = Normalized(Cross(ux, uy));
  const Vec3d x = Cross(uy, plane.normal), y = Cross(plane.normal, ux);
  plane.gx = x * (1 / (Dot(x, ux) * lx));
  plane.gy = y * (1 / (Dot(y, uy) * ly));
  return plane;
}

SurfaceChart::PlanePatch SurfaceChart::MakeSide(const Vec3d& inside, const Vec3d& center,
                                                const Vec3d& ex, const Vec3d& ey, double half) {
  PlanePatch side = MakePlane(center, ex, ey, half);
  if (Dot(inside - center, side.normal) > 0) side.normal = -side.normal;
  return side;
}

SurfaceChart::PlanePatch SurfaceChart::MakeRectangle(const Plane& plane, const Vec3d& along,
                                                     const std::vector<Vec3d>& vertices,
                                                     double margin) {
  const Vec3d& n = plane.normal;
  const Vec3d ex = Normalized(along - n * Dot(along, n)), ey = Cross(n, ex);
  Vec3d low, high;  // relative to the plane's point
  low = high = {Dot(vertices[0] - plane.point, ex), Dot(vertices[0] - plane.point, ey), 0};
  for (const Vec3d& v : vertices) {
    const Vec3d p{Dot(v - plane.point, ex), Dot(v - plane.point, ey), 0};
    for (int i = 0; i < 2; ++i) {
      low[i] = std::min(low[i], p[i]);
      high[i] = std::max(high[i], p[i]);
    }
  }
  const Vec3d middle = (low + high) * 0.5;
  PlanePatch patch = MakePlane(plane.point + ex * middle.x + ey * middle.y, ex, ey, 1);
  patch.hx = (high.x - low.x) / 2 + margin;
  patch.hy = (high.y - low.y) / 2 + margin;
  return patch;
}

SurfacePoint SurfaceChart::Locate(int face, const Vec3d& point) const {
  if (curved_ == Curved::kSphere) return LocateOnSphere(point);
  if (curved_ == Curved::kLateral && face == 0) return LocateOnLateral(point);
  const int index = curved_ == Curved::kLateral ? face - 1 : face;
  const PlanePatch& plane = planes_.at(static_cast<size_t>(index));
  const Vec3d d = point - plane.center;
  return {curved_patches_ + index, ToUnit(Dot(d, plane.gx), plane.hx),
          ToUnit(Dot(d, plane.gy), plane.hy)};
}

// The nearest surface point with the same coordinates lies along the radius of a sphere, across the
// axis of a frustum, along a plane's normal.
bool SurfaceChart::IsOn(int face, const Vec3d& point) const {
  const double tolerance = slack_ / 2;
  if (curved_ == Curved::kNone || (curved_ == Curved::kLateral && face > 0)) {
    const int index = curved_ == Curved::kLateral ? face - 1 : face;
    const PlanePatch& plane = planes_.at(static_cast<size_t>(index));
    const Vec3d d = point - plane.center;
    return std::abs(Dot(d, plane.normal)) <= tolerance && std::abs(Dot(d, plane.gx)) <= plane.hx &&
           std::abs(Dot(d, plane.gy)) <= plane.hy;
  }
  const Vec3d p = frame_.object_from_world * (point - frame_.center);
  if (curved_ == Curved::kSphere) return std::abs(Length(p) - 1) * max_stretch_ <= tolerance;
  const double radius = base_radius_ + taper_ * p.z;
  return p.z >= 0 && p.z <= 1 &&
         std::abs(std::hypot(p.x, p.y) - radius) * max_stretch_ <= tolerance;
}

SurfacePoint SurfaceChart::LocateOnSphere(const Vec3d& point) const {
  const Vec3d p = frame_.object_from_world * (point - frame_.center);
  int k = 0;
  if (std::abs(p.y) > std::abs(p[k])) k = 1;
  if (std::abs(p.z) > std::abs(p[k])) k = 2;
  const double along = std::abs(p[k]);
  return {2 * k + (p[k] < 0 ? 1 : 0), FromTan(p[(k + 1) % 3], along),
          FromTan(p[(k + 2) % 3], along)};
}

SurfacePoint SurfaceChart::LocateOnLateral(const Vec3d& point) const {
  const Vec3d p = frame_.object_from_world * (point - frame_.center);
  const double angle = std::atan2(p.y, p.x);
  const double quarters = (angle < 0 ? angle + 2 * kPi : angle) / (kPi / 2);
  const int patch = std::min(static_cast<int>(quarters), 3);
  return {patch, std::clamp(quarters - patch, 0.0, 1.0), std::clamp(p.z, 0.0, 1.0)};
}

PatchHull SurfaceChart::HullOf(int patch, const SurfaceCell& cell) const {
  LT_CHECK(patch >= 0 && patch < patches() && cell.depth <= kMaxSurfaceDepth);
  if (patch >= curved_patches_) {
    return PlaneHull(planes_[static_cast<size_t>(patch - curved_patches_)], cell);
  }
  return curved_ == Curved::kSphere ? SphereHull(patch, cell) : LateralHull(patch, cell);
}

Vec3d SurfaceChart::ToWorld(const Vec3d& p) const {
  return frame_.center + frame_.world_from_object * p;
}

// A world displacement d is M d in object space, M = object_from_world; n.(M d) = (M^T n).d.
double SurfaceChart::Shift(const Vec3d& normal) const {
  return pad_ * Length(MultiplyTransposed(frame_.object_from_world, normal));
}

std::optional<SurfaceChart::PlanarCell> SurfaceChart::PlanarCellOf(int patch,
                                                                   const SurfaceCell& cell) const {
  if (patch < curved_patches_) return std::nullopt;
  const PlanePatch& plane = planes_.at(static_cast<size_t>(patch - curved_patches_));
  const Range u = RangeOf(cell.i, cell.depth), v = RangeOf(cell.j, cell.depth);
  const Vec3d ex = plane.ex * plane.hx, ey = plane.ey * plane.hy;
  return PlanarCell{plane.center + ex * (2 * u.low - 1) + ey * (2 * v.low - 1),
                    ex * (2 * (u.high - u.low)), ey * (2 * (v.high - v.low)), plane.normal,
                    plane.pad};
}

// On a curved patch a point p of the surface sees L in front of its tangent plane when the
// quadric's polar form B(p, L) > 0, where B(p, p) is what vanishes on the surface. It is linear in
// p, so the corners of the hull bound it.
bool SurfaceChart::FacesAway(int patch, const PatchHull& hull, const Light& light) const {
  if (is_thin_) return false;
  const bool is_point = light.kind == LightKind::kPoint;
  if (patch >= curved_patches_) {
    const PlanePatch& plane = planes_.at(static_cast<size_t>(patch - curved_patches_));
    // Hits lie off the plane, and normals turn, by rounding.
    if (!is_point) return Dot(light.to_light, plane.normal) < -kNormalRounding;
    return Dot(light.position - plane.center, plane.normal) < -2 * plane.pad;
  }
  const double weight = is_point ? 1 : 0;
  const Vec3d l =
      frame_.object_from_world * (is_point ? light.position - frame_.center : light.to_light);
  return std::all_of(hull.points.begin(), hull.points.end(), [&](const Vec3d& x) {
    const Vec3d p = frame_.object_from_world * (x - frame_.center);
    if (curved_ == Curved::kSphere) return Dot(p, l) - weight < 0;
    const double w = base_radius_ + taper_ * p.z;
    return p.x * l.x + p.y * l.y - w * (weight * base_radius_ + taper_ * l.z) < 0;
  });
}

double SurfaceChart::PadOf(const PlanePatch& plane) const {
  const double condition =
      Length(plane.gx) * Length(plane.ex) + Length(plane.gy) * Length(plane.ey);
  return slack_ * (1 + kPadMargin) + kChartRounding * condition * reach_;
}

// The cell's parallelogram with a ball of radius `pad` added: a displacement d of at most pad is
// X ex + Y ey + h normal with X = gx.d, |X| <= pad |gx|, Y likewise, and |h| <= pad. So the prism
// over the parallelogram with sides longer by that much contains the sum.
PatchHull SurfaceChart::PlaneHull(const PlanePatch& plane, const SurfaceCell& cell) const {
  const double pad = plane.pad;
  const Range u = RangeOf(cell.i, cell.depth), v = RangeOf(cell.j, cell.depth);
  const double px = pad * Length(plane.gx), py = pad * Length(plane.gy);
  const double x[2] = {(2 * u.low - 1) * plane.hx - px, (2 * u.high - 1) * plane.hx + px};
  const double y[2] = {(2 * v.low - 1) * plane.hy - py, (2 * v.high - 1) * plane.hy + py};
  PatchHull hull;
  for (size_t i = 0; i < 8; ++i) {
    hull.points[i] = plane.center + plane.ex * x[i & 1] + plane.ey * y[i >> 1 & 1] +
                     plane.normal * (i >> 2 & 1 ? pad : -pad);
  }
  return hull;
}

// In object space. The cell is the part of the unit sphere in the cone K over four corners with
// unit directions y_i. With a unit vector c such that all c.y_i > 0, and lo the least of them, a
// point y = sum l_i y_i, l_i >= 0, of the cell has 1 = |y| <= sum l_i, so that
//   lo <= lo sum l_i <= sum l_i y_i.c = y.c <= 1:
// the cell lies in K between the planes y.c = lo and y.c = 1, the hull of eight points.
//
// Adding a ball: the planes move outwards by Shift(c). A side of K with inward unit normal n must
// move by Shift(n); the cone K - g c, its apex moved back by g, has moved all its sides by g c.n,
// so g = max Shift(n) / c.n does. With c + e_i = y_i / (y_i.c), the corner rays of K - g c are
// -g c + (h + g)(c + e_i), which at y.c = h is h c + (h + g) e_i.
PatchHull SurfaceChart::SphereHull(int patch, const SurfaceCell& cell) const {
  const int k = patch / 2, a = (k + 1) % 3, b = (k + 2) % 3;
  const Range u = RangeOf(cell.i, cell.depth), v = RangeOf(cell.j, cell.depth);
  const double s[2] = {TanOf(u.low), TanOf(u.high)}, t[2] = {TanOf(v.low), TanOf(v.high)};
  const auto vector = [&](double along_a, double along_b, double along_k) {
    Vec3d x;
    x[a] = along_a;
    x[b] = along_b;
    x[k] = patch % 2 == 0 ? along_k : -along_k;
    return x;
  };
  std::array<Vec3d, 4> y;
  Vec3d c;
  for (size_t i = 0; i < 4; ++i) {
    y[i] = Normalized(vector(s[i & 1], t[i >> 1], 1));
    c = c + y[i];
  }
  c = Normalized(c);

  double lo = 1, g = 0;
  for (const Vec3d& corner : y) lo = std::min(lo, Dot(corner, c));
  // The side s = s0 is the plane through the origin with normal (1, 0, -s0).
  for (const double sign : {1.0, -1.0}) {
    const size_t end = sign > 0 ? 0 : 1;
    for (const Vec3d& n : {vector(sign, 0, -sign * s[end]), vector(0, sign, -sign * t[end])}) {
      g = std::max(g, Shift(n) / Dot(c, n));
    }
  }
  const double h[2] = {lo - Shift(c), 1 + Shift(c)};
  PatchHull hull;
  for (size_t i = 0; i < 8; ++i) {
    const Vec3d e = y[i & 3] * (1 / Dot(y[i & 3], c)) - c;
    hull.points[i] = ToWorld(c * h[i >> 2] + e * (h[i >> 2] + g));
  }
  return hull;
}

// In object space. At height z the cell is the arc of radius w(z) within the angle alpha of the
// direction d of its middle. In coordinates r along d and t across, the arc lies between its chord
// r = w cos(alpha) and the tangent r = w, and within |t| <= r tan(alpha). All three are linear in
// z, so the cell lies in the intersection of six half-spaces.
//
// Adding a ball moves each of them by its Shift. What is left at height z is a trapezoid
//   r0(z) <= r <= r1(z), |t| <= (r sin(alpha) + q) / cos(alpha), q = the larger shift of the sides,
// with r0, r1 linear in z: it lies in the hull of the trapezoids at the two end planes. Where the
// sides cross before r0 (near an apex) the corners there are put at t = 0, which is larger than
// what is left and convex in z: the hull stays outside.
PatchHull SurfaceChart::LateralHull(int patch, const SurfaceCell& cell) const {
  const Range u = RangeOf(cell.i, cell.depth), v = RangeOf(cell.j, cell.depth);
  const double middle = (patch + (u.low + u.high) / 2) * (kPi / 2);
  const double alpha = (u.high - u.low) / 2 * (kPi / 2);
  const double sine = std::sin(alpha), cosine = std::cos(alpha);
  const Vec3d d{std::cos(middle), std::sin(middle), 0}, across{-d.y, d.x, 0};
  const double q = std::max(Shift(across * cosine - d * sine), Shift(across * cosine + d * sine));
  const Vec3d axis{0, 0, 1};
  const double inner = Shift(d - axis * (taper_ * cosine)), outer = Shift(d - axis * taper_);
  const double z[2] = {v.low - Shift(axis), v.high + Shift(axis)};
  PatchHull hull;
  for (size_t i = 0; i < 8; ++i) {
    const double height = z[i >> 2];
    const double w = base_radius_ + taper_ * height;
    const double r = i & 1 ? w + outer : w * cosine - inner;
    const double t = std::max(0.0, (r * sine + q) / cosine);
    hull.points[i] = ToWorld(d * r + across * (i >> 1 & 1 ? t : -t) + axis * height);
  }
  return hull;
}

}  // namespace linetree
