#include "core/certify/diffuse_summer.h"

#include <algorithm>
#include <cmath>

#include "core/certify/curved_screen.h"
#include "core/certify/curved_terms.h"
#include "core/certify/fading.h"
#include "core/certify/plane_nodes.h"
#include "core/trace/intersect.h"
#include "core/trace/shade.h"

namespace linetree {
namespace {

constexpr double kLeastNode = 0x1p-100, kMostNode = 0x1p100;
constexpr double kLebesgue = 1.64;
// Cosine to the plane's normal: shading normals that lean more may lie on its other side at hits,
// whose weights are negative by as little as hits lie beyond an edge.
constexpr double kLeastLean = 0x1p-10;

double PowerOf(double x, int n) {
  double product = 1;
  for (int i = 0; i < n; ++i) product *= x;
  return product;
}

// SumBounds on a sum of diffuse terms, channel by channel.
struct SumBounds {
  Rgb error, least, most;

  // The relative error, rounding of the nodes included; infinite where nothing is known.
  double Spread() const {
    double spread = 0;
    for (int c = 0; c < 3; ++c) {
      if (most[c] == 0 && error[c] == 0) continue;
      // Nodes must be ordinary floats.
      const bool is_ordinary = least[c] >= kLeastNode && most[c] + error[c] <= kMostNode;
      if (!is_ordinary) return Box3::kInf;
      const double absolute = error[c] + kNodeRounding * (most[c] + error[c]);
      if (!(absolute / least[c] <= spread)) spread = absolute / least[c];
    }
    return spread * (1 + kLengthMargin);
  }
};

// Unit; of a planar patch, as the tracer has it.
Vec3d OutwardNormalOf(const Shape& shape, int patch) {
  const int face = std::holds_alternative<FrustumShape>(shape) ? patch - 4 + 1 : patch;
  return std::visit([&](const auto& s) { return Normalized(OutwardNormal(s, face, Vec3d{})); },
                    shape);
}

// By which the vertex normals have to be turned to lie on the side that the plane's normal points
// to; 0 where they lie on both.
double TurnOf(const TriangleShape& triangle, const Vec3d& normal) {
  double turn = 0;
  for (const Vec3d& n : triangle.normals) {
    const double cosine = Dot(Normalized(n), normal);
    // Also of what is not a number.
    if (!(std::abs(cosine) > kLeastLean)) return 0;
    const double sign = cosine > 0 ? 1 : -1;
    if (turn != 0 && sign != turn) return 0;
    turn = sign;
  }
  return turn;
}

std::array<float, 3> ToNode(const Rgb& sum) {
  return {static_cast<float>(sum.r), static_cast<float>(sum.g), static_cast<float>(sum.b)};
}

}  // namespace

namespace {

void FindSummable(const CellLights& lights, std::vector<size_t>& summable) {
  // Nobody can predict which lights are on, so all are written, and those are counted.
  summable.resize(lights.lights.size());
  size_t count = 0;
  for (size_t i = 0; i < lights.lights.size(); ++i) {
    summable[count] = i;
    count += lights.lights[i].knowledge == LightKnowledge::kOn ? 1 : 0;
  }
  summable.resize(count);
}

}  // namespace

void DiffuseSummer::AddSums(int object, const SurfaceChart& chart, int patch,
                            const SurfaceCell& cell, CellLights& lights) const {
  if (IsBlack(scene_.MaterialOf(object).diffuse)) return;
  // Room that the cells of this thread use one after the other.
  thread_local std::vector<size_t> summable;
  FindSummable(lights, summable);
  if (summable.size() < static_cast<size_t>(kMinSummedLights)) return;
  const size_t count = summable.size();
  const Object& receiver = scene_.objects[static_cast<size_t>(object)];
  if (const auto plane = chart.PlanarCellOf(patch, cell)) {
    if (const auto* triangle = std::get_if<TriangleShape>(&receiver.shape)) {
      const double turn = TurnOf(*triangle, plane->normal);
      if (turn == 0) return;
      lights.sums = {SumOnSmooth(receiver, *plane, turn, summable),
                     SumOnSmooth(receiver, *plane, -turn, summable)};
    } else if (chart.IsThin()) {
      // The chart's own may differ from the tracer's by more than rounding, where it has been
      // computed from edges at a small angle.
      const Vec3d own = OutwardNormalOf(receiver.shape, patch);
      const Vec3d normal = Dot(own, plane->normal) < 0 ? -own : own;
      lights.sums = {SumOnPlane(*plane, normal, summable), SumOnPlane(*plane, -normal, summable)};
    } else {
      lights.sums[0] = SumOnPlane(*plane, OutwardNormalOf(receiver.shape, patch), summable);
    }
  } else {
    lights.sums[0] = SumOnCurve(receiver, chart.Slack(), patch, cell, summable);
  }
  lights.unsummed = static_cast<uint32_t>(count - summable.size());
  if (!lights.sums[0] && !lights.sums[1]) return;
  for (const size_t i : summable) lights.lights[i].summed = true;
}

namespace {

double SumOfSizes(const Vec3d& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); }

PlaneView ViewOf(const SurfaceChart::PlanarCell& cell, const Vec3d& normal) {
  PlaneView view;
  view.normal = normal;
  view.center = cell.corner + (cell.eu + cell.ev) * 0.5;
  view.radius = std::max(Length(cell.eu + cell.ev), Length(cell.eu - cell.ev)) / 2;
  view.reach = SumOfSizes(view.center) + view.radius;
  // A hit's distance from the cell's own point, cell.pad at most, goes into the height of a light
  // and into how far away it is, which is no nearer than that height.
  view.slip = 2 * cell.pad;
  view.stretch =
      (PowerOf(Length(cell.eu), 4) + kLebesgue * PowerOf(Length(cell.ev), 4)) / (24 * 81);
  return view;
}

NodePlaces NodePlacesOf(const SurfaceChart::PlanarCell& cell) {
  NodePlaces places;
  for (size_t k = 0; k < kPlaneNodes; ++k) {
    const Vec3d place = cell.corner + cell.eu * (static_cast<double>(k % 4) / 3) +
                        cell.ev * (static_cast<double>(k / 4) / 3);
    places.x[k] = place.x;
    places.y[k] = place.y;
    places.z[k] = place.z;
  }
  return places;
}

// The sum over one side of a planar cell, as it grows.
class PlaneTerms {
 public:
  // `points` is room for the lamps that do not fade.
  PlaneTerms(const SurfaceChart::PlanarCell& cell, const Vec3d& normal, NodeLights& points)
      : view_(ViewOf(cell, normal)), places_(NodePlacesOf(cell)), points_(points) {}

