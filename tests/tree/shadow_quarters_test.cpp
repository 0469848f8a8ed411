// Quarters of shadow functions: both twins, and what they say against the functions themselves.
#include "core/tree/shadow_quarters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/support/every_target.h"
#include "tests/support/random.h"

namespace linetree {
namespace {

using test::Random;

// Functions as cells have them: coefficients one after the other, of forms that vanish somewhere
// about the square.
struct Functions {
  std::vector<ShadowFunction> functions;
  std::vector<float> coefficients;

  void Add(const std::vector<double>& form) {
    for (const double k : form) coefficients.push_back(static_cast<float>(k));
  }
  ShadowFunction& Begin() {
    functions.push_back({.begin = static_cast<uint32_t>(coefficients.size())});
    return functions.back();
  }
};

// Steep or flat, in units of the margin.
std::vector<double> RandomForm(Random& random, bool is_linear) {
  const double size = random.LogUniform(1, 1e5), u = random.Unit(), v = random.Unit();
  std::vector<double> k;
  for (int i = 0; i < (is_linear ? 3 : 6); ++i) k.push_back(random.Uniform(-size, size));
  k[0] = -k[1] * u - k[2] * v;
  if (!is_linear) k[0] -= k[3] * u * u + k[4] * u * v + k[5] * v * v;
  return k;
}

Functions RandomFunctions(Random& random, int count) {
  Functions all;
  for (int i = 0; i < count; ++i) {
    // Candidates without a function are among the others.
    const int pieces = random.Below(4);
    ShadowFunction& function = all.Begin();
    function.pieces = static_cast<uint8_t>(pieces);
    for (int piece = 0; piece < pieces; ++piece) {
      const bool is_squared = random.Below(2) == 0;
      const int lines = random.Int(is_squared ? 0 : 1, 5);
      function.lines[static_cast<size_t>(piece)] = static_cast<uint8_t>(lines);
      for (int line = 0; line < lines; ++line) all.Add(RandomForm(random, true));
      if (!is_squared) continue;
      function.squares = static_cast<uint8_t>(function.squares | 1 << piece);
      all.Add(RandomForm(random, false));
    }
  }
  return all;
}

// What At says of all functions, one after the other.
struct Quarters {
  std::vector<ShadowQuarters::Says> says;
  std::vector<ShadowFunction> functions;
  std::vector<float> coefficients;

