#include "core/certify/diffuse_summer.h"

#include <algorithm>
#include <cmath>

#include "core/certify/curved_cell-inl.h"
#include "core/trace/intersect.h"
#include "core/trace/shade.h"

namespace linetree {
namespace {

// Nodes are floats, at most 1.64^2 of whose largest rounding reaches the sum; twice that, and what
// the arithmetic in double adds.
constexpr double kNodeRounding = 0x1p-21;
constexpr double kLeastNode = 0x1p-100, kMostNode = 0x1p100;
constexpr double kLebesgue = 1.64;
// Of the height of a light above a plane, relative to the coordinates it comes from.
constexpr double kHeightRounding = 0x1p-48;
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

std::array<float, 3> ToNode(const Rgb& sum) {
  return {static_cast<float>(sum.r), static_cast<float>(sum.g), static_cast<float>(sum.b)};
}

}  // namespace

std::vector<size_t> DiffuseSummer::Summable(const CellLights& lights) const {
  std::vector<size_t> summable;
  for (size_t i = 0; i < scene_.lights.size(); ++i) {
    const Light& light = scene_.lights[i];
    const bool fades = light.kind == LightKind::kPoint && light.fade_distance > 0;
    if (lights.lights[i].knowledge == LightKnowledge::kOn && !fades) summable.push_back(i);
  }
  return summable;
}

void DiffuseSummer::AddSums(int object, const SurfaceChart& chart, int patch,
                            const SurfaceCell& cell, CellLights& lights) const {
  if (IsBlack(scene_.MaterialOf(object).diffuse)) return;
  const std::vector<size_t> summable = Summable(lights);
  if (summable.size() < static_cast<size_t>(kMinSummedLights)) return;
  const JetShape shape = MakeJetShape(scene_.objects[static_cast<size_t>(object)]);
  if (!shape.corner_normals.empty()) return;  // the normal turns: one by one
  if (const auto plane = chart.PlanarCellOf(patch, cell)) {
    if (shape.IsThin()) {
      lights.sums = {SumOnPlane(*plane, plane->normal, summable),
                     SumOnPlane(*plane, -plane->normal, summable)};
    } else {
      const bool has_lateral = shape.kind == JetShape::Kind::kFrustum;
      const int face = has_lateral ? patch - 4 + 1 : patch;
      lights.sums[0] = SumOnPlane(*plane, shape.PlaneOf(face)->normal, summable);
    }
  } else {
    lights.sums[0] = SumOnCurve(shape, patch, cell, summable);
  }
  if (!lights.sums[0] && !lights.sums[1]) return;
  for (const size_t i : summable) lights.lights[i].summed = true;
}

DiffuseSummer::MaybeSum DiffuseSummer::SumOnPlane(const SurfaceChart::PlanarCell& cell,
                                                  const Vec3d& normal,
                                                  const std::vector<size_t>& lights) const {
  const Vec3d center = cell.corner + (cell.eu + cell.ev) * 0.5;
  const double radius = std::max(Length(cell.eu + cell.ev), Length(cell.eu - cell.ev)) / 2;
  const double stretch = PowerOf(Length(cell.eu), 4) + kLebesgue * PowerOf(Length(cell.ev), 4);
  auto sum = std::make_unique<DiffuseSum>();
  std::array<Rgb, 16> nodes{};
  std::array<Vec3d, 16> places;
  for (size_t k = 0; k < places.size(); ++k) {
    places[k] = cell.corner + cell.eu * (static_cast<double>(k % 4) / 3) +
                cell.ev * (static_cast<double>(k / 4) / 3);
  }
  SumBounds bounds;
  for (const size_t i : lights) {
    const Light& light = scene_.lights[i];
    if (light.kind == LightKind::kDirectional) {
      const double cosine = Dot(normal, light.to_light);
      if (!(cosine > 0)) continue;
      const Rgb term = Scaled(light.irradiance, cosine);
      for (Rgb& node : nodes) node += term;
      bounds.least += Scaled(term, 1 - kLengthMargin);
      bounds.most += term;
      continue;
    }
    const double height = Dot(light.position - center, normal);
    const double distance = Length(light.position - center);
    if (!(height > kLengthMargin * (distance + radius))) {
      // A light in the plane itself: which side it is on is for rounding to say.
      if (height > -kLengthMargin * (distance + radius)) return nullptr;
      continue;
    }
    const double nearest = std::max(height, distance - radius) * (1 - kLengthMargin);
    const double farthest = (distance + radius) * (1 + kLengthMargin);
    const Rgb strength = Scaled(light.irradiance, height);
    const double noise =
        kHeightRounding * (Length(center) + Length(light.position) + radius) / height;
    bounds.error += Scaled(strength, stretch / (81 * PowerOf(nearest, 5)) + noise / nearest);
    bounds.least += Scaled(strength, 1 / farthest);
    bounds.most += Scaled(strength, 1 / nearest);
    for (size_t k = 0; k < places.size(); ++k) {
      nodes[k] += Scaled(strength, 1 / Length(light.position - places[k]));
    }
  }
  sum->spread = bounds.Spread();
  if (!(sum->spread <= kMaxSumSpread)) return nullptr;
  std::transform(nodes.begin(), nodes.end(), sum->value.begin(), ToNode);
  return sum;
}

DiffuseSummer::MaybeSum DiffuseSummer::SumOnCurve(const JetShape& shape, int patch,
                                                  const SurfaceCell& cell,
                                                  const std::vector<size_t>& lights) const {
  scalar_jets::CurvedCell curve(shape, patch, cell);
  if (!curve.IsValid()) return nullptr;
  auto sum = std::make_unique<DiffuseSum>();
  sum->nodes = 2;
  std::array<Rgb, 4> nodes{};
  SumBounds bounds;
  for (const size_t i : lights) {
    const Light& light = scene_.lights[i];
    const auto term = curve.CosineTo(light);
    if (!term.is_known) return nullptr;
    bounds.error += Scaled(light.irradiance, term.error);
    bounds.least += Scaled(light.irradiance, term.least);
    bounds.most += Scaled(light.irradiance, term.most);
    for (size_t k = 0; k < 4; ++k) nodes[k] += Scaled(light.irradiance, term.corners[k]);
  }
  sum->spread = bounds.Spread();
  if (!(sum->spread <= kMaxSumSpread)) return nullptr;
  std::transform(nodes.begin(), nodes.end(), sum->value.begin(), ToNode);
  return sum;
}

}  // namespace linetree
