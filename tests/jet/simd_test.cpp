// SIMD and scalar jets are the same, number by number, on every target of this machine.
#include <gtest/gtest.h>

#include <cstdio>

#include "tests/jet/jet_program.h"
#include "tests/support/every_target.h"
#include "tests/support/random.h"

namespace linetree::test {
namespace {

JetProgramInput RandomInput(Random& random) {
  JetProgramInput input;
  input.dimension = random.Below(3) == 0 ? 2 : 4;
  input.constant = random.Uniform(-2, 2);
  const double scale = random.Below(3) == 0 ? random.LogUniform(1e-20, 1e10) : 1;
  for (auto& numbers : input.numbers) {
    for (double& x : numbers) x = random.Below(6) == 0 ? 0 : scale * random.Uniform(-1, 1);
    // Edges of all sizes, and none: the ends of the axes.
    for (size_t i = 8; i < 12; ++i) {
      numbers[i] = numbers[i - 4] + numbers[i] * random.LogUniform(1e-10, 1);
    }
  }
  return input;
}

// Numbers are compared as numbers: of two zeros of different sign a target may take either.
TEST(Simd, EqualsScalarOnEveryTarget) {
  const int targets = ForEveryTarget([](const char* name) {
    std::printf("target %s\n", name);
    Random random(1);
    for (int i = 0; i < 4000; ++i) {
      const JetProgramInput input = RandomInput(random);
      const JetProgramOutput simd = RunSimdJets(input), scalar = RunScalarJets(input);
      ASSERT_EQ(simd.size(), scalar.size());
      for (size_t n = 0; n < simd.size(); ++n) {
        ASSERT_EQ(simd[n].second, scalar[n].second) << name << ": " << simd[n].first;
      }
    }
  });
  EXPECT_GE(targets, 1);
}

}  // namespace
}  // namespace linetree::test