  // Takes those of the lights that are good enough, and those out of the list that are not and may
  // face the side.
  void Take(const Scene& scene, DiffuseSummer::Lanes lanes, std::vector<size_t>& lights) {
    points_.Assign(scene.lights, lights);
    const size_t plain = points_.size;
    TermSums sums;
    if (lanes == DiffuseSummer::Lanes::kSimd) {
      TakeLights(view_, points_, sums);
    } else {
      TakeLightsScalar(view_, points_, sums);
    }
    bounds_ = {sums.error.Sum(), sums.least.Sum(), sums.most.Sum()};
    count_ = points_.size;
    if (plain == lights.size() && points_.AreSettled(plain)) return;
    size_t next = 0;
    std::erase_if(lights, [&](size_t i) {
      const Light& light = scene.lights[i];
      const Taken taken = NodeLights::IsPlain(light) ? PointTaken(next++) : AddOther(light);
      return taken == Taken::kNo;
    });
  }
  size_t count() const { return count_; }
  const SumBounds& bounds() const { return bounds_; }

  // The nodes of all terms that were taken.
  std::array<Rgb, kPlaneNodes> Nodes(DiffuseSummer::Lanes lanes) const {
    NodeSums sums;
    if (lanes == DiffuseSummer::Lanes::kSimd) {
      AddPointLights(places_, points_, sums);
    } else {
      AddPointLightsScalar(places_, points_, sums);
    }
    std::array<Rgb, kPlaneNodes> nodes;
    for (size_t k = 0; k < kPlaneNodes; ++k) {
      nodes[k] = Rgb{sums.r[k], sums.g[k], sums.b[k]} + everywhere_;
      const Vec3d place{places_.x[k], places_.y[k], places_.z[k]};
      for (const FadingLight& fading : fading_) {
        const double distance = Length(fading.light->position - place);
        nodes[k] += Scaled(fading.strength, FallOff(*fading.light, distance) / distance);
      }
    }
    return nodes;
  }

 private:
  enum class Taken { kYes, kNo, kBehind };

  Taken PointTaken(size_t i) const {
    const size_t block = i / NodeLights::kBlock, lane = i % NodeLights::kBlock;
    if ((points_.taken[block] >> lane & 1) != 0) return Taken::kYes;
    return (points_.behind[block] >> lane & 1) != 0 ? Taken::kBehind : Taken::kNo;
  }

  // Adds a light's term, if it is good enough, to the bounds, and keeps it for the nodes.
  Taken AddOther(const Light& light) {
    const Taken taken =
        light.kind == LightKind::kDirectional ? AddDirectional(light) : AddFading(light);
    count_ += taken == Taken::kYes ? 1 : 0;
    return taken;
  }
  Taken AddDirectional(const Light& light) {
    const double cosine = Dot(view_.normal, light.to_light);
    if (!(cosine > 0)) return Taken::kBehind;
    const Rgb term = Scaled(light.irradiance, cosine);
    everywhere_ += term;
    bounds_.least += Scaled(term, 1 - kLengthMargin);
    bounds_.most += term;
    return Taken::kYes;
  }
  Taken AddFading(const Light& light) {
    const LightReach reach = ReachOf(view_, light.position);
    if (reach.side == LightReach::Side::kBehind) return Taken::kBehind;
    if (reach.side == LightReach::Side::kUnknown) return Taken::kNo;
    const FadingBound fading = BoundFading(light, reach.nearest, reach.farthest);
    // Of the height, once, and of the distance; what both do together is less than what is allowed
    // for the distance twice.
    const double error =
        view_.stretch * fading.fourth + reach.noise * (1 + fading.slope) * fading.most;
    if (!(error <= kMaxTermSpread * fading.least)) return Taken::kNo;
    const Rgb strength = Scaled(light.irradiance, reach.height);
    bounds_.error += Scaled(strength, error);
    bounds_.least += Scaled(strength, fading.least);
    bounds_.most += Scaled(strength, fading.most);
    fading_.push_back({&light, strength});
    return Taken::kYes;
  }

