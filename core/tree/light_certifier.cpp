#include "core/tree/light_certifier.h"

#include <algorithm>

#include "core/tree/separation.h"

namespace linetree {
namespace {

Box3 BoxOf(const PatchHull& hull) {
  Box3 box;
  for (const Vec3d& p : hull.points) box.Add(p);
  return box;
}

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

}  // namespace

// The shadow rays from one hull to one light.
struct LightCertifier::Bundle {
  Bundle(int self_object, int light_index, const PatchHull& patch, const Light& source,
         const Box3& world)
      : self(self_object), light(light_index), hull(patch), source_light(source) {
    std::copy(patch.points.begin(), patch.points.end(), points.begin());
    const Box3 from = BoxOf(patch);
    Box3 to;
    if (source.kind == LightKind::kPoint) {
      points[8] = source.position;
      to.Add(source.position);
    } else {
      // Far enough to pass everything in the world's box.
      const double reach = Length(world.Extent()) + Length(from.Center() - world.Center());
      for (const Vec3d& p : patch.points) to.Add(p + source.to_light * reach);
    }
    hull_box = from;
    shaft_from = from;
    shaft_to = to;
    Box3 all = from;
    all.Add(to);
    clearance = ClearanceOf(all);
  }

  int self;
  int light;
  const PatchHull& hull;
  const Light& source_light;
  std::array<Vec3d, 9> points;  // the hull and, for a point light, the light
  Box3 hull_box, shaft_from, shaft_to;
  double clearance;
};

LightCertifier::LightCertifier(const Tracer& tracer)
    : tracer_(tracer), scene_(tracer.scene()), world_(scene_.WorldBounds()), search_(tracer) {}

bool CellLights::IsDecided() const {
  return std::all_of(lights.begin(), lights.end(), [](const LightList& list) {
    return list.knowledge == LightKnowledge::kOn || list.knowledge == LightKnowledge::kOff;
  });
}

bool LightCertifier::MayBlock(const Bundle& bundle, int object) const {
  // Rays that leave its outside cannot meet it; for the others the tracer looks at it itself.
  if (object == bundle.self) return false;
  const Shape& shape = scene_.objects[static_cast<size_t>(object)].shape;
  const double clearance = bundle.clearance + search_.Surplus(object);
  if (bundle.source_light.kind == LightKind::kPoint) {
    return !CertainlyApart(bundle.points, shape, clearance);
  }
  return !CertainlyApart(bundle.hull.points, bundle.source_light.to_light, shape, clearance);
}

// Ascending; one more than kMaxCandidates at most, which says that the list is too long.
std::vector<int32_t> LightCertifier::Candidates(const Bundle& bundle,
                                                const LightList& inherited) const {
  const auto may_block = [&](int object) { return MayBlock(bundle, object); };
  if (inherited.knowledge == LightKnowledge::kListed) {
    return search_.Among(inherited.candidates, may_block);
  }
  return search_.InShaft(bundle.shaft_from, bundle.shaft_to, bundle.clearance, may_block);
}

bool LightCertifier::HidesAll(const Bundle& bundle, int object) const {
  if (!IsBlack(scene_.MaterialOf(object).transmit)) return false;
  const Shape& shape = scene_.objects[static_cast<size_t>(object)].shape;
  // An open frustum is not convex: rays may pass through it lengthwise.
  if (const auto* frustum = std::get_if<FrustumShape>(&shape)) {
    if (frustum->open) return false;
  }
  if (bundle.source_light.kind == LightKind::kPoint) {
    const Vec3d& light = bundle.source_light.position;
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

LightKnowledge LightCertifier::Decide(const Bundle& bundle, const std::vector<int32_t>& kept,
                                      int32_t& occluder) const {
  if (kept.empty()) return LightKnowledge::kOn;
  const auto hides = [&](int32_t candidate) { return HidesAll(bundle, candidate); };
  if (const auto it = std::find_if(kept.begin(), kept.end(), hides); it != kept.end()) {
    occluder = *it;
    return LightKnowledge::kOff;
  }
  return kept.size() <= kMaxCandidates ? LightKnowledge::kListed : LightKnowledge::kUnknown;
}

LightKnowledge LightCertifier::KnowledgeOf(int object, const PatchHull& hull, int light) const {
  const Bundle bundle(object, light, hull, scene_.lights[static_cast<size_t>(light)], world_);
  int32_t occluder = kNoObject;
  return Decide(bundle, Candidates(bundle, LightList()), occluder);
}

CellLights LightCertifier::Certify(int object, const PatchHull& hull,
                                   const CellLights* parent) const {
  CellLights cell;
  const size_t count = scene_.lights.size();
  cell.lights.resize(count);
  std::vector<size_t> begins(count);
  for (size_t i = 0; i < count; ++i) {
    LightList inherited;
    if (parent != nullptr) inherited = parent->lights[i];
    LightList& list = cell.lights[i];
    begins[i] = cell.objects.size();
    if (inherited.knowledge == LightKnowledge::kOn || inherited.knowledge == LightKnowledge::kOff) {
      list = inherited;
      list.summed = false;
      continue;
    }
    const Bundle bundle(object, static_cast<int>(i), hull, scene_.lights[i], world_);
    const std::vector<int32_t> kept = Candidates(bundle, inherited);
    list.knowledge = Decide(bundle, kept, list.occluder);
    if (list.knowledge == LightKnowledge::kListed) {
      cell.objects.insert(cell.objects.end(), kept.begin(), kept.end());
    }
  }
  cell.objects.shrink_to_fit();
  for (size_t i = 0; i < count; ++i) {
    if (cell.lights[i].knowledge != LightKnowledge::kListed) continue;
    const size_t end = i + 1 < count ? begins[i + 1] : cell.objects.size();
    cell.lights[i].candidates =
        std::span<const int32_t>(cell.objects).subspan(begins[i], end - begins[i]);
  }
  return cell;
}

}  // namespace linetree
