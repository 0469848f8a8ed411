// Radiance along a path: the recursion behind TracerOf::Radiance.
#include "absl/container/inlined_vector.h"
#include "core/math/check.h"
#include "core/trace/shade.h"
#include "core/trace/tracer.h"

namespace linetree {
namespace {

// One ray of a path.
template <class S>
struct Leg {
  Vec3<S> origin;
  Vec3<S> direction;  // unit
  RayStart start;
  Branch branch = Branch::kEye;
  int depth = 1;  // rays on the path up to this one
  double weight = 1;
  int parent = -1;                 // node of the ray tree
  const PathStep* step = nullptr;  // what is known of this ray
};

template <class S>
Leg<S> EyeLeg(const Vec3<S>& origin, const Vec3<S>& direction) {
  Leg<S> leg;
  leg.origin = origin;
  leg.direction = direction;
  return leg;
}

// How light comes through a surface.
template <class S>
struct Transmission {
  bool asked_for = false;  // some light may come this way: colour, depth and weight allow it
  bool leaves_denser_medium = false;
  std::optional<Vec3<S>> direction;  // nothing: total internal reflection
};

// More candidates of one light than this cost an allocation.
constexpr size_t kUsualCandidates = 24;

// kRecorded: whether `tree` is written. kListed: whether `lights` and `paths` are asked before the
// scene is searched.
template <class S, bool kRecorded, bool kListed = false>
class PathTracer {
 public:
  PathTracer(const TracerOf<S>& tracer, const PathLimits& limits, RayCounts& counts, RayTree* tree,
             const LightLists* lights = nullptr, const PathLists* paths = nullptr)
      : tracer_(tracer),
        scene_(tracer.scene()),
        limits_(limits),
        counts_(counts),
        tree_(tree),
        lights_(lights),
        paths_(paths) {}

  RgbOf<S> Follow(const Leg<S>& leg) {
    if constexpr (kListed) {
      if (leg.step != nullptr && leg.step->listed) {
        ++counts_.listed_branches;
        return Answer(leg, tracer_.IntersectAmong(leg.step->candidates, leg.origin, leg.direction,
                                                  leg.start));
      }
      if (const HitOf<S> far_side = FarSide(leg); far_side.IsHit()) {
        ++counts_.listed_branches;
        return Answer(leg, far_side);
      }
    }
    ++counts_.intersect;
    return Answer(leg, tracer_.Intersect(leg.origin, leg.direction, leg.start));
  }

  RgbOf<S> Answer(const Leg<S>& leg, const HitOf<S>& hit) {
    if (hit.IsHit()) return Surface(leg, hit);
    if constexpr (kRecorded) Record(leg, NodeKind::kBackground);
    return Scaled(scene_.background, S(1));
  }

 private:
  RgbOf<S> Surface(const Leg<S>& leg, const HitOf<S>& hit) {
    ++counts_.shade;
    const Material& material = scene_.MaterialOf(hit.object);
    const Transmission<S> transmission = TransmissionAt(leg, hit, material);
    const bool total_reflection = transmission.asked_for && !transmission.direction;
    int node = -1;
    if constexpr (kRecorded) {
      node = RecordSurface(leg, hit);
      NodeAt(node).total_reflection = total_reflection;
      NodeAt(node).leaves_denser_medium = transmission.leaves_denser_medium;
    }
    RgbOf<S> radiance = AmbientTerm<S>(material, scene_.ambient);
    AddLights(leg, hit, material, node, radiance);
    const bool reflects = Allows(leg, material.reflect);
    const PathStep* step = nullptr;
    if constexpr (kListed) {
      if (reflects || transmission.asked_for) step = StepAt(leg, hit);
    }
    if (total_reflection) {
      radiance += Child(ReflectedLeg(leg, hit, leg.weight, node, step));
      return radiance;
    }
    if (reflects) {
      const double weight = leg.weight * MaxChannel(material.reflect);
      radiance += material.reflect * Child(ReflectedLeg(leg, hit, weight, node, step));
    } else if (kRecorded && !IsBlack(material.reflect)) {
      RecordCutOff(Branch::kReflected, hit, node);
    }
    if (transmission.asked_for) {
      radiance += material.transmit *
                  Child(TransmittedLeg(leg, hit, material, *transmission.direction, node, step));
    } else if (kRecorded && !IsBlack(material.transmit)) {
      RecordCutOff(Branch::kTransmitted, hit, node);
    }
    return radiance;
  }