  const PlaneView view_;
  const NodePlaces places_;
  SumBounds bounds_;
  size_t count_ = 0;
  NodeLights& points_;
  struct FadingLight {
    const Light* light;
    Rgb strength;
  };
  std::vector<FadingLight> fading_;
  Rgb everywhere_;  // of directional lights
};

// A sum of so many lights, if it is one.
std::unique_ptr<const DiffuseSum> Finished(int node_count, size_t count, const Rgb* nodes,
                                           const SumBounds& bounds) {
  if (count < static_cast<size_t>(kMinSummedLights)) return nullptr;
  auto sum = std::make_unique<DiffuseSum>();
  sum->nodes = node_count;
  sum->spread = bounds.Spread();
  if (!std::isfinite(sum->spread)) return nullptr;
  std::transform(nodes, nodes + node_count * node_count, sum->value.begin(), ToNode);
  return sum;
}

}  // namespace

DiffuseSummer::MaybeSum DiffuseSummer::SumOnPlane(const SurfaceChart::PlanarCell& cell,
                                                  const Vec3d& normal,
                                                  std::vector<size_t>& lights) const {
  // Room that the sums of this thread use one after the other.
  thread_local NodeLights points;
  PlaneTerms terms(cell, normal, points);
  terms.Take(scene_, lanes_, lights);
  if (terms.count() < static_cast<size_t>(kMinSummedLights)) return nullptr;
  return Finished(4, terms.count(), terms.Nodes(lanes_).data(), terms.bounds());
}

DiffuseSummer::MaybeSum DiffuseSummer::SumOnCurve(const Object& receiver, double slip, int patch,
                                                  const SurfaceCell& cell,
                                                  std::vector<size_t>& lights) const {
  const CurvedScreen screen(receiver.shape, patch, cell);
  if (screen.HasApex()) return nullptr;
  std::erase_if(lights,
                [&](size_t i) { return !screen.MayBeLinear(scene_.lights[i], kMaxTermSpread); });
  if (lights.empty()) return nullptr;
  const JetShape shape = MakeJetShape(receiver);
  return SumOfTerms({scene_, shape, patch, cell, slip, lights}, lights);
}

DiffuseSummer::MaybeSum DiffuseSummer::SumOnSmooth(const Object& receiver,
                                                   const SurfaceChart::PlanarCell& plane,
                                                   double turn, std::vector<size_t>& lights) const {
  const CurvedScreen screen(std::get<TriangleShape>(receiver.shape), plane, turn);
  std::erase_if(lights,
                [&](size_t i) { return !screen.MayBeLinear(scene_.lights[i], kMaxTermSpread); });
  if (lights.empty()) return nullptr;
  const JetShape shape = MakeJetShape(receiver);
  const SurfaceCell unused;
  return SumOfTerms({scene_, shape, 0, unused, plane.pad, lights, &plane, turn}, lights);
}

// The task's lights are those.
DiffuseSummer::MaybeSum DiffuseSummer::SumOfTerms(const CurvedTask& task,
                                                  std::vector<size_t>& lights) const {
  std::vector<CurvedTerm> terms(lights.size());
  const bool is_valid = lanes_ == Lanes::kSimd ? FindCurvedTermsSimd(task, terms.data())
                                               : FindCurvedTermsScalar(task, terms.data());
  if (!is_valid) return nullptr;
  std::array<Rgb, 4> nodes{};
  SumBounds bounds;
  size_t count = 0, next = 0;
  std::erase_if(lights, [&](size_t i) {
    const Light& light = scene_.lights[i];
    const CurvedTerm& term = terms[next++];
    if (!term.is_known || !(term.error <= kMaxTermSpread * term.least)) return true;
    bounds.error += Scaled(light.irradiance, term.error);
    bounds.least += Scaled(light.irradiance, term.least);
    bounds.most += Scaled(light.irradiance, term.most);
    for (size_t k = 0; k < 4; ++k) nodes[k] += Scaled(light.irradiance, term.corners[k]);
    count += term.most > 0 ? 1 : 0;
    return false;
  });
  return Finished(2, count, nodes.data(), bounds);
}

}  // namespace linetree
