// A cell of a sphere or a frustum's lateral surface as jets of its two chart coordinates, and the
// diffuse light of one light on it. The charts are those of core/tree/surface_chart.h.
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

  CurvedCell(const JetShape& shape, int patch, const SurfaceCell& cell) : shape_(shape) {
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
    const bool fades = light.kind == LightKind::kPoint && light.fade_distance > 0;
    if (light.kind == LightKind::kDirectional) {
      facing = Dot(normal_, light.to_light);
    } else {
      const Vector segment = -(point_ - light.position);
      const Jet square = LengthSquared(segment);
      if (!(square.lo() > kLeastShare * square.hi())) return term;
      facing = Jet(Dot(normal_, segment)) * Jet(InverseSquareRoot(square));
      if (fades && !FadeOver(light, square, strength)) return term;
    }
    facing.AssumeWithin(-1, 1);
    term.is_known = true;
    if (facing.hi() < -kSetting) return CurvedTerm{true, 0, 0, 0, {}};
    const bool smooth = facing.lo() > kSetting;
    const Jet arriving = fades ? Jet(facing * strength) : facing;
    double corners[4];
    arriving.k.Store(corners);
    for (size_t k = 0; k < 4; ++k) term.corners[k] = std::max(0.0, corners[k]);
    term.least = std::max(0.0, arriving.lo());
    term.most = std::max(0.0, arriving.hi());
    const double range = arriving.v.Width() + arriving.slack;
    // Where the light sets inside the cell the function has a kink: its range bounds the error.
    term.error = smooth ? std::min(arriving.InterpolationError(), range) : range;
    return term;
  }

 private:
  // Squared distances that vary more than this are left alone.
  static constexpr double kLeastShare = 0x1p-20;
  // Cosines below are taken for those of a light that may set.
  static constexpr double kSetting = 0x1p-30;

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
    // The gradient (x, y, -taper w), divided by w.
    Finish({x[patch], y[patch], Jet::Constant(-shape_.taper)});
  }

  void Finish(const Vector& gradient) {
    point_ = ToWorld(object_point_);
    const Vector outward = MultiplyTransposed(shape_.frame.object_from_world, gradient);
    const Jet square = LengthSquared(outward);
    is_valid_ = square.lo() > kLeastShare * square.hi();
    if (is_valid_) normal_ = outward * InverseSquareRoot(square);
  }
  Vector ToWorld(const Vector& p) const {
    const Vector turned = shape_.frame.world_from_object * p;
    const Vec3d& c = shape_.frame.center;
    return {turned.x + c.x, turned.y + c.y, turned.z + c.z};
  }

  const JetShape& shape_;
  bool is_valid_ = false;
  Vector object_point_, point_, normal_;
};

inline bool FindCurvedTerms(const CurvedTask& task, CurvedTerm* terms) {
  const CurvedCell cell(task.shape, task.patch, task.cell);
  if (!cell.IsValid()) return false;
  for (size_t i = 0; i < task.lights.size(); ++i) {
    terms[i] = cell.CosineTo(task.scene.lights[task.lights[i]]);
  }
  return true;
}

}  // namespace linetree::LINETREE_JETS
LINETREE_AFTER_JETS();

#endif