  // Where a ray that starts inside a solid leaves it, if it certainly meets nothing before: between
  // two points of the solid's room it does not leave the room. Rounding may take either out of it,
  // or let the ray miss the far side; what such rays meet is anywhere.
  HitOf<S> FarSide(const Leg<S>& leg) const {
    if (paths_ == nullptr || leg.start.side != Side::kInside) return {};
    const SolidInterior* solid = paths_->Inside(leg.start.object);
    if (solid == nullptr || !solid->room.Contains(leg.origin)) return {};
    const HitOf<S> hit =
        tracer_.IntersectAmong(solid->candidates, leg.origin, leg.direction, leg.start);
    const bool leaves = hit.object == leg.start.object && solid->room.Contains(hit.point);
    return leaves ? hit : HitOf<S>();
  }

  // The step whose rays end at this hit: the one that led here if it knows how to go on, or else
  // one of the object's own linetree.
  const PathStep* StepAt(const Leg<S>& leg, const HitOf<S>& hit) const {
    const PathStep* step = leg.step;
    if (step != nullptr && step->EndsAt(hit) && (step->reflected != 0 || step->transmitted != 0)) {
      return step;
    }
    step = paths_ != nullptr ? paths_->Find(hit, leg.direction) : nullptr;
    return step != nullptr && step->EndsAt(hit) ? step : nullptr;
  }

  // Whether a branch with coefficient k is cast.
  bool Allows(const Leg<S>& leg, const Rgb& k) const {
    return limits_.Allow(leg.depth, leg.weight, k);
  }

  RgbOf<S> Child(const Leg<S>& leg) {
    ++(leg.branch == Branch::kReflected ? counts_.reflected : counts_.refracted);
    return Follow(leg);
  }

  // Surfaces that are not solid let light pass straight on.
  Transmission<S> TransmissionAt(const Leg<S>& leg, const HitOf<S>& hit,
                                 const Material& material) const {
    Transmission<S> transmission;
    transmission.asked_for = Allows(leg, material.transmit);
    if (!transmission.asked_for) return transmission;
    if (!IsSolid(ShapeOf(hit.object))) {
      transmission.direction = leg.direction;
      return transmission;
    }
    const double around = tracer_.media().IorAround(scene_, hit.object, hit.point);
    const bool entering = hit.side == Side::kOutside;
    const double from = entering ? around : material.ior;
    const double into = entering ? material.ior : around;
    transmission.leaves_denser_medium = from > into;
    transmission.direction = Refracted(leg.direction, hit.normal, from, into);
    return transmission;
  }

  Leg<S> ReflectedLeg(const Leg<S>& leg, const HitOf<S>& hit, double weight, int node,
                      const PathStep* step) const {
    return {hit.point,
            Reflected(leg.direction, hit.normal),
            {hit.object, hit.face, hit.side},
            Branch::kReflected,
            leg.depth + 1,
            weight,
            node,
            step != nullptr && step->reflected != 0 ? step + step->reflected : nullptr};
  }

  Leg<S> TransmittedLeg(const Leg<S>& leg, const HitOf<S>& hit, const Material& material,
                        const Vec3<S>& direction, int node, const PathStep* step) const {
    const bool into_inside = hit.side == Side::kOutside && !IsPlanar(ShapeOf(hit.object));
    const Side side = into_inside ? Side::kInside : Side::kOutside;
    return {hit.point,
            direction,
            {hit.object, hit.face, side},
            Branch::kTransmitted,
            leg.depth + 1,
            leg.weight * MaxChannel(material.transmit),
            node,
            step != nullptr && step->transmitted != 0 ? step + step->transmitted : nullptr};
  }

