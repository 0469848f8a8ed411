#include "core/tree/diffuse_sum.h"

namespace linetree {
namespace {

using Weights = std::array<double, 4>;

// Lagrange's.
Weights WeightsAt(double x, int nodes) {
  if (nodes == 2) return {1 - x, x, 0, 0};
  const double a = 3 * x, b = 3 * x - 1, c = 3 * x - 2, d = 3 * x - 3;
  return {-b * c * d / 6, a * c * d / 2, -a * b * d / 2, a * b * c / 6};
}

}  // namespace

Rgb DiffuseSum::At(double u, double v) const {
  const Weights along_u = WeightsAt(u, nodes), along_v = WeightsAt(v, nodes);
  Rgb sum;
  for (int j = 0; j < nodes; ++j) {
    for (int i = 0; i < nodes; ++i) {
      const double weight = along_u[static_cast<size_t>(i)] * along_v[static_cast<size_t>(j)];
      const auto& node = value[static_cast<size_t>(j * nodes + i)];
      sum.r += weight * static_cast<double>(node[0]);
      sum.g += weight * static_cast<double>(node[1]);
      sum.b += weight * static_cast<double>(node[2]);
    }
  }
  return sum;
}

}  // namespace linetree
