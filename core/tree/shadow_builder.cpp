#include "core/tree/shadow_builder.h"

#include <algorithm>
#include <cmath>

#include "core/tree/shadow_forms.h"

namespace linetree {
namespace {

// A light that is this near to a frustum's lateral cone, relative to the squares that are
// subtracted, touches it along one line: where is for rounding to say.
constexpr double kTangent = 0x1p-10;

// A function that is linear in space: over the cell and at the light (towards it, for a directional
// light), with bounds on their errors.
struct Height {
  Affine at;
  double light;
  double error;
  double light_error;

  bool FacesLight() const { return light > light_error; }
};
Height operator*(const Height& h, double k) {
  return {h.at * k, h.light * k, h.error * std::abs(k), h.light_error * std::abs(k)};
}

// G = g e - d g'.
struct Pencil {
  Affine at;
  double margin;
};
Pencil PencilOf(const Height& g, const Height& d) {
  return {g.at * d.light - d.at * g.light,
          g.error * std::abs(d.light) + (g.at.Bound() + g.error) * d.light_error +
              d.error * std::abs(g.light) + (d.at.Bound() + d.error) * g.light_error};
}

class Builder {
 public:
  Builder(const SurfaceChart::PlanarCell& cell, const Light& light, const FacePlanes& planes,
          double clearance, std::vector<float>& coefficients)
      : cell_(cell),
        planes_(planes),
        is_point_(light.kind == LightKind::kPoint),
        light_(is_point_ ? light.position : light.to_light),
        weight_(is_point_ ? 1 : 0),
        clearance_(clearance),
        forms_(coefficients) {}

  Shadowing Finish(ShadowFunction& function) { return forms_.Finish(function); }

  // All return false where there is no function.
  bool operator()(const BoxShape& /*s*/) { return AddPolyhedron(); }
  bool operator()(const PolyhedronShape& /*s*/) { return AddPolyhedron(); }
  bool operator()(const PolygonShape& /*s*/) {
    const Height plane = Facing(HeightAbove(planes_.faces[0]));
    if (!plane.FacesLight()) return false;
    forms_.Add(plane.at, plane.error);
    for (const Plane& edge : planes_.edges) {
      if (forms_.PieceMisses()) break;
      AddPencil(HeightAbove(edge), plane);
    }
    forms_.EndPiece();
    return true;
  }
  bool operator()(const TriangleShape& s) { return (*this)(s.polygon); }
  bool operator()(const DiscShape& s) {
    EnterFrame(s.frame);
    return AddDisc(Facing(HeightAbove(planes_.faces[0])), 1);
  }
  bool operator()(const SphereShape& s);
  bool operator()(const FrustumShape& s);

 private:
  static Height Facing(const Height& height) { return height.light < 0 ? height * -1 : height; }

  Height HeightAbove(const Plane& plane) const {
    Height height;
    height.light = LightAbove(plane);
    SetRest(plane, height);
    return height;
  }
  double LightAbove(const Plane& plane) const {
    return is_point_ ? SignedDistance(plane, light_) : Dot(plane.normal, light_);
  }
  double LightError() const { return is_point_ ? clearance_ : kFunctionClearance; }
  // All but the light's.
  void SetRest(const Plane& plane, Height& height) const {
    height.at.c = Dot(cell_.corner - plane.point, plane.normal);
    height.at.s = Dot(cell_.eu, plane.normal);
    height.at.t = Dot(cell_.ev, plane.normal);
    height.error = clearance_;
    height.light_error = LightError();
  }

  void AddPencil(const Height& g, const Height& d) {
    const Pencil pencil = PencilOf(g, d);
    forms_.Add(pencil.at, pencil.margin);
  }
  bool AddPolyhedron();

  // Object coordinates of the cell and the light.
  void EnterFrame(const AffineFrame& frame) {
    const Mat3& m = frame.object_from_world;
    double square = 0;
    for (const Vec3d& row : m.row) square += LengthSquared(row);
    const double stretch = std::sqrt(square);
    const Vec3d p = m * (cell_.corner - frame.center), u = m * cell_.eu, v = m * cell_.ev;
    const Vec3d l = m * (is_point_ ? light_ - frame.center : light_);
    const double error = clearance_ * stretch;
    const double light_error = is_point_ ? error : kFunctionClearance * stretch;
    for (int i = 0; i < 3; ++i) {
      axis_[static_cast<size_t>(i)] = {{p[i], u[i], v[i]}, l[i], error, light_error};
    }
  }
  // Of what EnterFrame left, in the plane d = 0 about the axis.
  bool AddDisc(const Height& d, double radius);
  void AddTrapezoid(const Height& w);