  void AddLights(const Leg<S>& leg, const HitOf<S>& hit, const Material& material, int node,
                 RgbOf<S>& radiance) {
    if (!UsesLights(material)) return;
    const RayStart start{hit.object, hit.face, hit.side};
    KnownLights known;
    if constexpr (kListed) {
      known = lights_->Find(hit);
      if (known.has_diffuse) {
        ++counts_.summed;
        radiance += material.diffuse * known.diffuse;
      }
    }
    for (size_t i = 0; i < scene_.lights.size(); ++i) {
      const Light& light = scene_.lights[i];
      if (kListed && known.has_diffuse && known.lists[i].summed) {
        if (!IsBlack(material.specular)) AddHighlight(leg, hit, material, light, radiance);
        continue;
      }
      const LightView<S> view = ViewOf(light, hit.point);
      const S cosine = Dot(hit.normal, view.to_light);
      LightTerm term{LightState::kFacingAway};
      if (cosine > 0) {
        const auto shadow = ShadowOf(known, known.lists == nullptr ? LightList{} : known.lists[i],
                                     hit.point, static_cast<int>(i), start);
        term = shadow.term;
        if (term.state == LightState::kLit) {
          radiance += shadow.filter * LightTermRadiance(material, light, view, cosine, hit.normal,
                                                        Vec3<S>(-leg.direction));
        }
      }
      if constexpr (kRecorded) {
        tree_->lights[static_cast<size_t>(NodeAt(node).first_light) + i] = term;
      }
    }
  }

  // Of a light that is certainly on.
  void AddHighlight(const Leg<S>& leg, const HitOf<S>& hit, const Material& material,
                    const Light& light, RgbOf<S>& radiance) const {
    const LightView<S> view = ViewOf(light, hit.point);
    if (!(Dot(hit.normal, view.to_light) > 0)) return;
    radiance += HighlightRadiance(material, light, view, hit.normal, Vec3<S>(-leg.direction));
  }

  using Shadow = typename TracerOf<S>::Shadow;
  Shadow ShadowOf(const KnownLights& cell, const LightList& known, const Vec3<S>& point, int light,
                  const RayStart& start) {
    ++counts_.shadow;
    if (!SparesSearch(known.knowledge)) {
      ++counts_.intersect;
      return tracer_.CastShadow(point, light, start);
    }
    ++counts_.listed;
    const bool self_matters = known.knowledge == LightKnowledge::kOn && start.side == Side::kInside;
    if (known.knowledge == LightKnowledge::kListed && cell.shadows != nullptr) {
      return ListedShadow(cell, known.candidates, point, light, start);
    }
    if (known.knowledge == LightKnowledge::kListed || self_matters) {
      return tracer_.CastShadowAmong(known.candidates, point, light, start);
    }
    Shadow shadow;
    if (known.knowledge == LightKnowledge::kOff) {
      shadow.term = {LightState::kBlocked, known.occluder};
      return shadow;
    }
    shadow.term.state = LightState::kLit;
    shadow.filter = {S(1), S(1), S(1)};
    return shadow;
  }

  // Asks the candidates' shadow functions first, and the candidates themselves where these are in
  // doubt.
  Shadow ListedShadow(const KnownLights& cell, std::span<const int32_t> candidates,
                      const Vec3<S>& point, int light, const RayStart& start) const {
    const auto first = candidates.data() - cell.shadows->objects;
    absl::InlinedVector<int32_t, kUsualCandidates> doubtful;
    for (size_t i = 0; i < candidates.size(); ++i) {
      const ShadowFunction& function = cell.shadows->functions[static_cast<size_t>(first) + i];
      const Shadowing shadowing = ShadowingAt(function, cell.shadows->coefficients, cell.s, cell.t);
      if (shadowing == Shadowing::kBlocks) {
        Shadow shadow;
        shadow.term = {LightState::kBlocked, candidates[i]};
        return shadow;
      }
      if (shadowing == Shadowing::kUnknown) doubtful.push_back(candidates[i]);
    }
    return tracer_.CastShadowAmong(doubtful, point, light, start);
  }

  const Shape& ShapeOf(int object) const {
    return scene_.objects[static_cast<size_t>(object)].shape;
  }

  RayTreeNode& NodeAt(int node) { return tree_->nodes[static_cast<size_t>(node)]; }

  int Record(const Leg<S>& leg, NodeKind kind) {
    RayTreeNode node;
    node.kind = kind;
    node.branch = leg.branch;
    node.parent = leg.parent;
    node.origin = CastVec3<double>(leg.origin);
    node.direction = CastVec3<double>(leg.direction);
    tree_->nodes.push_back(node);
    return static_cast<int>(tree_->nodes.size()) - 1;
  }

