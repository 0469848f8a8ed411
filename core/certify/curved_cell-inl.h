// A cell of a sphere, a frustum's lateral surface or a triangle with vertex normals as jets of its
// two chart coordinates, and the diffuse light of one light on it. The charts are those of
// core/tree/surface_chart.h.
//
// Hits are not the points that jets are made of but within a slip s of them. That turns the
// direction to a light at the distance d by 2 s / d at most and changes what distance leaves of it
// by p s / d, relatively, p the power of its fading. Normals of spheres do not change along their
// radius. A frustum's gradient (x, y, -w taper) has another third component there, relatively by
// s / w; a triangle's normal, the sum of weights (distance from edge i) / height_i times vertex
// normals n_i, changes by s sum |n_i| / height_i. A unit normal turns by twice what its vector
// changes by, relative to its length. All of it is added to the term's error (noise).
#if defined(LINETREE_CORE_CERTIFY_CURVED_CELL_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_CERTIFY_CURVED_CELL_INL_H_
#undef LINETREE_CORE_CERTIFY_CURVED_CELL_INL_H_
#else
#define LINETREE_CORE_CERTIFY_CURVED_CELL_INL_H_
#endif

#include <numbers>

#include "core/certify/curved_terms.h"
#include "core/certify/fading_jet-inl.h"
#include "core/certify/jet_shape.h"
#include "core/jet/angle_functions-inl.h"
#include "core/jet/jet_vector-inl.h"
#include "core/scene/scene.h"

LINETREE_BEFORE_JETS();
namespace linetree::LINETREE_JETS {

class CurvedCell {
 public:
  using Jet = CornerJet<2>;
  using Vector = JetVector<2>;

  explicit CurvedCell(const CurvedTask& task) : shape_(task.shape), slip_(task.slip) {
    if (task.plane != nullptr) {
      SetTriangle(*task.plane, task.turn);
      return;
    }
    const JetShape& shape = task.shape;
    const SurfaceCell& cell = task.cell;
    const int patch = task.patch;
    const double width = std::ldexp(1.0, -cell.depth);
    const Jet u = Jet::Variable(0, cell.i * width, (cell.i + 1) * width);
    const Jet v = Jet::Variable(1, cell.j * width, (cell.j + 1) * width);
    if (shape.kind == JetShape::Kind::kSphere) {
      SetSphere(patch, u, v);
    } else {
      SetLateral(patch, u, v);
    }
  }

  // Whether the surface has a normal everywhere on the cell.
  bool IsValid() const { return is_valid_; }

  CurvedTerm CosineTo(const Light& light) const {
    CurvedTerm term;
    Jet facing, strength;
    double noise = normal_noise_, drift = 0;  // of the cosine; of the strength, relatively
    const bool fades = light.kind == LightKind::kPoint && light.fade_distance > 0;
    if (light.kind == LightKind::kDirectional) {
      facing = Dot(normal_, light.to_light);
    } else {
      const Vector segment = -(point_ - light.position);
      const Jet square = LengthSquared(segment);
      if (!(square.lo() > kLeastShare * square.hi())) return term;
      facing = Jet(Dot(normal_, segment)) * Jet(InverseSquareRoot(square));
      const double share = slip_ / std::sqrt(square.lo());
      if (!(share < kMostSlip)) return term;
      noise += 2 * share;
      drift = light.fade_power * share;
      if (fades && !FadeOver(light, square, strength)) return term;
    }
    facing.AssumeWithin(-1, 1);
    term.is_known = true;
    const double setting = kSetting + noise;
    if (facing.hi() < -setting) return CurvedTerm{true, 0, 0, 0, {}};
    const bool smooth = facing.lo() > setting;
    const Jet arriving = fades ? Jet(facing * strength) : facing;
    double corners[4];
    arriving.k.Store(corners);
    for (size_t k = 0; k < 4; ++k) term.corners[k] = std::max(0.0, corners[k]);
    if (fades) noise = (noise + 2 * drift) * std::max(0.0, strength.hi());
    term.least = std::max(0.0, arriving.lo() - noise);
    term.most = std::max(0.0, arriving.hi()) + noise;
    const double range = arriving.v.Width() + arriving.slack;
    // Where the light sets inside the cell the function has a kink: its range bounds the error.
    term.error = Above((smooth ? std::min(arriving.InterpolationError(), range) : range) + noise);
    return term;
  }

 private:
  // Squared distances that vary more than this are left alone.
  static constexpr double kLeastShare = 0x1p-20;
  // Cosines below are taken for those of a light that may set.
  static constexpr double kSetting = 0x1p-30;
  // Lights are left alone that hits are this share of their distance off: the bounds on what that
  // changes are of first order, with as much to spare.
  static constexpr double kMostSlip = 0x1p-10;

