#include "core/trace/shade.h"

#include <gtest/gtest.h>

#include "tests/support/random.h"
#include "tests/support/scene_builder.h"

namespace linetree {
namespace {

using test::Random;

// Rounding of a handful of operations on numbers of order one.
constexpr double kRounding = 0x1p-48;

TEST(Shade, ReflectionKeepsTheTangentAndTurnsTheNormalPart) {
  Random random(1);
  for (int k = 0; k < 1000; ++k) {
    const Vec3d d = random.Direction();
    const Vec3d n = random.Direction();
    const Vec3d r = Reflected(d, n);
    EXPECT_NEAR(Dot(r, n), -Dot(d, n), kRounding);
    EXPECT_LT(Length(Cross(n, r) - Cross(n, d)), kRounding);
  }
}

// Snell: n1 sin(i) = n2 sin(t), in the plane of incidence, on the other side; or total reflection
// exactly when n1 sin(i) > n2.
TEST(Shade, RefractionObeysSnell) {
  Random random(2);
  int total = 0;
  for (int k = 0; k < 10000; ++k) {
    const Vec3d n = random.Direction();
    Vec3d d = random.Direction();
    if (Dot(d, n) > 0) d = -d;
    const double from = random.Uniform(1, 2.5);
    const double into = random.Uniform(1, 2.5);
    const double sine = Length(Cross(d, n));
    const auto refracted = Refracted(d, n, from, into);
    if (!refracted) {
      ++total;
      EXPECT_GT(from * sine, into * (1 - kRounding));
      continue;
    }
    EXPECT_LT(from * sine, into * (1 + kRounding));
    EXPECT_LT(Length(Cross(*refracted, n) * into - Cross(d, n) * from), kRounding);
    EXPECT_NEAR(Length(*refracted), 1, kRounding);
    EXPECT_LE(Dot(*refracted, n), 0);
  }
  EXPECT_GT(total, 500);
}

TEST(Shade, EqualIndicesDoNotBend) {
  const Vec3d d = Normalized(Vec3d{1, 2, -3});
  EXPECT_EQ(Refracted(d, Vec3d{0, 0, 1}, 1.3, 1.3), d);
}

TEST(Shade, HighlightIsBlinns) {
  const Vec3d n{0, 0, 1};
  const Vec3d l = Normalized(Vec3d{1, 0, 1});
  const Vec3d v{0, 0, 1};
  const double half_angle = std::numbers::pi / 8;
  EXPECT_NEAR(Highlight(20, n, l, v), std::pow(std::cos(half_angle), 20), kRounding);
  EXPECT_EQ(Highlight(20, n, n, n), 1);
  EXPECT_EQ(Highlight(3, n, l, Vec3d(-l)), 0) << "no half vector";
}

// ks is multiplied neither by n.l nor by kd; E multiplies both.
TEST(Shade, LightTermIsTheFormula) {
  Material material;
  material.diffuse = {0.5, 0.25, 0.125};
  material.specular = {0.1, 0.2, 0.3};
  material.exponent = 7;
  Light light = test::PointLight({0, 3, 4}, {2, 3, 4});
  light.fade_distance = 10;
  light.fade_power = 1;
  const Vec3d n{0, 0, 1};
  const Vec3d v = Normalized(Vec3d{1, 0, 2});
  const LightView<double> view = ViewOf(light, Vec3d{0, 0, 0});
  EXPECT_NEAR(Length(view.to_light - Vec3d{0, 0.6, 0.8}), 0, kRounding);
  EXPECT_NEAR(view.fall_off, 2 / (1 + 5.0 / 10), kRounding);
  const Vec3d h = Normalized(view.to_light + v);
  const Rgb radiance = LightTermRadiance(material, light, view, 0.8, n, v);
  for (int i = 0; i < 3; ++i) {
    const double expected =
        light.irradiance[i] * view.fall_off *
        (material.diffuse[i] * 0.8 + material.specular[i] * std::pow(Dot(n, h), 7));
    EXPECT_NEAR(radiance[i], expected, kRounding);
  }
}

// However near: the direction is unit until the light is at the point itself.
TEST(Shade, LightsThatTouchThePointHaveADirection) {
  const Vec3d along = Normalized(Vec3d{1, -2, 3});
  for (const double distance : {1e30, 1.0, 1e-30, 1e-140, 1e-150, 1e-160, 1e-200, 1e-300, 1e-320}) {
    const Light light = test::PointLight(along * distance);
    const double rounding = kRounding + 0x1p-1074 / distance;
    const LightView<double> view = ViewOf(light, Vec3d{});
    EXPECT_LT(Length(view.to_light - along), 2 * rounding) << distance;
    EXPECT_NEAR(Length(view.to_light), 1, kRounding) << distance;
    EXPECT_EQ(view.fall_off, 1);
  }
  EXPECT_EQ(ViewOf(test::PointLight({1, 2, 3}), Vec3d{1, 2, 3}).to_light, Vec3d{});
}

TEST(Shade, DirectionalLightsDoNotFade) {
  Light light = test::DirectionalLight({0, 0, 2});
  light.fade_distance = 1;
  const LightView<double> view = ViewOf(light, Vec3d{7, 8, 9});
  EXPECT_EQ(view.to_light, (Vec3d{0, 0, 1}));
  EXPECT_EQ(view.fall_off, 1);
}

TEST(Shade, OnlyDiffuseAndSpecularUseLights) {
  EXPECT_FALSE(UsesLights(test::Mirror({1, 1, 1})));
  EXPECT_TRUE(UsesLights(test::Matte({0, 0, 0.1})));
  Material shiny;
  shiny.specular = {0.1, 0, 0};
  EXPECT_TRUE(UsesLights(shiny));
}

}  // namespace
}  // namespace linetree
