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

// Against long double, on the same arguments.
using Wide = long double;
using WideVec = Vec3<Wide>;
double Off(const Vec3d& x, const WideVec& truth) {
  return static_cast<double>(Length(CastVec3<Wide>(x) - truth));
}
void ExpectWithin(const char* what, double largest, double bound) {
  std::printf("%s: largest error %.3g, bound %.3g\n", what, largest, bound);
  EXPECT_LE(largest, bound) << what;
}

TEST(ShadeRounding, LightViews) {
  Random random(11);
  double direction = 0, fall_off = 0;
  for (int i = 0; i < 200'000; ++i) {
    Light light = test::PointLight(random.InCube(1) * random.LogUniform(1e-6, 1e6));
    const Vec3d point = light.position + random.Direction() * random.LogUniform(1e-9, 1e9);
    light.fade_distance = random.LogUniform(1e-6, 1e6);
    light.fade_power = random.Uniform(0.1, 8);
    const auto view = ViewOf(light, point);
    const auto truth = ViewOf(light, CastVec3<Wide>(point));
    for (int k = 0; k < 3; ++k) {
      const Wide off = std::abs((view.to_light[k] - truth.to_light[k]) / truth.to_light[k]);
      direction = std::max(direction, static_cast<double>(off));
    }
    fall_off = std::max(
        fall_off, static_cast<double>(std::abs(view.fall_off - truth.fall_off) / truth.fall_off));
  }
  ExpectWithin("to_light", direction, kToLightRounding);
  ExpectWithin("fall-off", fall_off, kViewFallOffRounding);
}

TEST(ShadeRounding, HighlightsAndReflections) {
  Random random(12);
  double highlight = 0, reflected = 0;
  for (int i = 0; i < 300'000; ++i) {
    const Vec3d n = random.Direction(), l = random.Direction();
    Vec3d v = random.Direction();
    // The eye in the light's mirror image, and nearly opposite the light.
    if (i % 3 == 0) v = Normalized(Reflected(-l, n) + random.InCube(random.LogUniform(1e-12, 1)));
    if (i % 5 == 0) v = Normalized(-l + random.InCube(random.LogUniform(1e-9, 1)));
    const double exponent = random.LogUniform(1, 1000);
    const WideVec wn = CastVec3<Wide>(n), wl = CastVec3<Wide>(l), wv = CastVec3<Wide>(v);
    const Wide truth = Highlight<Wide>(exponent, wn, wl, wv);
    const double error = static_cast<double>(std::abs(Highlight(exponent, n, l, v) - truth));
    highlight = std::max(highlight, error / (1 + exponent));
    reflected = std::max(reflected, Off(Reflected(v, n), Reflected(wv, wn)));
  }
  ExpectWithin("Highlight, over 1 + exponent", highlight, kHighlightRounding);
  ExpectWithin("Reflected", reflected, kReflectedRounding);
}

// Half of the rays within 1e-14 to 1e-1 of the critical angle, and ulps away from it.
TEST(ShadeRounding, Refractions) {
  Random random(13);
  double largest = 0, wrong = 0;
  int differ = 0;
  for (int i = 0; i < 400'000; ++i) {
    const Vec3d n = random.Direction();
    const double from = random.Uniform(0.3, 3), into = random.Uniform(0.3, 3), eta = from / into;
    Vec3d d = random.Direction();
    if (i % 2 == 0 && eta > 1) {
      const Vec3d across = Normalized(Cross(n, d));
      const double sine =
          std::min(1.0, (1 + random.Uniform(-1, 1) * random.LogUniform(1e-17, 0.1)) / eta);
      d = Normalized(across * sine - n * std::sqrt(1 - sine * sine));
    }
    if (Dot(d, n) > 0) d = -d;
    const WideVec wn = CastVec3<Wide>(n), wd = CastVec3<Wide>(d);
    const Wide weta = Wide(from) / into, cosine = -Dot(wn, wd);
    const double square = static_cast<double>(1 - weta * weta * (1 - cosine * cosine));
    const auto refracted = Refracted(d, n, from, into);
    const auto truth = Refracted<Wide>(wd, wn, from, into);
    const double unit = 1 + eta * eta;
    if (refracted.has_value() != truth.has_value()) {
      ++differ;
      wrong = std::max(wrong, std::abs(square) / unit);
    } else if (refracted) {
      largest = std::max(largest, Off(*refracted, *truth) * std::sqrt(square) / unit);
    }
  }
  std::printf("%d decisions differ\n", differ);
  ExpectWithin("Refracted, times c / (1 + eta^2)", largest, kRefractedRounding);
  ExpectWithin("total reflection, square of c / (1 + eta^2)", wrong, kRefractedRounding);
  EXPECT_GT(differ, 0) << "ulps from the critical angle were tried";
}

}  // namespace
}  // namespace linetree
