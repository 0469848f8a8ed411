// Whether a jet tells the truth about a function: everything corner_jet-inl.h promises, at points
// of the cell.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "core/jet/jet_functions-inl.h"
#include "tests/jet/taylor.h"

namespace linetree::test {

template <size_t D>
using Jet = scalar_jets::CornerJet<D>;

template <size_t D>
using Point = std::array<double, D>;

template <size_t D>
struct Box {
  Point<D> from, to;

  std::array<Jet<D>, D> Jets() const {
    std::array<Jet<D>, D> x;
    for (size_t i = 0; i < D; ++i) x[i] = Jet<D>::Variable(i, from[i], to[i]);
    return x;
  }
  std::array<Taylor<D>, D> At(const Point<D>& u) const {
    std::array<Taylor<D>, D> x;
    for (size_t i = 0; i < D; ++i) x[i] = Taylor<D>::Variable(i, from[i], to[i], u[i]);
    return x;
  }
};

// A box of the given edge within [-1, 1]^D; some edges much shorter, some turned round.
template <size_t D>
Box<D> RandomBox(Random& random, double edge) {
  Box<D> box;
  for (size_t i = 0; i < D; ++i) {
    const double length = random.Below(4) == 0 ? edge * random.LogUniform(1e-6, 1) : edge;
    box.from[i] = random.Uniform(-1, 1 - length);
    box.to[i] = box.from[i] + length;
    if (random.Below(4) == 0) std::swap(box.from[i], box.to[i]);
  }
  return box;
}

// Points of [0,1]^D: all corners, the middle, and random ones, every other coordinate of which is
// an end or the middle.
template <size_t D>
std::vector<Point<D>> Samples(Random& random, int count) {
  std::vector<Point<D>> points;
  for (size_t m = 0; m < size_t{1} << D; ++m) {
    Point<D> u;
    for (size_t i = 0; i < D; ++i) u[i] = static_cast<double>(m >> i & 1);
    points.push_back(u);
  }
  for (int n = 0; n < count; ++n) {
    Point<D> u;
    for (double& x : u) x = random.Below(2) == 0 ? random.Unit() : 0.5 * random.Below(3);
    points.push_back(u);
  }
  return points;
}

// The multilinear interpolant of corner values, in wide arithmetic.
template <size_t D>
Wide Interpolate(const std::array<double, size_t{1} << D>& corners, const Point<D>& u) {
  Wide sum = 0;
  for (size_t m = 0; m < corners.size(); ++m) {
    Wide weight = 1;
    for (size_t i = 0; i < D; ++i) weight *= (m >> i & 1) != 0 ? Wide(u[i]) : 1 - Wide(u[i]);
    sum += weight * Wide(corners[m]);
  }
  return sum;
}

template <size_t D>
std::array<double, size_t{1} << D> CornersOf(const Jet<D>& jet) {
  std::array<double, size_t{1} << D> corners;
  jet.k.Store(corners.data());
  return corners;
}

// Rounding of the truth and of Interpolate, which a jet without slack has to be forgiven.
inline constexpr double kWideError = 0x1p-105;

// What is wrong with a jet as a description of f near u; empty when nothing is. `truth_error`: how
// far the truth itself may be off, relative.
template <size_t D>
std::string Complaint(const Jet<D>& jet, const Taylor<D>& truth, const Point<D>& u,
                      double truth_error = kWideError) {
  const auto inside = [&](Wide x, double lo, double hi) {
    const Wide off = (x < 0 ? -x : x) * Wide(truth_error);
    return Wide(lo) <= x + off && x - off <= Wide(hi);
  };
  const auto say = [](const char* what, Wide x, double lo, double hi) {
    return std::string(what) + " " + std::to_string(static_cast<double>(x)) + " not in [" +
           std::to_string(lo) + ", " + std::to_string(hi) + "] ";
  };
  std::string complaint;
  if (!inside(truth.f, jet.v.lo, jet.v.hi)) complaint += say("f", truth.f, jet.v.lo, jet.v.hi);
  double lo[D], hi[D];
  jet.d().lo.Store(lo);
  jet.d().hi.Store(hi);
  for (size_t i = 0; i < D; ++i) {
    if (!inside(truth.d[i], lo[i], hi[i])) complaint += say("f'", truth.d[i], lo[i], hi[i]);
  }
  jet.s().lo.Store(lo);
  jet.s().hi.Store(hi);
  for (size_t i = 0; i < D; ++i) {
    if (!inside(truth.s[i], lo[i], hi[i])) complaint += say("f''", truth.s[i], lo[i], hi[i]);
  }
  const Wide excess = Interpolate<D>(CornersOf(jet), u) - truth.f;
  const Wide off = (truth.f < 0 ? -truth.f : truth.f) * Wide(truth_error);
  const double most = jet.ExcessUnderQ() + jet.slack, least = -(jet.ExcessOverQ() + jet.slack);
  if (excess - off > Wide(most) || excess + off < Wide(least)) {
    complaint += say("Q - f", excess, least, most);
  }
  if ((excess < 0 ? -excess : excess) - off > Wide(jet.InterpolationError())) {
    complaint += say("|Q - f|", excess, 0, jet.InterpolationError());
  }
  const bool is_corner = std::all_of(u.begin(), u.end(), [](double x) { return x == 0 || x == 1; });
  if (is_corner && (excess - off > Wide(jet.slack) || excess + off < -Wide(jet.slack))) {
    complaint += say("corner", excess, -jet.slack, jet.slack);
  }
  return complaint;
}

// Holds for all samples of f on the box. f takes an array of coordinates, jets or Taylor.
template <size_t D, class F>
void ExpectTrue(const Box<D>& box, const F& f, Random& random, double truth_error = kWideError,
                int samples = 40) {
  const Jet<D> jet = f(box.Jets());
  for (const Point<D>& u : Samples<D>(random, samples)) {
    const Taylor<D> truth = f(box.At(u));
    ASSERT_EQ(Complaint<D>(jet, truth, u, truth_error), "");
  }
}

}  // namespace linetree::test
