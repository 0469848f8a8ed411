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
// Of the height of a light above a plane, relative to the coordinates it comes from: 6 u for the
// cell's middle, 1 for the segment, 3 for the product, and as many once more for the tracer's own,
// whose unit normal has 2.5; together 23 u, and 32 are allowed for. No sum shows them: lights are
// taken from a height of kLengthMargin on, where this is 2^-18, as much as kNodeRounding, and
// nearly all of that is allowance for sums in float.
constexpr double kHeightRounding = 0x1p-48;
// Cosine to the plane's normal: shading normals that lean more may lie on its other side at hits,
// whose weights are negative by as little as hits lie beyond an edge.
constexpr double kLeastLean = 0x1p-10;
// Distances are trusted to this.
constexpr double kLengthMargin = 0x1p-30;

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

std::vector<size_t> DiffuseSummer::Summable(const CellLights& lights) const {
  std::vector<size_t> summable;
  for (size_t i = 0; i < scene_.lights.size(); ++i) {
    if (lights.lights[i].knowledge == LightKnowledge::kOn) summable.push_back(i);
  }
  return summable;
}

void DiffuseSummer::AddSums(int object, const SurfaceChart& chart, int patch,
                            const SurfaceCell& cell, CellLights& lights) const {
  if (IsBlack(scene_.MaterialOf(object).diffuse)) return;
  std::vector<size_t> summable = Summable(lights);
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

// A cell of a plane, as lights in front of it see it.
class PlaneTerms {
 public:
  // `points` is room for the lamps that do not fade.
  PlaneTerms(const SurfaceChart::PlanarCell& cell, const Vec3d& normal,
             std::vector<NodeLight>& points)
      : normal_(normal),
        center_(cell.corner + (cell.eu + cell.ev) * 0.5),
        radius_(std::max(Length(cell.eu + cell.ev), Length(cell.eu - cell.ev)) / 2),
        reach_(SumOfSizes(center_) + radius_),
        slip_(2 * cell.pad),
        stretch_(PowerOf(Length(cell.eu), 4) + kLebesgue * PowerOf(Length(cell.ev), 4)),
        points_(points) {
    points_.clear();
    for (size_t k = 0; k < kPlaneNodes; ++k) {
      const Vec3d place = cell.corner + cell.eu * (static_cast<double>(k % 4) / 3) +
                          cell.ev * (static_cast<double>(k / 4) / 3);
      places_.x[k] = place.x;
      places_.y[k] = place.y;
      places_.z[k] = place.z;
    }
  }

  enum class Taken { kYes, kNo, kBehind };

  // Adds a light's term, if it is good enough, to the bounds, and keeps it for the nodes.
  Taken Add(const Light& light, SumBounds& bounds) {
    return light.kind == LightKind::kDirectional ? AddDirectional(light, bounds)
                                                 : AddPoint(light, bounds);
  }
  // The nodes of all terms that were taken.
  std::array<Rgb, kPlaneNodes> Nodes() const {
    NodeSums sums;
    AddPointLights(places_, points_, sums);
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
  Taken AddDirectional(const Light& light, SumBounds& bounds) {
    const double cosine = Dot(normal_, light.to_light);
    if (!(cosine > 0)) return Taken::kBehind;
    const Rgb term = Scaled(light.irradiance, cosine);
    everywhere_ += term;
    bounds.least += Scaled(term, 1 - kLengthMargin);
    bounds.most += term;
    return Taken::kYes;
  }

  Taken AddPoint(const Light& light, SumBounds& bounds) {
    const Vec3d away = light.position - center_;
    const double height = Dot(away, normal_);
    // Most lights that are behind are so by far, which needs no root.
    if (height <= -(slip_ + kLengthMargin * (SumOfSizes(away) + radius_))) return Taken::kBehind;
    const double distance = Length(away);
    const double least_height = std::max(slip_, kLengthMargin * (distance + radius_));
    if (height <= -least_height) return Taken::kBehind;
    // Of a light in the plane itself rounding says which side it is on.
    if (!(height > least_height)) return Taken::kNo;
    const double nearest = std::max(height, distance - radius_) * (1 - kLengthMargin);
    const double farthest = (distance + radius_) * (1 + kLengthMargin);
    const double noise = (kHeightRounding * (reach_ + SumOfSizes(light.position)) + slip_) / height;
    const bool fades = light.fade_distance > 0;
    const FadingBound fading = BoundFading(light, nearest, farthest);
    // Of the height, once, and of the distance; what both do together is less than what is allowed
    // for the distance twice.
    const double growth = fades ? 1 + fading.slope : 1;
    const double error = stretch_ * fading.fourth / (24 * 81) + noise * growth * fading.most;
    if (!(error <= kMaxTermSpread * fading.least)) return Taken::kNo;
    const Rgb strength = Scaled(light.irradiance, height);
    bounds.error += Scaled(strength, error);
    bounds.least += Scaled(strength, fading.least);
    bounds.most += Scaled(strength, fading.most);
    if (fades) {
      fading_.push_back({&light, strength});
    } else {
      points_.push_back({light.position, strength});
    }
    return Taken::kYes;
  }

  const Vec3d normal_, center_;
  const double radius_, reach_;
  // What a hit's distance from the cell's own point, cell.pad at most, does to the height of a
  // light and to how far away it is, which is no nearer than that height.
  const double slip_;
  const double stretch_;
  NodePlaces places_;
  std::vector<NodeLight>& points_;
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
  thread_local std::vector<NodeLight> points;
  PlaneTerms terms(cell, normal, points);
  SumBounds bounds;
  size_t count = 0;
  std::erase_if(lights, [&](size_t i) {
    const auto taken = terms.Add(scene_.lights[i], bounds);
    count += taken == PlaneTerms::Taken::kYes ? 1 : 0;
    return taken == PlaneTerms::Taken::kNo;
  });
  if (count < static_cast<size_t>(kMinSummedLights)) return nullptr;
  return Finished(4, count, terms.Nodes().data(), bounds);
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
