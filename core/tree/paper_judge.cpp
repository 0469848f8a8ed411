#include "core/tree/paper_judge.h"

#include <algorithm>
#include <vector>

#include "core/tree/separable.h"
#include "core/tree/shaft.h"

namespace linetree {
namespace {

const RayTreeNode& Node(const Corners& corners, size_t corner, size_t node) {
  return corners[corner]->tree.nodes[node];
}
const LightTerm& Term(const RayTree& tree, const RayTreeNode& node, int light) {
  return tree.lights[static_cast<size_t>(node.first_light + light)];
}
RayStart ShadowStart(const RayTreeNode& node) { return {node.object, node.face, node.side}; }

// The self object is exempt from a shaft when no spawned ray of the bundle can meet it again.
bool CannotBlockItself(const RayTreeNode& node, const Scene& scene) {
  const Shape& shape = scene.objects[static_cast<size_t>(node.object)].shape;
  return node.side == Side::kOutside || IsPlanar(shape);
}

Verdict CompareLights(const RayTree& a, const RayTree& b) {
  for (size_t i = 0; i < a.lights.size(); ++i) {
    const LightTerm &x = a.lights[i], &y = b.lights[i];
    if (x.state != y.state) {
      const bool facing = x.state == LightState::kFacingAway || y.state == LightState::kFacingAway;
      return facing ? Verdict::kSelfShadow : Verdict::kBlocker;
    }
    if (x.state == LightState::kLit && x.crossings != y.crossings) return Verdict::kBlocker;
  }
  return Verdict::kCertified;
}

// (max + rise - min) / max(min, floor), the largest of three channels.
double SpreadOf(const Corners& corners, const Rgb& rise, double floor) {
  double spread = 0;
  for (int channel = 0; channel < 3; ++channel) {
    double lo = Box3::kInf, hi = -Box3::kInf;
    for (const auto& corner : corners) {
      lo = std::min(lo, corner->tree.radiance[channel]);
      hi = std::max(hi, corner->tree.radiance[channel]);
    }
    spread = std::max(spread, (hi + rise[channel] - lo) / std::max(lo, floor));
  }
  return spread + kStorageRounding;
}

Vec3d ToLight(const Light& light, const Vec3d& point) {
  return light.kind == LightKind::kPoint ? Normalized(light.position - point) : light.to_light;
}

}  // namespace

Verdict PaperJudge::Compare(const CornerSample& first, const CornerSample& other) const {
  if (!first.hits || !other.hits) return Verdict::kGap;
  const RayTree &a = first.tree, &b = other.tree;
  if (a.nodes.size() != b.nodes.size()) return Verdict::kGap;
  for (size_t i = 0; i < a.nodes.size(); ++i) {
    if (!SameLabel(a.nodes[i], b.nodes[i])) return Verdict::kGap;
  }
  return CompareLights(a, b);
}

Judgement PaperJudge::Decide(const Corners& corners) const {
  Judgement judgement;
  judgement.verdict = Verdict::kCertified;
  for (size_t i = 1; i < kCellCorners && judgement.verdict == Verdict::kCertified; ++i) {
    judgement.verdict = Compare(*corners[0], *corners[i]);
  }
  if (!corners[0]->hits) judgement.verdict = Verdict::kGap;
  if (judgement.verdict == Verdict::kCertified) judgement.verdict = FindFunnel(corners);
  if (judgement.verdict == Verdict::kCertified) judgement.verdict = FindBlocker(corners);
  if (judgement.verdict == Verdict::kCertified) judgement.verdict = FindPeak(corners);
  if (judgement.verdict != Verdict::kCertified) return judgement;
  const std::optional<Rgb> rise = DiffuseRise(corners);
  if (!rise) {
    judgement.verdict = Verdict::kPeak;
    return judgement;
  }
  judgement.spread = SpreadOf(corners, *rise, RadianceFloor(scene_));
  for (size_t m = 0; m < kCellCorners; ++m) {
    const Rgb& radiance = corners[m]->tree.radiance;
    for (int c = 0; c < 3; ++c) {
      judgement.interpolant.corner[m][static_cast<size_t>(c)] = static_cast<float>(radiance[c]);
    }
  }
  return judgement;
}

Verdict PaperJudge::FindFunnel(const Corners& corners) const {
  for (const auto& corner : corners) {
    for (const RayTreeNode& node : corner->tree.nodes) {
      if (node.leaves_denser_medium || node.total_reflection) return Verdict::kFunnel;
    }
  }
  return Verdict::kCertified;
}

Vec3d PaperJudge::FarPoint(const Vec3d& origin, const Vec3d& direction) const {
  // Past the far side of the sphere about the world's box, wherever the origin is.
  const double reach = Length(origin - world_.Center()) + Length(world_.Extent());
  return origin + direction * reach;
}

template <class F>
bool PaperJudge::ShaftHolds(const Box3& from, const Box3& to, int self, int target,
                            F is_harmless) const {
  const Shaft shaft(from, to);
  const auto blocks = [&](int object) {
    if (object == self || object == target) return false;
    if (shaft.Misses(scene_.objects[static_cast<size_t>(object)].bounds)) return false;
    return !is_harmless(object);
  };
  bool found = false;
  if (tracer_.bvh() == nullptr) {
    for (int k = 0; k < static_cast<int>(scene_.objects.size()) && !found; ++k) found = blocks(k);
    return found;
  }
  // Descending only into boxes that the shaft meets starts at the least common ancestor of all that
  // it touches: above it, every other child is missed.
  tracer_.bvh()->ForEachOverlap([&](const Box3& box) { return !shaft.Misses(box); },
                                [&](int object) {
                                  found = blocks(object);
                                  return !found;
                                });
  return found;
}

Verdict PaperJudge::FindBlocker(const Corners& corners) const {
  const RayTree& first = corners[0]->tree;
  for (size_t n = 0; n < first.nodes.size(); ++n) {
    const RayTreeNode& node = first.nodes[n];
    if (node.parent >= 0 && node.kind != NodeKind::kCutOff) {
      if (const Verdict v = BlockedBranch(corners, n); v != Verdict::kCertified) return v;
    }
    if (node.kind != NodeKind::kSurface) continue;
    for (int l = 0; l < static_cast<int>(scene_.lights.size()); ++l) {
      if (const Verdict v = BlockedLight(corners, n, l); v != Verdict::kCertified) return v;
    }
  }
  return Verdict::kCertified;
}

// The bundle of the rays that lead to node n from its parent.
Verdict PaperJudge::BlockedBranch(const Corners& corners, size_t n) const {
  Box3 from, to;
  for (size_t m = 0; m < kCellCorners; ++m) {
    const RayTreeNode& node = Node(corners, m, n);
    from.Add(node.origin);
    to.Add(node.kind == NodeKind::kSurface ? node.point : FarPoint(node.origin, node.direction));
  }
  const RayTreeNode& node = Node(corners, 0, n);
  const RayTreeNode& parent = Node(corners, 0, static_cast<size_t>(node.parent));
  const bool leaves_outside =
      (parent.side == Side::kOutside) != (node.branch == Branch::kTransmitted);
  const Shape& shape = scene_.objects[static_cast<size_t>(parent.object)].shape;
  const int self = leaves_outside || IsPlanar(shape) ? parent.object : kNoObject;
  const bool holds = ShaftHolds(from, to, self, node.object, [](int) { return false; });
  return holds ? Verdict::kBlocker : Verdict::kCertified;
}

// The bundle of the shadow rays from node n to one light.
Verdict PaperJudge::BlockedLight(const Corners& corners, size_t n, int light) const {
  const RayTree& tree = corners[0]->tree;
  const LightState state = Term(tree, tree.nodes[n], light).state;
  if (state == LightState::kBlocked) {
    return HaveCommonOccluder(corners, n, light) ? Verdict::kCertified : Verdict::kBlocker;
  }
  if (state != LightState::kLit) return Verdict::kCertified;
  const Light& source = scene_.lights[static_cast<size_t>(light)];
  Box3 from, to;
  for (size_t m = 0; m < kCellCorners; ++m) {
    const Vec3d& point = Node(corners, m, n).point;
    from.Add(point);
    to.Add(source.kind == LightKind::kPoint ? source.position : FarPoint(point, source.to_light));
  }
  const RayTreeNode& node = tree.nodes[n];
  const int self = CannotBlockItself(node, scene_) ? node.object : kNoObject;
  // A transparent object that every extremal ray crosses is crossed by all, by convexity; the
  // states already agree on how often.
  const bool holds = ShaftHolds(from, to, self, kNoObject,
                                [&](int object) { return AllCross(corners, n, light, object); });
  return holds ? Verdict::kBlocker : Verdict::kCertified;
}

bool PaperJudge::AllCross(const Corners& corners, size_t n, int light, int object) const {
  return std::all_of(corners.begin(), corners.end(), [&](const auto& corner) {
    const RayTreeNode& node = corner->tree.nodes[n];
    return tracer_.ObjectBlocks(object, node.point, light, ShadowStart(node));
  });
}

// Blocked everywhere inside if one convex object blocks all extremal rays.
bool PaperJudge::HaveCommonOccluder(const Corners& corners, size_t n, int light) const {
  std::vector<int> tried;
  for (const auto& corner : corners) {
    const int occluder = Term(corner->tree, corner->tree.nodes[n], light).occluder;
    if (std::find(tried.begin(), tried.end(), occluder) != tried.end()) continue;
    if (AllCross(corners, n, light, occluder)) return true;
    tried.push_back(occluder);
  }
  return false;
}

Verdict PaperJudge::FindPeak(const Corners& corners) const {
  const RayTree& first = corners[0]->tree;
  std::array<Vec3d, kCellCorners> views, mirrored;
  for (size_t n = 0; n < first.nodes.size(); ++n) {
    const RayTreeNode& node = first.nodes[n];
    if (node.kind != NodeKind::kSurface || IsBlack(scene_.MaterialOf(node.object).specular))
      continue;
    for (int l = 0; l < static_cast<int>(scene_.lights.size()); ++l) {
      if (Term(first, node, l).state != LightState::kLit) continue;
      const Light& light = scene_.lights[static_cast<size_t>(l)];
      for (size_t m = 0; m < kCellCorners; ++m) {
        const RayTreeNode& at = Node(corners, m, n);
        const Vec3d to_light = ToLight(light, at.point);
        views[m] = -at.direction;
        mirrored[m] = at.normal * (2 * Dot(at.normal, to_light)) - to_light;
      }
      if (!StrictlySeparable(views, mirrored)) return Verdict::kPeak;
    }
  }
  return Verdict::kCertified;
}

Rgb PaperJudge::WeightOf(const RayTree& tree, size_t n) const {
  Rgb weight{1, 1, 1};
  for (const RayTreeNode* node = &tree.nodes[n]; node->parent >= 0;) {
    const RayTreeNode& parent = tree.nodes[static_cast<size_t>(node->parent)];
    const Material& material = scene_.MaterialOf(parent.object);
    if (node->branch == Branch::kTransmitted) weight = weight * material.transmit;
    if (node->branch == Branch::kReflected && !parent.total_reflection) {
      weight = weight * material.reflect;
    }
    node = &parent;
  }
  return weight;
}

// The paper names this extremum, "(or N.L)", and tests for the highlight's alone; extremal values
// around the foot of a nearby light then agree while the middle is brighter.
std::optional<Rgb> PaperJudge::DiffuseRise(const Corners& corners) const {
  const RayTree& first = corners[0]->tree;
  Rgb rise;
  std::array<Vec3d, kCellCorners> normals, to_lights;
  for (size_t n = 0; n < first.nodes.size(); ++n) {
    const RayTreeNode& node = first.nodes[n];
    if (node.kind != NodeKind::kSurface) continue;
    const Rgb& diffuse = scene_.MaterialOf(node.object).diffuse;
    for (int l = 0; l < static_cast<int>(scene_.lights.size()) && !IsBlack(diffuse); ++l) {
      if (Term(first, node, l).state != LightState::kLit) continue;
      const Light& light = scene_.lights[static_cast<size_t>(l)];
      double largest = 0;
      for (size_t m = 0; m < kCellCorners; ++m) {
        normals[m] = Node(corners, m, n).normal;
        to_lights[m] = ToLight(light, Node(corners, m, n).point);
        largest = std::max(largest, Dot(normals[m], to_lights[m]));
      }
      if (StrictlySeparable(normals, to_lights)) continue;
      if (light.fade_distance > 0) return std::nullopt;
      rise += WeightOf(first, n) * diffuse * Scaled(light.irradiance, std::max(0.0, 1 - largest));
    }
  }
  return rise;
}

}  // namespace linetree
