// Cells certified with SIMD and without are the same, bit by bit, on every target of this machine.
#include <gtest/gtest.h>

#include <cstdio>

#include "tests/certify/random_cells.h"
#include "tests/support/every_target.h"

namespace linetree::test {
namespace {

constexpr int kScenes = 24, kCellsOfScene = 150;

void ExpectEqual(const CellPaths& a, const CellPaths& b, const char* name) {
  ASSERT_EQ(a.verdict, b.verdict) << name;
  ASSERT_EQ(a.decided, b.decided) << name;
  ASSERT_EQ(a.spread, b.spread) << name;
  ASSERT_EQ(a.objects, b.objects) << name;
  ASSERT_EQ(a.steps.size(), b.steps.size()) << name;
  for (size_t i = 0; i < a.steps.size(); ++i) {
    const PathStep &s = a.steps[i], &t = b.steps[i];
    ASSERT_EQ(s.object, t.object) << name;
    ASSERT_EQ(s.face, t.face) << name;
    ASSERT_EQ(s.side, t.side) << name;
    ASSERT_EQ(s.listed, t.listed) << name;
    ASSERT_EQ(s.reflected, t.reflected) << name;
    ASSERT_EQ(s.transmitted, t.transmitted) << name;
    ASSERT_EQ(s.candidates.size(), t.candidates.size()) << name;
  }
  ASSERT_EQ(a.interpolant == nullptr, b.interpolant == nullptr) << name;
  if (!a.interpolant) return;
  ASSERT_EQ(a.interpolant->corner, b.interpolant->corner) << name;
}

TEST(SimdWalk, EqualsScalarOnEveryTarget) {
  PathLimits limits;
  limits.max_depth = 5;
  const int targets = ForEveryTarget([&](const char* name) {
    int cells = 0, certified = 0;
    for (int s = 0; s < kScenes; ++s) {
      Random random(static_cast<uint64_t>(s));
      const Scene scene = RandomScene(random, 3 + s % 9, 3);
      const Tracer tracer(scene);
      const PathCertifier simd(tracer), scalar(tracer, PathCertifier::Lanes::kScalar);
      for (int i = 0; i < kCellsOfScene; ++i) {
        const int object = random.Below(static_cast<int>(scene.objects.size()));
        const ObjectChart chart(scene.objects[static_cast<size_t>(object)]);
        const auto cell = CellOf(tracer, chart, object, random.LogUniform(0.002, 0.2), random);
        if (!cell) continue;
        const CellPaths a = simd.Certify(object, chart, cell->pair, cell->box, limits, nullptr);
        const CellPaths b = scalar.Certify(object, chart, cell->pair, cell->box, limits, nullptr);
        ExpectEqual(a, b, name);
        if (testing::Test::HasFatalFailure()) return;
        ++cells;
        certified += a.verdict == Verdict::kCertified;
      }
    }
    std::printf("target %s: %d cells equal, %d of them certified\n", name, cells, certified);
    EXPECT_GT(cells, 2000);
    EXPECT_GT(certified, 200);
  });
  EXPECT_GE(targets, 1);
}

}  // namespace
}  // namespace linetree::test
