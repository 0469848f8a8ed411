#include "core/certify/curved_screen.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/trace/intersect.h"
#include "core/trace/shade.h"

namespace linetree {
namespace {

// Of cosines, absolute: what is smaller may be rounding, and is let pass.
constexpr double kRounding = 0x1p-30;

// The two coordinates of a corner or, the last one, of the middle.
Vec3d PlaceOf(size_t place, const SurfaceCell& cell) {
  const double width = std::ldexp(1.0, -cell.depth);
  const double i = place == 4 ? 0.5 : static_cast<double>(place & 1);
  const double j = place == 4 ? 0.5 : static_cast<double>(place >> 1);
  return {(cell.i + i) * width, (cell.j + j) * width, 0};
}

}  // namespace

CurvedScreen::CurvedScreen(const Shape& shape, int patch, const SurfaceCell& cell) {
  if (const auto* sphere = std::get_if<SphereShape>(&shape)) {
    SetSphere(*sphere, patch, cell);
  } else {
    SetLateral(std::get<FrustumShape>(shape), patch, cell);
  }
}

CurvedScreen::CurvedScreen(const TriangleShape& shape, const SurfaceChart::PlanarCell& cell,
                           double turn) {
  for (size_t place = 0; place < kPlaces; ++place) {
    const Vec3d at = PlaceOf(place, {});
    points_[place] = cell.corner + cell.eu * at.x + cell.ev * at.y;
    normals_[place] = Normalized(OutwardNormal(shape, 0, points_[place])) * turn;
  }
}

void CurvedScreen::Set(size_t place, const AffineFrame& frame, const Vec3d& point,
                       const Vec3d& gradient) {
  points_[place] = frame.center + frame.world_from_object * point;
  normals_[place] = Normalized(MultiplyTransposed(frame.object_from_world, gradient));
}

void CurvedScreen::SetSphere(const SphereShape& shape, int patch, const SurfaceCell& cell) {
  const int k = patch / 2;
  for (size_t place = 0; place < kPlaces; ++place) {
    const Vec3d at = PlaceOf(place, cell);
    Vec3d p;
    p[k] = patch % 2 == 0 ? 1 : -1;
    p[(k + 1) % 3] = std::tan(std::numbers::pi / 4 * (2 * at.x - 1));
    p[(k + 2) % 3] = std::tan(std::numbers::pi / 4 * (2 * at.y - 1));
    p = Normalized(p);
    Set(place, shape.frame, p, p);
  }
}

void CurvedScreen::SetLateral(const FrustumShape& shape, int patch, const SurfaceCell& cell) {
  const double taper = shape.top_radius - shape.base_radius;
  for (size_t place = 0; place < kPlaces; ++place) {
    const Vec3d at = PlaceOf(place, cell);
    const double angle = (patch + at.x) * (std::numbers::pi / 2);
    const double x = std::cos(angle), y = std::sin(angle), w = shape.base_radius + taper * at.y;
    has_apex_ = has_apex_ || !(w > 0);
    Set(place, shape.frame, {x * w, y * w, at.y}, {x, y, -taper});
  }
}

bool CurvedScreen::MayBeLinear(const Light& light, double spread) const {
  std::array<double, kPlaces> terms{};
  for (size_t place = 0; place < kPlaces; ++place) {
    const LightView<double> view = ViewOf(light, points_[place]);
    terms[place] = std::max(0.0, Dot(normals_[place], view.to_light)) * view.fall_off;
  }
  const double bilinear = (terms[0] + terms[1] + terms[2] + terms[3]) / 4;
  const double least = *std::min_element(terms.begin(), terms.end());
  return !(std::abs(bilinear - terms[4]) > spread * least + kRounding * (bilinear + terms[4]));
}

}  // namespace linetree
