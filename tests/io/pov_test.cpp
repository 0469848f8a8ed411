#include "core/io/pov.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/io/pov_finish.h"
#include "tests/io/scene_fixture.h"

namespace linetree {
namespace {

using testing::HasSubstr;

std::string PovOf(const std::string& text) {
  const auto scene = BuildText(text + "cameras { eye { z: 5 } fov_deg: 90 }");
  EXPECT_TRUE(scene.ok()) << scene.status();
  const auto pov =
      WritePov(**scene, (*scene)->cameras[0], 200, 100, {.max_depth = 7, .min_weight = 0.25});
  EXPECT_TRUE(pov.ok()) << pov.status();
  return pov.ok() ? *pov : "";
}

TEST(Pov, GlobalsAndCamera) {
  const std::string text = PovOf("background { r: 0.5 } ambient { g: 0.25 }");
  EXPECT_THAT(text, HasSubstr("#version 3.7;"));
  EXPECT_THAT(text, HasSubstr("max_trace_level 7"));
  EXPECT_THAT(text, HasSubstr("adc_bailout 0.25"));
  EXPECT_THAT(text, HasSubstr("ambient_light rgb <0, 0.25, 0>"));
  EXPECT_THAT(text, HasSubstr("background { rgb <0.5, 0, 0> }"));
  EXPECT_THAT(text, HasSubstr("location <0, 0, 5>"));
  EXPECT_THAT(text, HasSubstr("direction <0, 0, -1>"));
}

TEST(Pov, ShapesAndLights) {
  const std::string text = PovOf(WithMaterial(
      "objects { name: \"odd\\nname\" material: \"m\" sphere { center { x: 1 } radius: 2 } }"
      "objects { material: \"m\" cylinder { top { z: 1 } radius: 1 open: true } }"
      "objects { material: \"m\" cone { top { z: 1 } base_radius: 1 } }"
      "objects { material: \"m\" disc { normal { z: 1 } radius: 1 } }"
      "objects { material: \"m\" box { max { x: 1 y: 1 z: 1 } } }"
      "lights { point { position { x: 3 } fade_distance: 4 } }"
      "lights { directional { direction { z: -1 } } }\n"));
  EXPECT_THAT(text, HasSubstr("sphere { <0, 0, 0>, 1 matrix <2, 0, 0, 0, 2, 0, 0, 0, 2, 1, 0, 0>"));
  EXPECT_THAT(text, HasSubstr("// odd name\n"));
  EXPECT_THAT(text, HasSubstr("cylinder { <0, 0, 0>, <0, 0, 1>, 1 open matrix"));
  EXPECT_THAT(text, HasSubstr("cone { <0, 0, 0>, 1, <0, 0, 1>, 0 matrix"));
  EXPECT_THAT(text, HasSubstr("disc {"));
  EXPECT_THAT(text, HasSubstr("box {"));
  EXPECT_THAT(text, HasSubstr("fade_distance 4 fade_power 2"));
  EXPECT_THAT(text, HasSubstr("parallel point_at"));
}

// What POV-Ray makes of a finish (ambient, diffuse, what comes through), from its own formulas.
void ExpectSame(const Material& m) {
  const auto f = ToPovFinish(m);
  ASSERT_TRUE(f.ok()) << f.status();
  const double opacity = 1 - f->filter - f->transmit;
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(f->color[k] * f->ambient[k] * opacity, m.ambient[k], 1e-12);
    EXPECT_NEAR(f->color[k] * f->diffuse * opacity, m.diffuse[k], 1e-12);
    EXPECT_NEAR(f->color[k] * f->filter + f->transmit, m.transmit[k], 1e-12);
  }
  EXPECT_EQ(f->specular, m.specular.r);
  EXPECT_EQ(f->reflection, m.reflect);
}

TEST(PovFinish, Expressible) {
  Material m;
  ExpectSame(m);
  m.ambient = {0.3, 0.2, 0.1};
  ExpectSame(m);
  m.diffuse = {0.9, 0.5, 0.1};
  m.specular = {0.5, 0.5, 0.5};
  m.reflect = {0.1, 0.2, 0.3};
  ExpectSame(m);
  m.transmit = {0.4, 0.4, 0.4};
  ExpectSame(m);
  m.transmit = {0.45, 0.25, 0.05};  // proportional to diffuse
  ExpectSame(m);
  m.transmit = {0.55, 0.35, 0.15};  // and a grey part
  ExpectSame(m);
  m.diffuse = m.ambient = {};
  m.transmit = {0.9, 0.2, 0};
  ExpectSame(m);
  m.transmit = {1, 1, 1};
  ExpectSame(m);
}

TEST(PovFinish, NotExpressible) {
  Material coloured_highlight;
  coloured_highlight.specular = {1, 0.5, 0.5};
  Material two_colours;
  two_colours.diffuse = {0.5, 0.1, 0.1};
  two_colours.transmit = {0.1, 0.5, 0.1};
  Material equal_channels = two_colours;
  equal_channels.diffuse = {0.5, 0.5, 0.1};
  equal_channels.transmit = {0.5, 0.1, 0.1};
  Material negative_grey;
  negative_grey.diffuse = {0.5, 0.25, 0.25};
  negative_grey.transmit = {0.8, 0.3, 0.3};
  Material clear_and_lit;
  clear_and_lit.diffuse = {0.5, 0.5, 0.5};
  clear_and_lit.transmit = {1, 1, 1};
  Material glow;
  glow.diffuse = {0.5, 0, 0};
  glow.ambient = {0, 1, 0};
  for (const Material& m :
       {coloured_highlight, two_colours, equal_channels, negative_grey, clear_and_lit, glow}) {
    EXPECT_EQ(ToPovFinish(m).status().code(), absl::StatusCode::kUnimplemented);
  }
}

TEST(Pov, NamesEveryMaterialThatItCannotExpress) {
  const auto scene = BuildText(
      "materials { name: \"a\" specular { r: 1 } } materials { name: \"b\" }"
      "materials { name: \"c\" specular { g: 1 } } cameras { eye { z: 5 } }");
  ASSERT_TRUE(scene.ok()) << scene.status();
  const auto pov = WritePov(**scene, (*scene)->cameras[0], 10, 10, {});
  EXPECT_EQ(pov.status().code(), absl::StatusCode::kUnimplemented);
  EXPECT_THAT(std::string(pov.status().message()), HasSubstr("material 'a'"));
  EXPECT_THAT(std::string(pov.status().message()), HasSubstr("material 'c'"));
}

}  // namespace
}  // namespace linetree
