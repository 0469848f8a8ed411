// The shape of highlights: narrower than the chain rule, and true.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "core/certify/highlight_jet-inl.h"
#include "tests/jet/jet_check.h"

namespace linetree::test {
namespace {

// The truth is powl, in 64 bits, and loses digits where terms of the second derivative cancel.
constexpr double kTruthError = 0x1p-46;

TEST(HighlightJet, BellsEncloseTheTruthAndAreNarrower) {
  Random random(2);
  double ratios = 0;
  int cells = 0, narrower = 0;
  for (int n = 0; n < 60; ++n) {
    for (const double q : {0.0, 0.5, 1.0, 5.0, 20.0, 80.0, 500.0}) {
      // Bells are about 1 / sqrt(q) wide: of cells about the peak and beside it, wide and narrow.
      const double spread = random.LogUniform(0.1, 2) / std::sqrt(q + 1);
      const RandomPolynomial<4> by[3] = {{random, spread}, {random, spread}, {random, spread / 8}};
      const Box<4> box = RandomBox<4>(random, random.LogUniform(0.1, 1));
      const auto w = [&]<class T>(const std::array<T, 4>& x) {
        return std::array<T, 3>{by[0](x), by[1](x), by[2](x)};
      };
      const auto jets = w(box.Jets());
      const scalar_jets::JetVector<4> jet_w{jets[0], jets[1], jets[2]};
      const Jet<4> bell = scalar_jets::Bell<4>(jet_w, q);
      for (const Point<4>& u : Samples<4>(random, 16)) {
        const auto at = w(box.At(u));
        const Taylor<4> y = Square(at[0]) + Square(at[1]) + Square(at[2]);
        ASSERT_EQ(Complaint<4>(bell, Power(y + 1.0, -q), u, kTruthError), "") << "q " << q;
      }
      const Jet<4> y = LengthSquared(jet_w);
      const Jet<4> chain = Power(Jet<4>(y + 1.0), -q);
      ASSERT_LE(bell.InterpolationError(), chain.InterpolationError());
      if (q < 5) continue;
      ++cells;
      const double ratio = bell.InterpolationError() / chain.InterpolationError();
      ratios += ratio;
      narrower += ratio < 0.9;
    }
  }
  std::printf("%d of %d narrower, error %.3f of the chain rule's on average\n", narrower, cells,
              ratios / cells);
  EXPECT_GT(narrower, cells / 6);
}

}  // namespace
}  // namespace linetree::test