  const SurfaceChart::PlanarCell& cell_;
  const FacePlanes& planes_;
  const bool is_point_;
  const Vec3d light_;  // or the direction to it
  const double weight_;
  const double clearance_;
  std::array<Height, 3> axis_;
  ShadowForms forms_;
};

bool Builder::AddPolyhedron() {
  if (planes_.faces.size() > kMaxFunctionFaces) return false;
  // The light's side from the front, the others from the back.
  std::array<Height, kMaxFunctionFaces> heights;
  size_t facing = 0, others = heights.size();
  for (const Plane& face : planes_.faces) {
    const double light = LightAbove(face);
    Height& height = heights[light > LightError() ? facing++ : --others];
    height.light = light;
    SetRest(face, height);
  }
  if (facing == 0) return false;
  for (size_t i = 0; i < facing && !forms_.PieceMisses(); ++i) {
    forms_.Add(heights[i].at, heights[i].error);
    for (size_t j = heights.size(); j-- > others && !forms_.PieceMisses();) {
      AddPencil(heights[j], heights[i]);
    }
  }
  forms_.EndPiece();
  return true;
}

bool Builder::AddDisc(const Height& d, double radius) {
  if (!d.FacesLight()) return false;
  forms_.Add(d.at, d.error);
  if (forms_.PieceMisses()) {
    forms_.EndPiece();
    return true;
  }
  const Height &x = axis_[0], &y = axis_[1];
  const Pencil px = PencilOf(x, d), py = PencilOf(y, d);
  const Affine slope = d.at * weight_ + -d.light;
  const double slope_error = d.error * weight_ + d.light_error;
  const double px_bound = px.at.Bound(), py_bound = py.at.Bound(), bound = slope.Bound();
  const double margin = (2 * px_bound + px.margin) * px.margin +
                        (2 * py_bound + py.margin) * py.margin +
                        radius * radius * (2 * bound + slope_error) * slope_error;
  forms_.Add(Square(px.at) + Square(py.at) - Square(slope) * (radius * radius), margin);
  forms_.EndPiece();
  return true;
}

// With q = L - p the tracer's roots are in = c / k and out, k = sqrt(discriminant) - p.q > 0, where
// c = |p|^2 - 1 > 0 and -p.q = c - l, l = p.L - 1 < 0: in lies between 0 and c / (c - l) < 1.
bool Builder::operator()(const SphereShape& s) {
  EnterFrame(s.frame);
  const double dp = axis_[0].error, dl = axis_[0].light_error;
  Affine polar{-weight_, 0, 0};
  Quadratic outside{{-1}};
  double light_square = 0, bound_square = 0;
  for (const Height& a : axis_) {
    polar = polar + a.at * a.light;
    outside = outside + Square(a.at);
    light_square += a.light * a.light;
    bound_square += a.at.Bound() * a.at.Bound();
  }
  const double l = std::sqrt(light_square), p = std::sqrt(bound_square);
  const bool is_light_outside = light_square - weight_ > 4 * l * dl;
  const double moment_error = dp * l + (p + dp) * dl, offset_error = weight_ * dp + dl;
  if (!is_light_outside || !(ExtentOf(polar).high < -moment_error) ||
      !(ExtentOf(outside).low > (2 * p + dp) * dp)) {
    return false;
  }
  Quadratic offset, moment;
  for (size_t i = 0; i < 3; ++i) {
    const Height &a = axis_[i], &b = axis_[(i + 1) % 3];
    offset = offset + Square(a.at * weight_ + -a.light);
    moment = moment + Square(a.at * b.light - b.at * a.light);
  }
  const double margin = (2 * p * l + moment_error) * moment_error +
                        (2 * (weight_ * p + l) + offset_error) * offset_error;
  forms_.Add(moment - offset, margin);
  forms_.EndPiece();
  return true;
}

// The light's polar plane cuts the frustum in the trapezoid between two generators, at the angles
// +-alpha from the light's own, cos(alpha) = w(L) / rho: there the tangent planes
//   x cos + y sin - w(z) = 0
// hold the light. Where the light is inside the cone (or sees all of it from beyond the apex) there
// are none, and every chord ends on a cap.
void Builder::AddTrapezoid(const Height& w) {
  const Height &x = axis_[0], &y = axis_[1], &z = axis_[2];
  const double rho = std::hypot(x.light, y.light);
  const double error = x.error, light_error = x.light_error;
  const double scale = rho + std::abs(w.light);
  Height polar;
  polar.at = x.at * x.light + y.at * y.light - w.at * w.light;
  polar.light = rho * rho - w.light * w.light;
  polar.error = 2 * scale * error +
                2 * (x.at.Bound() + y.at.Bound() + w.at.Bound() + 3 * error) * light_error;
  polar.light_error = 4 * (scale + light_error) * light_error;
  const Height base = z * -1;
  Height top = z;
  top.at = top.at + -1;
  top.light -= weight_;
  forms_.Add(polar.at, polar.error);
  AddPencil(base, polar);
  AddPencil(top, polar);
  const double cosine = w.light / rho, sine = std::sqrt(1 - cosine * cosine);
  const double ux = x.light / rho, uy = y.light / rho;
  for (const double side : {sine, -sine}) {
    const Affine form = x.at * (ux * cosine - uy * side) + y.at * (uy * cosine + ux * side) - w.at;
    forms_.Add(form, 4 * error);
  }
  forms_.EndPiece();
}

bool Builder::operator()(const FrustumShape& s) {
  if (s.open) return false;
  EnterFrame(s.frame);
  const Height& z = axis_[2];
  Height top = z;
  top.at = top.at + -1;
  top.light -= weight_;
  const double taper = s.top_radius - s.base_radius;
  Height w = z * taper;
  w.at = w.at + s.base_radius;
  w.light += weight_ * s.base_radius;
  const double rho2 = axis_[0].light * axis_[0].light + axis_[1].light * axis_[1].light;
  const double w2 = w.light * w.light;
  if (!(std::abs(rho2 - w2) > kTangent * (rho2 + w2))) return false;
  // From inside the frustum the light is hidden without a chord.
  if (is_point_ && z.light > 0 && top.light < 0 && rho2 < w2) return false;
  if (!AddDisc(Facing(z), s.base_radius) || !AddDisc(Facing(top), s.top_radius)) return false;
  if (rho2 > w2) AddTrapezoid(w);
  return true;
}

}  // namespace

Shadowing ShadowBuilder::Build(const Shape& shape, const FacePlanes& planes, double clearance,
                               std::vector<float>& coefficients, ShadowFunction& function) const {
  Builder builder(cell_, light_, planes, clearance + cell_.pad, coefficients);
  return std::visit(builder, shape) ? builder.Finish(function) : Shadowing::kUnknown;
}

}  // namespace linetree
