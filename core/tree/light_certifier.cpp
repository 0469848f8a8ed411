#include "core/tree/light_certifier.h"

#include <algorithm>

#include "core/tree/separation.h"
#include "core/tree/shadow_forms.h"

namespace linetree {
namespace {

double SquaredDistance(const Box3& box, const Vec3d& p) {
  double sum = 0;
  for (int i = 0; i < 3; ++i) {
    const double d = std::max({box.min[i] - p[i], p[i] - box.max[i], 0.0});
    sum += d * d;
  }
  return sum;
}

// A hidden point may be this many times as far from the light as its occluder: the widening of the
// hull, which keeps hidden points away from the shadow's border, shrinks by that factor on the way.
constexpr double kMaxMagnification = 1e4;

// A contact's sliver is at most this share of the hull's height above the plane: the points in it
// search the scene for every light.
constexpr double kMaxSliver = 0x1p-12;

// The least and the largest distance of a hull's points.
struct Heights {
  double low = Box3::kInf, high = -Box3::kInf;
};
Heights HeightsOf(const PatchHull& hull, const Plane& plane, double sign) {
  Heights heights;
  for (const Vec3d& p : hull.points) {
    const double height = sign * SignedDistance(plane, p);
    heights.low = std::min(heights.low, height);
    heights.high = std::max(heights.high, height);
  }
  return heights;
}

// Whether a function leaves it open that the light is hidden everywhere. Linear ones have said so.
bool MayHideAll(const ShadowFunction& function, const CellLights& cell) {
  if (function.squares == 0) return false;
  const float* coefficients = cell.coefficients.data();
  for (const float s : {0.0f, 1.0f}) {
    for (const float t : {0.0f, 1.0f}) {
      if (ShadowingAt(function, coefficients, s, t) == Shadowing::kMisses) return false;
    }
  }
  return true;
}

// False when there is no room. Who is there already gets the larger clearance.
bool AddContact(const Contact& contact, std::vector<Contact>& contacts) {
  for (Contact& other : contacts) {
    if (!(other.plane == contact.plane)) continue;
    other.clearance = std::max(other.clearance, contact.clearance);
    return true;
  }
  if (contacts.size() == kMaxContacts) return false;
  contacts.push_back(contact);
  return true;
}

}  // namespace

// The shadow rays from one hull to one light, which Aim says.
struct LightCertifier::Bundle {
  Bundle(int self_object, const PatchHull& patch) : self(self_object), hull(patch) {
    std::copy(patch.points.begin(), patch.points.end(), points.begin());
    for (const Vec3d& p : patch.points) shaft_from.Add(p);
  }

  void Aim(int light_index, const Light& source, const Box3& world) {
    light = light_index;
    source_light = &source;
    shaft_to = Box3();
    if (source.kind == LightKind::kPoint) {
      points[8] = source.position;
      shaft_to.Add(source.position);
    } else {
      // Far enough to pass everything in the world's box.
      const double reach = Length(world.Extent()) + Length(shaft_from.Center() - world.Center());
      for (const Vec3d& p : hull.points) shaft_to.Add(p + source.to_light * reach);
    }
    Box3 all = shaft_from;
    all.Add(shaft_to);
    clearance = ClearanceOf(all);
  }

  const int self;
  int light = 0;
  const PatchHull& hull;
  const Light* source_light = nullptr;
  std::array<Vec3d, 9> points;  // the hull and, for a point light, the light
  Box3 shaft_from, shaft_to;
  double clearance = 0;
};

// What comes up while the lights' candidates are looked at, light after light. Without `cell` what
// is said holds everywhere, and there are no functions.
struct LightCertifier::Findings {
  CellLights* cell = nullptr;
  const SurfaceChart::PlanarCell* plane = nullptr;  // null: no functions
  const CellLights* parent = nullptr;
  int child = -1;  // of the parent's cell; -1: its functions are not to be divided
  // Of one light:
  std::vector<int32_t> kept{};
  std::vector<std::pair<int32_t, ShadowFunction>> functions{};  // of objects that have one
  int32_t occluder = kNoObject;                                 // hides it from the whole piece

