#include "core/scene/light.h"

#include <gtest/gtest.h>

#include "tests/support/random.h"

namespace linetree {
namespace {

TEST(FallOff, IsPovRays) {
  Light light;
  EXPECT_EQ(FallOff(light, 1234.0), 1) << "none unless asked for";
  light.fade_distance = 4;
  light.fade_power = 2;
  EXPECT_EQ(FallOff(light, 4.0), 1) << "1 at the fade distance";
  EXPECT_EQ(FallOff(light, 0.0), 2);
  EXPECT_DOUBLE_EQ(FallOff(light, 12.0), 0.2);
  light.fade_power = 1;
  EXPECT_DOUBLE_EQ(FallOff(light, 12.0), 0.5);
}

TEST(FallOff, RoundingIsAsPublished) {
  test::Random random(3);
  double largest = 0;
  for (int i = 0; i < 200'000; ++i) {
    Light light;
    light.fade_distance = random.LogUniform(1e-9, 1e9);
    light.fade_power = i % 3 == 0 ? random.Int(1, 8) : random.Uniform(0.01, 8);
    const double distance = light.fade_distance * random.LogUniform(1e-9, 1e9);
    const long double truth = FallOff(light, static_cast<long double>(distance));
    const double error = static_cast<double>(std::abs(FallOff(light, distance) - truth) / truth);
    largest = std::max(largest, error);
  }
  std::printf("largest error %.3g, bound %.3g\n", largest, kFallOffRounding);
  EXPECT_LE(largest, kFallOffRounding);
}

}  // namespace
}  // namespace linetree
