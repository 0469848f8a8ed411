#include "core/tree/surface_chart.h"

namespace linetree {

SurfaceChart::FaceForm SurfaceChart::FormOf(int face) const {
  using Kind = FaceForm::Kind;
  FaceForm form;
  if (curved_ == Curved::kNone || (curved_ == Curved::kLateral && face > 0)) {
    const int index = curved_ == Curved::kLateral ? face - 1 : face;
    const PlanePatch& plane = planes_.at(static_cast<size_t>(index));
    const auto scaled = [](const Vec3d& g, double half) {
      return half > 0 ? g * (1 / half) : Vec3d{};
    };
    form.patch = curved_patches_ + index;
    form.center = plane.center;
    form.row = {scaled(plane.gx, plane.hx), scaled(plane.gy, plane.hy), plane.normal};
    form.tolerance = slack_ / 2;
    return form;
  }
  form.kind = curved_ == Curved::kSphere ? Kind::kSphere : Kind::kLateral;
  form.center = frame_.center;
  for (size_t i = 0; i < 3; ++i) form.row[i] = frame_.object_from_world.row[i];
  form.tolerance = slack_ / 2 / max_stretch_;
  form.base_radius = base_radius_;
  form.taper = taper_;
  return form;
}

}  // namespace linetree