  void Clear() {
    kept.clear();
    functions.clear();
    occluder = kNoObject;
  }
  // Null when the object has none.
  const ShadowFunction* FunctionOf(int32_t object) const {
    const auto it = std::find_if(functions.begin(), functions.end(),
                                 [&](const auto& entry) { return entry.first == object; });
    return it == functions.end() ? nullptr : &it->second;
  }
  // Whether what is known of a shadow settles the object; whether it is kept is then in `keep`.
  bool Take(int32_t object, const CellShadow& shadow, bool& keep) {
    if (shadow.everywhere == Shadowing::kBlocks) occluder = object;
    if (shadow.function.pieces > 0) functions.emplace_back(object, shadow.function);
    keep = shadow.everywhere != Shadowing::kMisses;
    return !keep || occluder != kNoObject || shadow.function.pieces > 0;
  }
};

LightCertifier::LightCertifier(const Tracer& tracer, bool uses_functions)
    : tracer_(tracer),
      scene_(tracer.scene()),
      world_(scene_.WorldBounds()),
      uses_functions_(uses_functions),
      search_(tracer) {
  planes_.reserve(scene_.objects.size());
  for (const Object& object : scene_.objects) {
    const int index = static_cast<int>(planes_.size());
    clearances_.push_back(search_.Surplus(index) + ClearanceOf(object.bounds));
    planes_.push_back(FacePlanesOf(object.shape));
  }
}

// With the plane's signed distance d, e > 0 at the light and d > 0 at the start, the plane's own
// crossing t = d / (d - e) is negative or larger than 1, by rounding too when d and e are above it;
// towards a directional light, e = n.l, it is negative. It is where rays enter or leave the object
// at best, so that they have no crossing in (0, 1).
bool LightCertifier::LiesBehind(const Bundle& bundle, int object, Findings& findings) const {
  const bool is_point = bundle.source_light->kind == LightKind::kPoint;
  const FacePlanes& planes = planes_[static_cast<size_t>(object)];
  const double clearance = ClearanceTo(bundle, object);
  for (const Plane& face : planes.faces) {
    double height = is_point ? SignedDistance(face, bundle.source_light->position)
                             : Dot(face.normal, bundle.source_light->to_light);
    const double sign = planes.is_planar && height < 0 ? -1 : 1;
    height *= sign;
    if (!(height > (is_point ? clearance : kClearance))) continue;
    const auto [low, high] = HeightsOf(bundle.hull, face, sign);
    if (low > clearance) return true;
    const bool touches = clearance - low <= high * kMaxSliver;
    if (touches && findings.cell != nullptr &&
        AddContact({{face.normal * sign, face.point}, clearance}, findings.cell->contacts)) {
      return true;
    }
  }
  return false;
}

// Above the rounding of a distance between anything in the bundle and a face of the object.
double LightCertifier::ClearanceTo(const Bundle& bundle, int object) const {
  return bundle.clearance + clearances_[static_cast<size_t>(object)];
}

// An object has a function only where it is opaque: how often rays cross it is not asked then.
CellShadow LightCertifier::ShadowOf(const Bundle& bundle, int object, Findings& findings) const {
  if (findings.plane == nullptr || !IsBlack(scene_.MaterialOf(object).transmit)) return {};
  const Shape& shape = scene_.objects[static_cast<size_t>(object)].shape;
  const FacePlanes& planes = planes_[static_cast<size_t>(object)];
  const double clearance = ClearanceTo(bundle, object) * (kFunctionClearance / kClearance);
  if (ShadowBuilder::MustBeOutside(shape)) {
    const bool is_beyond = std::any_of(
        planes.faces.begin(), planes.faces.end(),
        [&](const Plane& face) { return HeightsOf(bundle.hull, face, 1).low > clearance; });
    if (!is_beyond && !CertainlyApart(bundle.hull.points, shape, clearance)) return {};
  }
  return ShadowBuilder(*findings.plane, *bundle.source_light)
      .Build(shape, planes, clearance, findings.cell->coefficients);
}

bool LightCertifier::MayBlock(const Bundle& bundle, int object, Findings& findings) const {
  // Rays that leave its outside cannot meet it; for the others the tracer looks at it itself.
  if (object == bundle.self) return false;
  if (findings.occluder != kNoObject || LiesBehind(bundle, object, findings)) return false;
  bool keep = false;
  if (findings.Take(object, ShadowOf(bundle, object, findings), keep)) return keep;
  const Shape& shape = scene_.objects[static_cast<size_t>(object)].shape;
  const double clearance = bundle.clearance + search_.Surplus(object);
  if (bundle.source_light->kind == LightKind::kPoint) {
    return !CertainlyApart(bundle.points, shape, clearance);
  }
  return !CertainlyApart(bundle.hull.points, bundle.source_light->to_light, shape, clearance);
}

// What a part of the parent's cell keeps of one candidate: its function where it has one.
bool LightCertifier::KeepsMeeting(const Bundle& bundle, size_t index, Findings& findings) const {
  const CellLights& parent = *findings.parent;
  const int32_t object = parent.objects[index];
  if (findings.occluder != kNoObject) return false;
  if (findings.child >= 0 && parent.functions[index].pieces > 0) {
    CellShadow shadow;
    ShadowForms forms(findings.cell->coefficients);
    forms.AddQuarter(parent.functions[index], parent.coefficients.data(), findings.child);
    bool keep = false;
    if (forms.Finish(shadow.everywhere, shadow.function) && findings.Take(object, shadow, keep)) {
      return keep;
    }
  }
  return MayBlock(bundle, object, findings);
}

// Ascending; one more than kMaxCandidates at most, which says that the list is too long.
void LightCertifier::FindCandidates(const Bundle& bundle, const LightList& inherited,
                                    Findings& findings) const {
  findings.Clear();
  if (inherited.knowledge != LightKnowledge::kListed) {
    findings.kept = search_.InShaft(bundle.shaft_from, bundle.shaft_to, bundle.clearance,
                                    [&](int object) { return MayBlock(bundle, object, findings); });
    return;
  }
  const auto first =
      static_cast<size_t>(inherited.candidates.data() - findings.parent->objects.data());
  for (size_t i = 0; i < inherited.candidates.size(); ++i) {
    if (KeepsMeeting(bundle, first + i, findings)) findings.kept.push_back(inherited.candidates[i]);
  }
}

bool LightCertifier::HidesAll(const Bundle& bundle, int object) const {
  return IsBlack(scene_.MaterialOf(object).transmit) && IsCrossedByAll(bundle, object);
}

int LightCertifier::CrossingsOfAll(const Bundle& bundle, int object) const {
  const Shape& shape = scene_.objects[static_cast<size_t>(object)].shape;
  if (!IsCrossedByAll(bundle, object)) return 0;
  if (IsPlanar(shape)) return 1;
  // A point light is outside: IsCrossedByAll wants it away from the object's bounds.
  const double clearance = bundle.clearance + search_.Surplus(object);
  return CertainlyApart(bundle.hull.points, shape, clearance) ? 2 : 0;
}

bool LightCertifier::IsCrossedByAll(const Bundle& bundle, int object) const {
  const Shape& shape = scene_.objects[static_cast<size_t>(object)].shape;
  // An open frustum is not convex: rays may pass through it lengthwise.
  if (const auto* frustum = std::get_if<FrustumShape>(&shape)) {
    if (frustum->open) return false;
  }
  if (bundle.source_light->kind == LightKind::kPoint) {
    const Vec3d& light = bundle.source_light->position;
    const double near2 = SquaredDistance(scene_.objects[static_cast<size_t>(object)].bounds, light);
    double far2 = 0;
    for (const Vec3d& p : bundle.hull.points) far2 = std::max(far2, LengthSquared(p - light));
    if (!(far2 < near2 * kMaxMagnification * kMaxMagnification)) return false;
  }
  const RayStart start{bundle.self, 0, Side::kOutside};
  return std::all_of(bundle.hull.points.begin(), bundle.hull.points.end(), [&](const Vec3d& p) {
    return tracer_.ObjectBlocks(object, p, bundle.light, start);
  });
}

LightKnowledge LightCertifier::Decide(const Bundle& bundle, Findings& findings) const {
  if (findings.occluder != kNoObject) return LightKnowledge::kOff;
  const auto& kept = findings.kept;
  if (kept.empty()) return LightKnowledge::kOn;
  const auto hides = [&](int32_t candidate) {
    const ShadowFunction* function = findings.FunctionOf(candidate);
    const bool may_hide = function == nullptr || MayHideAll(*function, *findings.cell);
    return may_hide && HidesAll(bundle, candidate);
  };
  if (const auto it = std::find_if(kept.begin(), kept.end(), hides); it != kept.end()) {
    findings.occluder = *it;
    return LightKnowledge::kOff;
  }
  return kept.size() <= kMaxCandidates ? LightKnowledge::kListed : LightKnowledge::kUnknown;
}

LightArrival LightCertifier::ArrivalOf(int object, const PatchHull& hull, int light) const {
  Bundle bundle(object, hull);
  bundle.Aim(light, scene_.lights[static_cast<size_t>(light)], world_);
  Findings findings;
  FindCandidates(bundle, LightList(), findings);
  LightArrival arrival{Decide(bundle, findings)};
  if (arrival.knowledge != LightKnowledge::kListed) return arrival;
  for (const int32_t candidate : findings.kept) {
    const int crossings = CrossingsOfAll(bundle, candidate);
    if (crossings == 0) return arrival;
    const Rgb& transmit = scene_.MaterialOf(candidate).transmit;
    for (int i = 0; i < crossings; ++i) arrival.filter = arrival.filter * transmit;
  }
  arrival.knowledge = LightKnowledge::kOn;
  return arrival;
}

namespace {

// Functions are divided this many times less one before they are built anew.
constexpr int kQuarterings = 4;
static_assert(kQuarterings <= kMaxQuarterings);

// What a larger piece touches and a part of it may.
std::vector<Contact> ContactsOf(const PatchHull& hull, const CellLights& parent) {
  std::vector<Contact> contacts;
  for (const Contact& contact : parent.contacts) {
    // Twice the clearance: the hull's points are rounded, as what lies in it is.
    if (HeightsOf(hull, contact.plane, 1).low > 2 * contact.clearance) continue;
    contacts.push_back(contact);
  }
  return contacts;
}

}  // namespace

void LightCertifier::CertifyLight(const Bundle& bundle, const LightList& inherited,
                                  Findings& findings) const {
  CellLights& cell = *findings.cell;
  LightList& list = cell.lights[static_cast<size_t>(bundle.light)];
  const size_t first_coefficient = cell.coefficients.size();
  FindCandidates(bundle, inherited, findings);
  list.knowledge = Decide(bundle, findings);
  list.occluder = findings.occluder;
  if (list.knowledge != LightKnowledge::kListed) {
    cell.coefficients.resize(first_coefficient);
    return;
  }
  cell.objects.insert(cell.objects.end(), findings.kept.begin(), findings.kept.end());
  if (findings.plane == nullptr) return;
  for (const int32_t object : findings.kept) {
    const ShadowFunction* function = findings.FunctionOf(object);
    cell.functions.push_back(function != nullptr ? *function : ShadowFunction{});
  }
}

CellLights LightCertifier::Certify(int object, const SurfaceChart& chart, int patch,
                                   const SurfaceCell& where, const CellLights* parent) const {
  CellLights cell;
  const PatchHull hull = chart.HullOf(patch, where);
  const auto plane = uses_functions_ ? chart.PlanarCellOf(patch, where) : std::nullopt;
  Bundle bundle(object, hull);
  Findings findings{&cell, plane ? &*plane : nullptr, parent};
  if (parent != nullptr) {
    cell.contacts = ContactsOf(hull, *parent);
    cell.objects.reserve(parent->objects.size());
    cell.functions.reserve(parent->functions.size());
    cell.coefficients.reserve(parent->coefficients.size());
    // Now and then they are built anew, which makes them as sharp as the cell is small.
    const bool divides = parent->HasFunctions() && where.depth % kQuarterings != 0;
    if (divides) findings.child = where.ChildAt(where.depth - 1);
  }
  const size_t count = scene_.lights.size();
  cell.lights.resize(count);
  std::vector<size_t> begins(count);
  const bool has_back = IsSolid(scene_.objects[static_cast<size_t>(object)].shape) &&
                        IsBlack(scene_.MaterialOf(object).transmit);
  for (size_t i = 0; i < count; ++i) {
    const Light& light = scene_.lights[i];
    const LightList inherited = parent != nullptr ? parent->lights[i] : LightList{};
    begins[i] = cell.objects.size();
    if (inherited.IsDecided()) {
      cell.lights[i] = inherited;
      cell.lights[i].summed = false;
    } else if (has_back && chart.FacesAway(patch, hull, light)) {
      cell.lights[i].knowledge = LightKnowledge::kFacingAway;
    } else {
      bundle.Aim(static_cast<int>(i), light, world_);
      CertifyLight(bundle, inherited, findings);
    }
  }
  Finish(begins, cell);
  return cell;
}

// The vectors stay where they are from here on: moves of the cell take them along.
void LightCertifier::Finish(const std::vector<size_t>& begins, CellLights& cell) {
  cell.contacts.shrink_to_fit();
  cell.objects.shrink_to_fit();
  cell.functions.shrink_to_fit();
  cell.coefficients.shrink_to_fit();
  cell.is_decided = std::all_of(cell.lights.begin(), cell.lights.end(),
                                [](const LightList& list) { return list.IsDecided(); });
  cell.shadows = {cell.objects.data(), cell.functions.data(), cell.coefficients.data()};
  for (size_t i = 0; i < cell.lights.size(); ++i) {
    if (cell.lights[i].knowledge != LightKnowledge::kListed) continue;
    const size_t end = i + 1 < begins.size() ? begins[i + 1] : cell.objects.size();
    cell.lights[i].candidates =
        std::span<const int32_t>(cell.objects).subspan(begins[i], end - begins[i]);
  }
}

}  // namespace linetree