  void SetSphere(int patch, const Jet& u, const Jet& v) {
    const Jet a = Tangent(AngleOf(u)), b = Tangent(AngleOf(v));
    const Jet inverse_length = InverseSquareRoot(Jet(Square(a) + Square(b) + 1.0));
    const int k = patch / 2;
    Jet* on_sphere[3] = {&object_point_.x, &object_point_.y, &object_point_.z};
    *on_sphere[k] = patch % 2 == 0 ? inverse_length : -inverse_length;
    *on_sphere[(k + 1) % 3] = a * inverse_length;
    *on_sphere[(k + 2) % 3] = b * inverse_length;
    Finish(object_point_);
  }
  // The equi-angular map: [0, 1] to [-pi/4, pi/4].
  static Jet AngleOf(const Jet& u) {
    constexpr double kQuarter = std::numbers::pi / 4;
    Jet angle = (u * 2.0 + -1.0) * kQuarter;
    angle.AssumeWithin(-kQuarter, kQuarter);
    return angle;
  }

  void SetLateral(int patch, const Jet& u, const Jet& v) {
    Jet angle = u * (std::numbers::pi / 2);
    angle.AssumeWithin(0, std::numbers::pi / 2);
    const Jet cosine = Cosine(angle), sine = Sine(angle);
    const Jet x[4] = {cosine, -sine, -cosine, sine};  // of quadrant 0, 1, 2, 3
    const Jet y[4] = {sine, cosine, -sine, -cosine};
    const Jet w = v * shape_.taper + shape_.base_radius;
    if (!(w.lo() > kApexShare * shape_.FrameScale())) return;
    object_point_ = {x[patch] * w, y[patch] * w, v};
    // The gradient (x, y, -taper w), divided by w. The slip is seen through the thinnest axis.
    const double noise = std::abs(shape_.taper) * slip_ * RowSum() / w.lo();
    Finish({x[patch], y[patch], Jet::Constant(-shape_.taper)}, noise * RowSum());
  }

  // What bounds the stretch of object_from_world and its transpose.
  double RowSum() const {
    double sum = 0;
    for (const Vec3d& row : shape_.frame.object_from_world.row) {
      sum += std::abs(row.x) + std::abs(row.y) + std::abs(row.z);
    }
    return sum;
  }

  // `noise`: of the gradient in the world.
  void Finish(const Vector& gradient, double noise = 0) {
    point_ = ToWorld(object_point_);
    SetNormal(MultiplyTransposed(shape_.frame.object_from_world, gradient), noise);
  }
  void SetNormal(const Vector& outward, double noise) {
    const Jet square = LengthSquared(outward);
    is_valid_ = square.lo() > kLeastShare * square.hi();
    if (!is_valid_) return;
    normal_ = outward * InverseSquareRoot(square);
    normal_noise_ = 2 * noise / std::sqrt(square.lo());
    is_valid_ = normal_noise_ < kMostSlip;
  }

  // Points and normals are linear; the normals have to be made unit vectors. The cell may reach
  // beyond the triangle, where nobody asks.
  void SetTriangle(const SurfaceChart::PlanarCell& cell, double turn) {
    const std::array<double, 2> from{0, 0}, to{1, 1};
    Vec3d constant, by_u, by_v;
    double noise = 0;
    for (size_t i = 0; i < 3; ++i) {
      const Plane& opposite = shape_.edges[(i + 1) % 3];
      const Vec3d normal = shape_.corner_normals[i] * (turn / shape_.heights[i]);
      constant = constant + normal * SignedDistance(opposite, cell.corner);
      by_u = by_u + normal * Dot(opposite.normal, cell.eu);
      by_v = by_v + normal * Dot(opposite.normal, cell.ev);
      noise += Length(normal) * slip_;
    }
    Vector outward;
    Jet* point[3] = {&point_.x, &point_.y, &point_.z};
    Jet* turned[3] = {&outward.x, &outward.y, &outward.z};
    for (int i = 0; i < 3; ++i) {
      *point[i] = Jet::Affine(cell.corner[i], {cell.eu[i], cell.ev[i]}, from, to);
      *turned[i] = Jet::Affine(constant[i], {by_u[i], by_v[i]}, from, to);
    }
    SetNormal(outward, noise);
  }
  Vector ToWorld(const Vector& p) const {
    const Vector turned = shape_.frame.world_from_object * p;
    const Vec3d& c = shape_.frame.center;
    return {turned.x + c.x, turned.y + c.y, turned.z + c.z};
  }

  const JetShape& shape_;
  const double slip_;
  bool is_valid_ = false;
  double normal_noise_ = 0;  // of the unit normal
  Vector object_point_, point_, normal_;
};

inline bool FindCurvedTerms(const CurvedTask& task, CurvedTerm* terms) {
  const CurvedCell cell(task);
  if (!cell.IsValid()) return false;
  for (size_t i = 0; i < task.lights.size(); ++i) {
    terms[i] = cell.CosineTo(task.scene.lights[task.lights[i]]);
  }
  return true;
}

}  // namespace linetree::LINETREE_JETS
LINETREE_AFTER_JETS();

#endif
