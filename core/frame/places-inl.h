// Where hits lie on a face's chart, sixteen at a time: SurfaceChart::Locate and IsOn.
#if defined(LINETREE_CORE_FRAME_PLACES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_FRAME_PLACES_INL_H_
#undef LINETREE_CORE_FRAME_PLACES_INL_H_
#else
#define LINETREE_CORE_FRAME_PLACES_INL_H_
#endif

#include "core/packet/lanes-inl.h"
#include "core/tree/surface_chart.h"
#include "hwy/contrib/math/math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace linetree::HWY_NAMESPACE {

// One entry for every lane.
struct alignas(64) Places {
  double u[kPacketLanes], v[kPacketLanes];  // in [0, 1], of the patch
  int32_t patch[kPacketLanes];
  int32_t i[kPacketLanes], j[kPacketLanes];  // the cell of depth kMaxSurfaceDepth
  LaneMask on = 0;                           // what is said of cells holds for these hits
  LaneMask outward = 0;  // the facing normal is the surface's own: outwards on solids
};

HWY_INLINE Doubles ArcTangent(const Doubles& x) {
  Doubles r;
  for (size_t k = 0; k < LanesOf<double>::kVectors; ++k) {
    r.v[k] = hn::Atan(Doubles::Tag(), x.v[k]);
  }
  return r;
}

HWY_INLINE Doubles Clamped(const Doubles& x) {
  return Min(Max(x, Doubles::All(0)), Doubles::All(1));
}

// Index of the cell of depth kMaxSurfaceDepth along one axis.
HWY_INLINE void StoreIndex(const Doubles& x, int32_t* to) {
  constexpr double kCells = 1 << kMaxSurfaceDepth;
  const Doubles cell = Min(x * Doubles::All(kCells), Doubles::All(kCells - 1));
  for (size_t k = 0; k < LanesOf<double>::kVectors; ++k) {
    const hn::Rebind<int32_t, Doubles::Tag> half;
    hn::Store(hn::DemoteTo(half, cell.v[k]), half, to + k * LanesOf<double>::kWidth);
  }
}

HWY_INLINE void StorePatch(const Doubles& patch, int32_t* to) {
  for (size_t k = 0; k < LanesOf<double>::kVectors; ++k) {
    const hn::Rebind<int32_t, Doubles::Tag> half;
    hn::Store(hn::DemoteTo(half, patch.v[k]), half, to + k * LanesOf<double>::kWidth);
  }
}

HWY_INLINE void StorePlaces(const Doubles& u, const Doubles& v, const Doubles& patch,
                            Places& places) {
  const Doubles x = Clamped(u), y = Clamped(v);
  x.Store(places.u);
  y.Store(places.v);
  StoreIndex(x, places.i);
  StoreIndex(y, places.j);
  StorePatch(patch, places.patch);
}

using FaceForm = SurfaceChart::FaceForm;

HWY_INLINE WideMask PlaceOnPlane(const FaceForm& form, const WideVectors& p, Places& places) {
  const Doubles one = Doubles::All(1), half = Doubles::All(0.5);
  StorePlaces((p.x + one) * half, (p.y + one) * half, Doubles::All(form.patch), places);
  return (Abs(p.x) <= one) & (Abs(p.y) <= one) & (Abs(p.z) <= Doubles::All(form.tolerance));
}

// The equi-angular coordinate of a ratio in [-1, 1].
HWY_INLINE Doubles EquiAngular(const Doubles& ratio) {
  constexpr double kTwoOverPi = 0.636619772367581343;
  return (ArcTangent(ratio) * Doubles::All(2 * kTwoOverPi) + Doubles::All(1)) * Doubles::All(0.5);
}

