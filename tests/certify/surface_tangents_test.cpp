// Where lines meet quadrics: derivatives from the surface against the chain rule and the truth.
#include <gtest/gtest.h>

#include <cstdio>

#include "core/certify/surface_tangents-inl.h"
#include "tests/jet/jet_check.h"

namespace linetree::test {
namespace {

// x^2 + y^2 = (base + taper z)^2, or x^2 + y^2 + z^2 = 1.
struct Quadric {
  bool sphere = true;
  double base = 0, taper = 0;
};

template <class T>
struct Meeting {
  std::array<T, 3> p, q, m;
  T a, root, t;
};

// Lines from about `from` to about `to`, both of which move linearly with the coordinates.
struct Lines {
  std::array<RandomPolynomial<4>, 3> from_by, to_by;
  Vec3d from, to;
  double sign = -1;  // of the root: -1 on entry

  template <class T>
  Meeting<T> Meet(const Quadric& f, const std::array<T, 4>& x) const {
    Meeting<T> r;
    const double start[3] = {from.x, from.y, from.z}, end[3] = {to.x, to.y, to.z};
    for (size_t i = 0; i < 3; ++i) {
      r.p[i] = from_by[i](x) + start[i];
      r.q[i] = T(to_by[i](x) + end[i]) - r.p[i];
    }
    const auto& [p, q] = std::tie(r.p, r.q);
    const T w = p[2] * f.taper + f.base, slope = q[2] * f.taper;
    T b, c;
    if (f.sphere) {
      r.a = Square(q[0]) + Square(q[1]) + Square(q[2]);
      b = p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
      c = T(Square(p[0]) + Square(p[1]) + Square(p[2])) + -1.0;
    } else {
      r.a = Square(q[0]) + Square(q[1]) - Square(slope);
      b = p[0] * q[0] + p[1] * q[1] - w * slope;
      c = Square(p[0]) + Square(p[1]) - Square(w);
    }
    const T discriminant = Square(b) - r.a * c;
    if (!IsClearlyPositive(r.a) || !IsClearlyPositive(discriminant)) return r;
    r.root = SquareRoot(discriminant);
    r.t = T(r.root * sign - b) * Inverse(r.a);
    for (size_t i = 0; i < 3; ++i) r.m[i] = p[i] + q[i] * r.t;
    return r;
  }
  static bool IsClearlyPositive(const Jet<4>& f) { return f.lo() > 1e-6; }
  static bool IsClearlyPositive(const Taylor<4>&) { return true; }
};

Lines SomeLines(Random& random) {
  const double spread = random.LogUniform(1e-3, 0.3);
  const auto by = [&] { return RandomPolynomial<4>(random, spread / 4); };
  Lines lines{{by(), by(), by()},
              {by(), by(), by()},
              random.Direction() * random.Uniform(1.5, 4),
              random.InCube(0.6)};
  lines.sign = random.Below(2) == 0 ? -1 : 1;
  return lines;
}

TEST(SurfaceTangents, EncloseTheTruthAndAreNarrower) {
  constexpr int kRounds = 150;
  Random random(1);
  const Quadric quadrics[] = {{},
                              {.sphere = false, .base = 0.8, .taper = 0},
                              {.sphere = false, .base = 0.9, .taper = -0.5}};
  for (const Quadric& f : quadrics) {
    int held = 0;
    double ratios = 0;
    for (int n = 0; n < kRounds; ++n) {
      const Lines lines = SomeLines(random);
      const Box<4> box = RandomBox<4>(random, 1);
      Meeting<Jet<4>> jets = lines.Meet(f, box.Jets());
      if (!Lines::IsClearlyPositive(jets.a) || !(jets.root.lo() > 1e-3)) continue;
      const auto& [p, q, m] = std::tie(jets.p, jets.q, jets.m);
      scalar_jets::JetVector<4> at{m[0], m[1], m[2]};
      scalar_jets::QuadricAt quadric{
          {at.x.v, at.y.v, at.z.v}, f.sphere ? 1 : -f.taper * f.taper, jets.root.v * lines.sign};
      if (!f.sphere) quadric.gradient[2] = (at.z.v * f.taper + f.base) * -f.taper;
      scalar_jets::TightenOnSurface<4>({p[0], p[1], p[2]}, {q[0], q[1], q[2]}, quadric, jets.t, at);
      ++held;
      const Jet<4> tightened[3] = {at.x, at.y, at.z};
      for (const Point<4>& u : Samples<4>(random, 20)) {
        const Meeting<Taylor<4>> truth = lines.Meet(f, box.At(u));
        ASSERT_EQ(Complaint<4>(jets.t, truth.t, u, 1e-25), "");
        for (size_t i = 0; i < 3; ++i) {
          ASSERT_EQ(Complaint<4>(tightened[i], truth.m[i], u, 1e-25), "");
        }
      }
      double before = 0, after = 0;
      for (size_t i = 0; i < 3; ++i) {
        ASSERT_LE(tightened[i].InterpolationError(), m[i].InterpolationError());
        before += m[i].InterpolationError();
        after += tightened[i].InterpolationError();
      }
      ratios += after / before;
    }
    std::printf("%d bundles, error %.3f of the chain rule's on average\n", held, ratios / held);
    EXPECT_GT(held, kRounds / 4);
    EXPECT_LT(ratios, 0.9 * held);
  }
}

}  // namespace
}  // namespace linetree::test