  int RecordSurface(const Leg<S>& leg, const HitOf<S>& hit) {
    const int index = Record(leg, NodeKind::kSurface);
    RayTreeNode& node = NodeAt(index);
    node.side = hit.side;
    node.object = hit.object;
    node.face = hit.face;
    node.point = CastVec3<double>(hit.point);
    node.normal = CastVec3<double>(hit.normal);
    node.first_light = static_cast<int32_t>(tree_->lights.size());
    tree_->lights.resize(tree_->lights.size() + scene_.lights.size());
    return index;
  }

  void RecordCutOff(Branch branch, const HitOf<S>& hit, int parent) {
    Leg<S> leg;
    leg.origin = hit.point;
    leg.branch = branch;
    leg.parent = parent;
    Record(leg, NodeKind::kCutOff);
  }

  const TracerOf<S>& tracer_;
  const Scene& scene_;
  const PathLimits& limits_;
  RayCounts& counts_;
  RayTree* tree_;
  const LightLists* lights_;
  const PathLists* paths_;
};

// Runs fn(path_tracer) with or without a record.
template <class S, class Fn>
RgbOf<S> Run(const TracerOf<S>& tracer, const PathLimits& limits, RayCounts& counts, RayTree* tree,
             Fn&& fn) {
  LT_CHECK(limits.max_depth >= 1 && limits.max_depth <= kMaxPathDepth);
  if (tree == nullptr) {
    PathTracer<S, false> path(tracer, limits, counts, nullptr);
    return fn(path);
  }
  tree->nodes.clear();
  tree->lights.clear();
  PathTracer<S, true> path(tracer, limits, counts, tree);
  const RgbOf<S> radiance = fn(path);
  for (int i = 0; i < 3; ++i) tree->radiance[i] = static_cast<double>(radiance[i]);
  return radiance;
}

}  // namespace

template <class S>
RgbOf<S> TracerOf<S>::Radiance(const Vec3<S>& origin, const Vec3<S>& direction,
                               const PathLimits& limits, RayCounts& counts, RayTree* tree) const {
  ++counts.eye;
  const Leg<S> leg = EyeLeg(origin, direction);
  return Run(*this, limits, counts, tree, [&](auto& path) { return path.Follow(leg); });
}

template <class S>
RgbOf<S> TracerOf<S>::RadianceFromHit(const HitOf<S>& hit, const Vec3<S>& origin,
                                      const Vec3<S>& direction, const PathLimits& limits,
                                      RayCounts& counts, RayTree* tree) const {
  const Leg<S> leg = EyeLeg(origin, direction);
  return Run(*this, limits, counts, tree, [&](auto& path) { return path.Answer(leg, hit); });
}

template <class S>
RgbOf<S> TracerOf<S>::RadianceFromHit(const HitOf<S>& hit, const Vec3<S>& origin,
                                      const Vec3<S>& direction, const PathLimits& limits,
                                      const LightLists& lights, const PathLists* paths,
                                      RayCounts& counts) const {
  static_assert(std::is_same_v<S, double>, "lists hold for the arithmetic of double");
  LT_CHECK(limits.max_depth >= 1 && limits.max_depth <= kMaxPathDepth);
  PathTracer<S, false, true> path(*this, limits, counts, nullptr, &lights, paths);
  return path.Answer(EyeLeg(origin, direction), hit);
}

template Rgb TracerOf<double>::RadianceFromHit(const Hit&, const Vec3d&, const Vec3d&,
                                               const PathLimits&, const LightLists&,
                                               const PathLists*, RayCounts&) const;

#define LINETREE_INSTANTIATE(S)                                                                   \
  template RgbOf<S> TracerOf<S>::Radiance(const Vec3<S>&, const Vec3<S>&, const PathLimits&,      \
                                          RayCounts&, RayTree*) const;                            \
  template RgbOf<S> TracerOf<S>::RadianceFromHit(const HitOf<S>&, const Vec3<S>&, const Vec3<S>&, \
                                                 const PathLimits&, RayCounts&, RayTree*) const;
LINETREE_INSTANTIATE(double)
LINETREE_INSTANTIATE(long double)
#undef LINETREE_INSTANTIATE

}  // namespace linetree