  Quarters(const Functions& of, int child, ShadowQuarters::Lanes lanes) {
    ShadowQuarters quarters;
    quarters.Begin(of.functions, of.coefficients, child, lanes);
    for (size_t i = 0; i < of.functions.size(); ++i) {
      functions.emplace_back();
      says.push_back({Shadowing::kUnknown});
      if (of.functions[i].pieces == 0) continue;
      says.back() = quarters.At(i, coefficients, functions.back());
    }
  }
  Shadowing At(size_t index, double s, double t) const {
    if (says[index].everywhere != Shadowing::kUnknown) return says[index].everywhere;
    return ShadowingAt(functions[index], coefficients.data(), static_cast<float>(s),
                       static_cast<float>(t));
  }
};

void ExpectSame(const Quarters& a, const Quarters& b, const char* name) {
  EXPECT_EQ(a.coefficients, b.coefficients) << name;
  for (size_t i = 0; i < a.says.size(); ++i) {
    EXPECT_EQ(a.says[i].everywhere, b.says[i].everywhere) << name;
    EXPECT_EQ(a.says[i].may_block_all, b.says[i].may_block_all) << name;
    EXPECT_EQ(a.functions[i].begin, b.functions[i].begin) << name;
    EXPECT_EQ(a.functions[i].pieces, b.functions[i].pieces) << name;
    EXPECT_EQ(a.functions[i].squares, b.functions[i].squares) << name;
    EXPECT_EQ(a.functions[i].lines, b.functions[i].lines) << name;
  }
}

TEST(ShadowQuarters, EveryTargetGivesTheScalarTwinsBits) {
  Random random(51);
  for (const int count : {0, 1, 2, 3, 9, 200}) {
    const Functions functions = RandomFunctions(random, count);
    for (int child = 0; child < 4; ++child) {
      const Quarters expected(functions, child, ShadowQuarters::Lanes::kScalar);
      const int targets = test::ForEveryTarget([&](const char* name) {
        ExpectSame(Quarters(functions, child, ShadowQuarters::Lanes::kSimd), expected, name);
      });
      EXPECT_GE(targets, 1);
    }
  }
}

// Whatever has been dropped: a point of a quarter that is certainly in the shadow is not certainly
// outside of the whole cell's, and the other way round. Where the whole cell's function is sure the
// quarter's is, too, but for roundings.
TEST(ShadowQuarters, SayWhatTheFunctionsSay) {
  Random random(52);
  int sure = 0, lost = 0, settled = 0, smaller = 0;
  for (int round = 0; round < 20; ++round) {
    const Functions functions = RandomFunctions(random, 200);
    const int child = round % 4;
    const Quarters quarters(functions, child, ShadowQuarters::Lanes::kSimd);
    for (size_t i = 0; i < functions.functions.size(); ++i) {
      const ShadowFunction& function = functions.functions[i];
      if (function.pieces == 0) continue;
      const bool is_settled = quarters.says[i].everywhere != Shadowing::kUnknown;
      settled += is_settled ? 1 : 0;
      smaller += !is_settled && quarters.functions[i].pieces < function.pieces ? 1 : 0;
      for (int k = 0; k < 50; ++k) {
        const double s = random.Unit(), t = random.Unit();
        const Shadowing whole = ShadowingAt(function, functions.coefficients.data(),
                                            static_cast<float>((s + (child & 1)) / 2),
                                            static_cast<float>((t + (child >> 1)) / 2));
        const Shadowing quarter = quarters.At(i, s, t);
        if (whole == Shadowing::kUnknown || quarter == Shadowing::kUnknown) {
          lost += whole != Shadowing::kUnknown ? 1 : 0;
          continue;
        }
        EXPECT_EQ(whole, quarter) << "function " << i << " of round " << round;
        ++sure;
      }
    }
  }
  EXPECT_GT(sure, 50'000);
  EXPECT_LT(lost, sure / 1000);
  EXPECT_GT(settled, 100);
  EXPECT_GT(smaller, 100);
}

// Said of functions of which a corner is certainly lit, or that are linear: those that are not
// linear have been found to hide nothing at a corner.
TEST(ShadowQuarters, KnowWhichFunctionsMayHideAll) {
  Random random(53);
  int squared = 0, no = 0;
  for (int round = 0; round < 20; ++round) {
    const Functions functions = RandomFunctions(random, 200);
    const Quarters quarters(functions, round % 4, ShadowQuarters::Lanes::kSimd);
    for (size_t i = 0; i < functions.functions.size(); ++i) {
      if (quarters.functions[i].pieces == 0) continue;
      if (quarters.functions[i].squares == 0) {
        EXPECT_FALSE(quarters.says[i].may_block_all);
        continue;
      }
      ++squared;
      int misses = 0;
      for (const double s : {0, 1}) {
        for (const double t : {0, 1}) misses += quarters.At(i, s, t) == Shadowing::kMisses ? 1 : 0;
      }
      no += quarters.says[i].may_block_all ? 0 : 1;
      // Not so sure about those between one and two margins.
      if (misses == 0) {
        EXPECT_TRUE(quarters.says[i].may_block_all);
      }
    }
  }
  EXPECT_GT(squared, 500);
  EXPECT_GT(no, 100);
}

// A strip between two lines, which lies in the right half and holds no corner of it.
TEST(ShadowQuarters, PiecesThatAreCutAwayAreDropped) {
  Functions functions;
  ShadowFunction& strip = functions.Begin();
  strip.pieces = 1;
  strip.lines[0] = 3;
  functions.Add({600, -1000, 0});   // s > 0.6
  functions.Add({-700, 1000, 0});   // s < 0.7
  functions.Add({-540, 500, 500});  // s + t < 1.08
  using enum Shadowing;
  const auto says = [&](int child) {
    return Quarters(functions, child, ShadowQuarters::Lanes::kSimd).says[0].everywhere;
  };
  EXPECT_EQ(says(0), kMisses);
  EXPECT_EQ(says(1), kUnknown);
  EXPECT_EQ(says(2), kMisses);
  // Each line leaves a part of the quarter, and any two do: not all three.
  EXPECT_EQ(says(3), kMisses);
}

}  // namespace
}  // namespace linetree
