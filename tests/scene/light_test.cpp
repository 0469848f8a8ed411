#include "core/scene/light.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace linetree