HWY_INLINE WideMask PlaceOnSphere(const FaceForm& form, const WideVectors& p, Places& places) {
  const Doubles ax = Abs(p.x), ay = Abs(p.y), az = Abs(p.z);
  const WideMask is_y = ay > ax;
  const WideMask is_z = az > Max(ax, ay);
  const Doubles along = Select(is_z, p.z, Select(is_y, p.y, p.x));
  const Doubles i = Select(is_z, p.x, Select(is_y, p.z, p.y));
  const Doubles j = Select(is_z, p.y, Select(is_y, p.x, p.z));
  const Doubles inverse = Doubles::All(1) / Abs(along);
  const Doubles zero = Doubles::All(0);
  const Doubles patch = Select(is_z, Doubles::All(4), Select(is_y, Doubles::All(2), zero)) +
                        Select(along < zero, Doubles::All(1), zero);
  StorePlaces(EquiAngular(i * inverse), EquiAngular(j * inverse), patch, places);
  // | |p| - 1 | <= | |p|^2 - 1 |.
  return Abs(Dot(p, p) - Doubles::All(1)) <= Doubles::All(form.tolerance);
}

HWY_INLINE WideMask PlaceOnLateral(const FaceForm& form, const WideVectors& p, Places& places) {
  const Doubles zero = Doubles::All(0), one = Doubles::All(1);
  const WideMask left = p.x < zero, low = p.y < zero;
  // The quadrants from 0, pi/2, pi, 3pi/2 on; (a, b) is (x, y) turned back into the first.
  const WideMask second = Without(p.x <= zero, low) & (p.y > zero);
  const WideMask third = left & (p.y <= zero);
  const WideMask fourth = Without(low, left);
  const Doubles a = Select(second, p.y, Select(third, -p.x, Select(fourth, -p.y, p.x)));
  const Doubles b = Select(second, -p.x, Select(third, -p.y, Select(fourth, p.x, p.y)));
  const Doubles patch =
      Select(second, one, Select(third, Doubles::All(2), Select(fourth, Doubles::All(3), zero)));
  constexpr double kTwoOverPi = 0.636619772367581343;
  const Doubles least = Min(a, b), most = Max(a, b);
  const Doubles angle = ArcTangent(least / most) * Doubles::All(kTwoOverPi);
  StorePlaces(Select(b > a, one - angle, angle), p.z, patch, places);
  const Doubles radius = Doubles::All(form.base_radius) + Doubles::All(form.taper) * p.z;
  // |h - r| <= |h^2 - r^2| / r.
  return (p.z >= zero) & (p.z <= one) &
         (Abs(p.x * p.x + p.y * p.y - radius * radius) <= Doubles::All(form.tolerance) * radius);
}

// In object space the outward normal of a curved face has the direction of a gradient g, which is
// M^T g in the world: n . M^T g = (M n) . g. Either n points that way or straight against it.
HWY_INLINE LaneMask OutwardOnCurve(const FaceForm& form, const WideVectors& p,
                                   const WideVectors& normal) {
  const WideVectors n = {Dot(normal, Spread(form.row[0])), Dot(normal, Spread(form.row[1])),
                         Dot(normal, Spread(form.row[2]))};
  WideVectors gradient = p;
  if (form.kind == FaceForm::Kind::kLateral) {
    const Doubles taper = Doubles::All(form.taper);
    gradient.z = -((Doubles::All(form.base_radius) + taper * p.z) * taper);
  }
  return BitsOf(Dot(n, gradient) > Doubles::All(0));
}

// Places of the hits, all of which are on the face of this form. Entries of other lanes are not
// specified.
HWY_INLINE void PlaceHits(const FaceForm& form, const PacketHits& hits, LaneMask lanes,
                          Places& places) {
  const WideVectors d = Load(hits.point) - Spread(form.center);
  const WideVectors p = {Dot(d, Spread(form.row[0])), Dot(d, Spread(form.row[1])),
                         Dot(d, Spread(form.row[2]))};
  const WideVectors normal = Load(hits.normal);
  places.outward = form.kind == FaceForm::Kind::kPlane
                       ? BitsOf(Dot(normal, Spread(form.row[2])) > Doubles::All(0))
                       : OutwardOnCurve(form, p, normal);
  WideMask on;
  switch (form.kind) {
    case FaceForm::Kind::kPlane:
      on = PlaceOnPlane(form, p, places);
      break;
    case FaceForm::Kind::kSphere:
      on = PlaceOnSphere(form, p, places);
      break;
    case FaceForm::Kind::kLateral:
      on = PlaceOnLateral(form, p, places);
      break;
  }
  places.on = BitsOf(on) & lanes;
}

}  // namespace linetree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
