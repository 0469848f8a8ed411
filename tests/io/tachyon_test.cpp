#include "core/io/tachyon.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/io/tachyon_shape.h"
#include "core/io/tachyon_texture.h"
#include "tests/io/scene_fixture.h"

namespace linetree {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

absl::StatusOr<TachyonScene> Written(const std::string& text) {
  const auto scene = BuildText(text + "cameras { eye { z: 5 } fov_deg: 90 }");
  EXPECT_TRUE(scene.ok()) << scene.status();
  return WriteTachyon(**scene, (*scene)->cameras[0], 200, 100, {.max_depth = 7});
}

size_t CountOf(const std::string& text, const std::string& word) {
  size_t count = 0;
  for (size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
  return count;
}

TEST(Tachyon, GlobalsAndCamera) {
  const auto scene = Written("background { r: 0.5 } ambient { g: 0.25 }");
  ASSERT_TRUE(scene.ok()) << scene.status();
  EXPECT_THAT(scene->text, testing::StartsWith("Begin_Scene\nResolution 200 100\n"));
  EXPECT_THAT(scene->text, testing::EndsWith("End_Scene\n"));
  EXPECT_THAT(scene->text, HasSubstr("Raydepth 7"));
  EXPECT_THAT(scene->text, HasSubstr("Center 0 0 5"));
  EXPECT_THAT(scene->text, HasSubstr("Viewdir 0 0 -1"));
  // tan 45 degrees to either side and half of it up and down, turned over, moved by half of a
  // pixel of 1/100.
  EXPECT_THAT(scene->text, HasSubstr("Frustum 1.005 -0.995 -0.505 0.495"));
  EXPECT_THAT(scene->text, HasSubstr("Background 0.5 0 0"));
  EXPECT_THAT(scene->differences, IsEmpty());
}

TEST(Tachyon, ShapesThatItHas) {
  const auto scene = Written(WithMaterial(
      "objects { material: \"m\" sphere { center { x: 1 } radius: 2 } }"
      "objects { material: \"m\" cylinder { top { z: 1 } radius: 1 open: true } }"
      "objects { material: \"m\" cylinder { top { z: 2 } radius: 1 } }"
      "objects { material: \"m\" disc { normal { z: 1 } radius: 1 } }"
      "objects { material: \"m\" box { max { x: 1 y: 1 z: 1 } } }"
      "objects { material: \"m\" polygon { vertices { } vertices { x: 1 } vertices { x: 1 y: 1 } "
      "vertices { y: 1 } } }"));
  ASSERT_TRUE(scene.ok()) << scene.status();
  EXPECT_THAT(scene->text, HasSubstr("Sphere Center 1 0 0 Rad 2 m0\n"));
  EXPECT_THAT(scene->text, HasSubstr("FCylinder Base 0 0 0 Apex 0 0 1 Rad 1 m0\n"));
  EXPECT_THAT(scene->text, HasSubstr("Ring Center 0 0 2 Normal 0 0 1 Inner 0 Outer 1 m0\n"));
  EXPECT_EQ(CountOf(scene->text, "\nFCylinder"), 2u);
  EXPECT_EQ(CountOf(scene->text, "\nRing"), 3u) << "two caps and the disc";
  EXPECT_EQ(CountOf(scene->text, "\nTRI"), 14u) << "six faces and the polygon, two each";
  EXPECT_EQ(CountOf(scene->text, "\nSTRI"), 0u);
  EXPECT_THAT(scene->differences, IsEmpty());
}

TEST(Tachyon, ShapesThatItApproximates) {
  const auto scene = Written(WithMaterial(
      "objects { material: \"m\" cone { top { z: 1 } base_radius: 1 } }"
      "objects { material: \"m\" ellipsoid { center { } semi_axes { x: 1 y: 2 z: 3 } } }"));
  ASSERT_TRUE(scene.ok()) << scene.status();
  constexpr size_t kSides = kTachyonSides;
  // One triangle a side to the apex; two for each of the ellipsoid's 32 rings but for the poles'.
  EXPECT_EQ(CountOf(scene->text, "\nSTRI"), kSides + kSides * (2 * 32 - 2));
  EXPECT_EQ(CountOf(scene->text, "\nRing"), 1u);
  EXPECT_THAT(scene->differences, Contains(HasSubstr("2 curved objects are meshes")));
}

TEST(Tachyon, Lights) {
  const auto scene = Written(
      "lights { irradiance { r: 0.5 } point { position { x: 1 y: 2 z: 3 } } }"
      "lights { point { position { } fade_distance: 2 fade_power: 2 } }"
      "lights { point { position { } fade_distance: 2 fade_power: 1 } }"
      "lights { directional { direction { y: -1 } } }");
  ASSERT_TRUE(scene.ok()) << scene.status();
  EXPECT_THAT(scene->text, HasSubstr("Light Center 1 2 3 Rad 0 Color 0.5 0 0\n"));
  EXPECT_THAT(scene->text, HasSubstr("Attenuation Constant 0.5 Linear 0 Quadratic 0.125 "));
  EXPECT_THAT(scene->text, HasSubstr("Attenuation Constant 0.5 Linear 0.25 Quadratic 0 "));
  EXPECT_THAT(scene->text, HasSubstr("Directional_Light Direction "));
  const auto refused =
      Written("lights { name: \"odd\" point { position { } fade_distance: 2 fade_power: 1.5 } }");
  EXPECT_EQ(refused.status().code(), absl::StatusCode::kUnimplemented);
  EXPECT_THAT(refused.status().message(), HasSubstr("'odd'"));
}

TEST(TachyonTexture, ExpressesGreyCoefficientsExactly) {
  Material material;
  material.ambient = {0.5, 0.25, 0.125};
  material.diffuse = {0.4, 0.2, 0.1};
  material.specular = {0.3, 0.3, 0.3};
  material.exponent = 20;
  material.reflect = {0.2, 0.2, 0.2};
  material.transmit = {0.1, 0.1, 0.1};
  const TachyonTexture texture = ToTachyonTexture(material, {0.8, 0.8, 0.8}, {1, 1, 1});
  EXPECT_THAT(texture.differences, IsEmpty());
  EXPECT_EQ(texture.color, material.diffuse);
  EXPECT_DOUBLE_EQ(texture.ambient, 1);
  EXPECT_EQ(texture.diffuse, 1);
  EXPECT_DOUBLE_EQ(texture.phong, 0.3);
  EXPECT_EQ(texture.phong_size, 20);
  EXPECT_DOUBLE_EQ(texture.specular, 0.2);
  EXPECT_DOUBLE_EQ(texture.opacity, 0.9);
}

TEST(TachyonTexture, SaysWhatItLeavesOut) {
  Material material;
  material.ambient = {0.5, 0.1, 0.1};
  material.diffuse = {0.1, 0.1, 0.5};
  material.specular = {0.3, 0, 0};
  material.reflect = {0, 0.3, 0};
  material.transmit = {0, 0, 0.3};
  const TachyonTexture texture = ToTachyonTexture(material, {1, 1, 1}, {1, 1, 1});
  EXPECT_THAT(texture.differences, testing::SizeIs(4));
  EXPECT_DOUBLE_EQ(texture.phong, 0.1);
}

TEST(TachyonTexture, WithoutDiffuseTheColourIsTheAmbientOne) {
  Material material;
  material.ambient = {0.5, 0.1, 0.2};
  const TachyonTexture texture = ToTachyonTexture(material, {1, 1, 0.5}, {1, 1, 0.5});
  EXPECT_EQ(texture.color, (Rgb{0.5, 0.1, 0.1}));
  EXPECT_EQ(texture.ambient, 1);
  EXPECT_EQ(texture.diffuse, 0);
}

TEST(Tachyon, ColouredAmbientLightGoesIntoTheTextures) {
  const auto scene = Written(
      "ambient { r: 0.2 g: 0.2 b: 0.16 }"
      "materials { name: \"m\" ambient { r: 1 g: 1 b: 1 } diffuse { r: 0.5 g: 0.5 b: 0.5 } "
      "specular { r: 0.1 g: 0.1 b: 0.1 } }"
      "lights { irradiance { r: 0.4 g: 0.4 b: 0.4 } point { position { x: 1 } } }"
      "objects { material: \"m\" sphere { center { } radius: 1 } }");
  ASSERT_TRUE(scene.ok()) << scene.status();
  EXPECT_THAT(scene->text, HasSubstr("Color 0.5 0.5 0.4 TexFunc"));
  EXPECT_THAT(scene->text, HasSubstr("Color 0.4 0.4 0.5\n"));
  EXPECT_THAT(scene->differences, testing::ElementsAre("highlights off by up to 25 % in colour"));
}

TEST(Tachyon, SaysWhatItsModelLeavesOut) {
  const auto scene = Written(
      "materials { name: \"m\" specular { r: 0.1 g: 0.1 b: 0.1 } transmit { r: 0.5 g: 0.5 b: 0.5 } "
      "ior: 1.5 }"
      "lights { point { position { x: 1 } fade_distance: 3 } }"
      "objects { material: \"m\" sphere { center { } radius: 1 } }");
  ASSERT_TRUE(scene.ok()) << scene.status();
  EXPECT_THAT(scene->differences, Contains(HasSubstr("no refraction")));
  EXPECT_THAT(scene->differences, Contains(HasSubstr("max_depth")));
  EXPECT_THAT(scene->differences, Contains(HasSubstr("not filtered")));
  EXPECT_THAT(scene->differences, Contains(HasSubstr("do not fade")));
}

}  // namespace
}  // namespace linetree
