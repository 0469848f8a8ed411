#include "core/tree/light_certifier.h"

#include <algorithm>

#include "core/tree/light_bundle.h"
#include "core/tree/separation.h"
#include "core/tree/shadow_builder.h"
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

// Whether a function leaves it open that the light is hidden everywhere. Linear ones have said so.
bool MayHideAll(const ShadowFunction& function, const float* coefficients) {
  if (function.squares == 0) return false;
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
bool LightCertifier::LiesBehind(LightBundle& bundle, int object, LightFindings& findings) const {
  const FacePlanes& planes = planes_[static_cast<size_t>(object)];
  const double clearance = ClearanceTo(bundle, object);
  for (size_t i = 0; i < planes.faces.size(); ++i) {
    const Plane& face = planes.faces[i];
    double height = bundle.IsPoint() ? SignedDistance(face, bundle.source->position)
                                     : Dot(face.normal, bundle.source->to_light);
    const bool is_turned = planes.is_planar && height < 0;
    if (is_turned) height = -height;
    if (!(height > (bundle.IsPoint() ? clearance : kClearance))) continue;
    const Heights above = findings.views.HeightsAbove(object, planes, i);
    const double low = is_turned ? -above.high : above.low;
    const double high = is_turned ? -above.low : above.high;
    if (low > clearance) return true;
    const bool touches = clearance - low <= high * kMaxSliver;
    const Vec3d normal = is_turned ? -face.normal : face.normal;
    if (touches && findings.is_cell &&
        AddContact({{normal, face.point}, clearance}, findings.contacts)) {
      return true;
    }
  }
  return false;
}

// Above the rounding of a distance between anything in the bundle and a face of the object.
double LightCertifier::ClearanceTo(LightBundle& bundle, int object) const {
  return bundle.Clearance() + clearances_[static_cast<size_t>(object)];
}

// An object has a function only where it is opaque: how often rays cross it is not asked then.
Shadowing LightCertifier::ShadowOf(LightBundle& bundle, int object, LightFindings& findings,
                                   ShadowFunction& function) const {
  constexpr auto kNothing = Shadowing::kUnknown;
  if (findings.plane == nullptr || !IsBlack(scene_.MaterialOf(object).transmit)) return kNothing;
  const Shape& shape = scene_.objects[static_cast<size_t>(object)].shape;
  const FacePlanes& planes = planes_[static_cast<size_t>(object)];
  const double clearance = ClearanceTo(bundle, object) * (kFunctionClearance / kClearance);
  if (ShadowBuilder::MustBeOutside(shape)) {
    bool is_outside = false;
    for (size_t i = 0; i < planes.faces.size() && !is_outside; ++i) {
      is_outside = findings.views.HeightsAbove(object, planes, i).low > clearance;
    }
    if (!is_outside && !findings.views.IsApart(object, shape, clearance)) return kNothing;
  }
  return ShadowBuilder(*findings.plane, *bundle.source)
      .Build(shape, planes, clearance, findings.coefficients, function);
}

bool LightCertifier::MayBlock(LightBundle& bundle, int object, LightFindings& findings,
                              ShadowFunction& function) const {
  // Rays that leave its outside cannot meet it; for the others the tracer looks at it itself.
  if (object == bundle.self) return false;
  if (findings.occluder != kNoObject || LiesBehind(bundle, object, findings)) return false;
  const Shadowing everywhere = ShadowOf(bundle, object, findings, function);
  bool keep = false;
  if (findings.Take(object, everywhere, function, keep)) {
    findings.may_hide_all = findings.may_hide_all || keep;
    return keep;
  }
  findings.may_hide_all = true;
  // One ray of the bundle that meets it says quickly that nothing separates them.
  if (tracer_.ObjectBlocks(object, bundle.middle, bundle.light, {bundle.self, 0, Side::kOutside})) {
    return true;
  }
  const Shape& shape = scene_.objects[static_cast<size_t>(object)].shape;
  const double clearance = bundle.Clearance() + search_.Surplus(object);
  if (bundle.IsPoint()) {
    return !findings.views.IsBundleApart(object, shape, bundle.points, clearance);
  }
  return !CertainlyApart(bundle.hull.points, bundle.source->to_light, shape, clearance);
}

// What a part of the parent's cell keeps of one candidate: its function where it has one.
bool LightCertifier::KeepsMeeting(LightBundle& bundle, size_t index, LightFindings& findings,
                                  ShadowFunction& function) const {
  const CellLights& parent = *findings.parent;
  const int32_t object = parent.objects[index];
  if (findings.occluder != kNoObject) return false;
  if (findings.child >= 0 && parent.functions[index].pieces > 0) {
    const size_t first_coefficient = findings.coefficients.size();
    const ShadowQuarters::Says says = findings.quarters.At(index, findings.coefficients, function);
    // What is settled is so for sharper functions, too.
    const bool is_settled = says.everywhere != Shadowing::kUnknown;
    bool keep = false;
    if ((is_settled || !findings.builds_anew) &&
        findings.Take(object, says.everywhere, function, keep)) {
      findings.may_hide_all = findings.may_hide_all || says.may_block_all;
      return keep;
    }
    findings.coefficients.resize(first_coefficient);
    function = {};
  }
  return MayBlock(bundle, object, findings, function);
}

// Ascending; one more than kMaxCandidates at most, which says that the list is too long.
void LightCertifier::FindCandidates(LightBundle& bundle, const LightList& inherited,
                                    LightFindings& findings) const {
  findings.BeginLight();
  if (inherited.knowledge != LightKnowledge::kListed) {
    const auto found =
        search_.InShaft(bundle.From(), bundle.To(), bundle.Clearance(), [&](int object) {
          ShadowFunction& function =
              findings.found_functions.emplace_back(object, ShadowFunction{}).second;
          const bool keep = MayBlock(bundle, object, findings, function);
          if (!keep) findings.found_functions.pop_back();
          return keep;
        });
    for (const int32_t object : found) findings.AddFound(object);
    return;
  }
  const auto first =
      static_cast<size_t>(inherited.candidates.data() - findings.parent->objects.data());
  for (size_t i = 0; i < inherited.candidates.size(); ++i) {
    ShadowFunction& function = findings.functions.emplace_back();
    if (KeepsMeeting(bundle, first + i, findings, function)) {
      findings.objects.push_back(inherited.candidates[i]);
    } else {
      findings.functions.pop_back();
    }
  }
}

bool LightCertifier::HidesAll(const LightBundle& bundle, int object) const {
  return IsBlack(scene_.MaterialOf(object).transmit) && IsCrossedByAll(bundle, object);
}

int LightCertifier::CrossingsOfAll(LightBundle& bundle, int object) const {
  const Shape& shape = scene_.objects[static_cast<size_t>(object)].shape;
  if (!IsCrossedByAll(bundle, object)) return 0;
  if (IsPlanar(shape)) return 1;
  // A point light is outside: IsCrossedByAll wants it away from the object's bounds.
  const double clearance = bundle.Clearance() + search_.Surplus(object);
  return CertainlyApart(bundle.hull.points, shape, clearance) ? 2 : 0;
}

bool LightCertifier::IsCrossedByAll(const LightBundle& bundle, int object) const {
  const Shape& shape = scene_.objects[static_cast<size_t>(object)].shape;
  // An open frustum is not convex: rays may pass through it lengthwise.
  if (const auto* frustum = std::get_if<FrustumShape>(&shape)) {
    if (frustum->open) return false;
  }
  if (bundle.IsPoint()) {
    const Vec3d& light = bundle.source->position;
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

LightKnowledge LightCertifier::Decide(const LightBundle& bundle, LightFindings& findings) const {
  if (findings.occluder != kNoObject) return LightKnowledge::kOff;
  const auto candidates = findings.Candidates();
  if (candidates.empty()) return LightKnowledge::kOn;
  for (size_t i = 0; findings.may_hide_all && i < candidates.size(); ++i) {
    const ShadowFunction& function = findings.functions[findings.first + i];
    const bool may_hide =
        function.pieces == 0 || MayHideAll(function, findings.coefficients.data());
    if (!may_hide || !HidesAll(bundle, candidates[i])) continue;
    findings.occluder = candidates[i];
    return LightKnowledge::kOff;
  }
  return candidates.size() <= kMaxCandidates ? LightKnowledge::kListed : LightKnowledge::kUnknown;
}

LightArrival LightCertifier::ArrivalOf(int object, const PatchHull& hull, int light) const {
  LightBundle bundle(object, hull, world_);
  bundle.Aim(light, scene_.lights[static_cast<size_t>(light)]);
  // Room that the lights of this thread use one after the other.
  thread_local LightFindings findings;
  findings.BeginHull(hull);
  FindCandidates(bundle, LightList(), findings);
  LightArrival arrival{Decide(bundle, findings)};
  if (arrival.knowledge != LightKnowledge::kListed) return arrival;
  for (const int32_t candidate : findings.Candidates()) {
    const int crossings = CrossingsOfAll(bundle, candidate);
    if (crossings == 0) return arrival;
    const Rgb& transmit = scene_.MaterialOf(candidate).transmit;
    for (int i = 0; i < crossings; ++i) arrival.filter = arrival.filter * transmit;
  }
  arrival.knowledge = LightKnowledge::kOn;
  return arrival;
}

namespace {

// Functions are divided this many times at most before they are built anew.
constexpr int kQuarterings = 4;
static_assert(kQuarterings <= kMaxQuarterings);

// What a larger piece touches and a part of it may.
void AddContacts(const PatchHull& hull, const CellLights& parent, std::vector<Contact>& contacts) {
  for (const Contact& contact : parent.contacts) {
    // Twice the clearance: the hull's points are rounded, as what lies in it is.
    if (HeightsOf(hull, contact.plane).low > 2 * contact.clearance) continue;
    contacts.push_back(contact);
  }
}

// The vectors stay where they are from here on: moves of the cell take them along.
void Finish(const LightFindings& findings, CellLights& cell) {
  cell.contacts.assign(findings.contacts.begin(), findings.contacts.end());
  cell.objects.assign(findings.objects.begin(), findings.objects.end());
  if (findings.plane != nullptr) {
    cell.functions.assign(findings.functions.begin(), findings.functions.end());
  }
  cell.coefficients.assign(findings.coefficients.begin(), findings.coefficients.end());
  cell.shadows = {cell.objects.data(), cell.functions.data(), cell.coefficients.data()};
  size_t end = cell.objects.size();
  for (auto it = findings.listed.rbegin(); it != findings.listed.rend(); ++it) {
    cell.lights[it->light].candidates =
        std::span<const int32_t>(cell.objects).subspan(it->begin, end - it->begin);
    end = it->begin;
  }
  cell.Weigh();
}

}  // namespace

void LightCertifier::CertifyLight(LightBundle& bundle, LightList& list,
                                  LightFindings& findings) const {
  FindCandidates(bundle, list, findings);
  list.knowledge = Decide(bundle, findings);
  list.occluder = findings.occluder;
  list.candidates = {};
  if (list.knowledge == LightKnowledge::kListed) {
    findings.listed.push_back({static_cast<size_t>(bundle.light), findings.first});
  } else {
    findings.DropLight();
  }
}

CellLights LightCertifier::Certify(int object, const SurfaceChart& chart, int patch,
                                   const SurfaceCell& where, const CellLights* parent) const {
  // Room that the cells of this thread use one after the other.
  thread_local LightFindings findings;
  const PatchHull hull = chart.HullOf(patch, where);
  const auto plane = uses_functions_ ? chart.PlanarCellOf(patch, where) : std::nullopt;
  LightBundle bundle(object, hull, world_);
  findings.BeginCell(hull, plane ? &*plane : nullptr, parent);
  CellLights cell;
  const size_t count = scene_.lights.size();
  if (parent == nullptr) {
    cell.lights.resize(count);
  } else {
    cell.lights = parent->lights;
    AddContacts(hull, *parent, findings.contacts);
    if (parent->HasFunctions()) {
      findings.child = where.ChildAt(where.depth - 1);
      findings.quarters.Begin(parent->functions, parent->coefficients, findings.child);
    }
    // Now and then, which makes them as sharp as the cell is small.
    findings.builds_anew = where.depth % kQuarterings == 0;
  }
  const bool has_back = IsSolid(scene_.objects[static_cast<size_t>(object)].shape) &&
                        IsBlack(scene_.MaterialOf(object).transmit);
  for (size_t i = 0; i < count; ++i) {
    LightList& list = cell.lights[i];  // as it is inherited
    list.summed = false;
    if (list.IsDecided()) continue;
    const Light& light = scene_.lights[i];
    if (has_back && chart.FacesAway(patch, hull, light)) {
      list.knowledge = LightKnowledge::kFacingAway;
      list.occluder = kNoObject;
      list.candidates = {};
      continue;
    }
    bundle.Aim(static_cast<int>(i), light);
    CertifyLight(bundle, list, findings);
  }
  Finish(findings, cell);
  return cell;
}

}  // namespace linetree
