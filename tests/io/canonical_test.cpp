#include "core/io/canonical.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/io/scene_fixture.h"

namespace linetree {
namespace {

SceneVersion VersionOfText(const std::string& text) {
  const auto scene = BuildText(text);
  EXPECT_TRUE(scene.ok()) << scene.status() << "\n" << text;
  return scene.ok() ? (*scene)->version : "";
}

// One of everything.
const char kScene[] = R"(
name: "a" background { r: 0.1 } ambient { g: 0.2 } white: 2
materials { name: "m" ambient { r: 0.1 } diffuse { r: 0.2 } specular { r: 0.3 } exponent: 5
            reflect { r: 0.4 } transmit { r: 0.5 } ior: 1.5 }
lights { name: "l" irradiance { r: 0.6 } point { position { x: 1 } fade_distance: 3 fade_power: 1 } }
lights { directional { direction { z: -1 } } }
objects { name: "o" material: "m" sphere { radius: 1 } }
objects { material: "m" box { max { x: 1 y: 1 z: 1 } } }
objects { material: "m" cone { top { z: 1 } base_radius: 2 top_radius: 1 } }
objects { material: "m" disc { normal { z: 1 } radius: 1 } }
objects { material: "m" polygon { vertices { } vertices { x: 7 } vertices { y: 1 } } }
objects { material: "m" triangle { vertices { } vertices { x: 1 } vertices { y: 1 }
          normals { z: 1 } normals { z: 1 } normals { z: 1 x: 0.25 } } }
objects { material: "m" polyhedron { half_spaces { normal { x: -1 } } half_spaces { normal { y: -1 } }
          half_spaces { normal { z: -1 } } half_spaces { normal { x: 1 y: 1 z: 1 } offset: 1.5 } } }
cameras { name: "c" eye { z: 5 } up { y: 1 } fov_deg: 40 }
)";

std::string Replaced(const std::string& from, const std::string& to) {
  std::string text = kScene;
  const size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(Canonical, IsThirtyTwoHexadecimalDigits) {
  const SceneVersion version = VersionOfText(kScene);
  EXPECT_EQ(version.size(), 32u);
  EXPECT_EQ(version.find_first_not_of("0123456789abcdef"), std::string::npos);
}

TEST(Canonical, DoesNotDependOnTheWriting) {
  const SceneVersion version = VersionOfText(kScene);
  EXPECT_EQ(VersionOfText(std::string("# comment\ndescription: \"d\"\n\n") + kScene), version);
  EXPECT_EQ(VersionOfText(Replaced("white: 2", "white:    2.0\n")), version);
  EXPECT_EQ(VersionOfText(Replaced("radius: 1 }", "radius: 1 center { x: -0.0 } }")), version);
  const auto source = ParseSceneText(kScene, "s");
  EXPECT_EQ(VersionOfText(WriteSceneText((*source)->message())), version);
  // Written-out defaults.
  EXPECT_EQ(VersionOfText("white: 1 materials { name: \"a\" exponent: 10 ior: 1 }"),
            VersionOfText("materials { name: \"a\" }"));
}

TEST(Canonical, EveryFieldCounts) {
  std::set<SceneVersion> versions{VersionOfText(kScene)};
  const std::pair<const char*, const char*> changes[] = {
      {"name: \"a\"", "name: \"b\""},
      {"background { r: 0.1 }", "background { r: 0.11 }"},
      {"ambient { g: 0.2 }", "ambient { g: 0.21 }"},
      {"white: 2", "white: 2.5"},
      {"ambient { r: 0.1 } diffuse", "ambient { r: 0.12 } diffuse"},
      {"diffuse { r: 0.2 }", "diffuse { b: 0.2 }"},
      {"specular { r: 0.3 }", "specular { r: 0.31 }"},
      {"exponent: 5", "exponent: 6"},
      {"reflect { r: 0.4 }", "reflect { r: 0.41 }"},
      {"transmit { r: 0.5 }", "transmit { r: 0.51 }"},
      {"ior: 1.5", "ior: 1.6"},
      {"name: \"l\"", "name: \"k\""},
      {"irradiance { r: 0.6 }", "irradiance { r: 0.61 }"},
      {"position { x: 1 }", "position { x: 2 }"},
      {"fade_distance: 3", "fade_distance: 4"},
      {"fade_power: 1", "fade_power: 1.5"},
      {"direction { z: -1 }", "direction { x: 1 z: -1 }"},
      {"name: \"o\"", "name: \"p\""},
      {"sphere { radius: 1 }", "sphere { radius: 1.000000000000001 }"},
      {"sphere { radius: 1 }", "sphere { radius: 1 center { y: 1 } }"},
      {"max { x: 1 y: 1 z: 1 }", "max { x: 1 y: 2 z: 1 }"},
      {"top_radius: 1", "top_radius: 1.5"},
      {"top_radius: 1", "top_radius: 1 open: true"},
      {"disc { normal { z: 1 }", "disc { normal { x: 1 z: 1 }"},
      {"vertices { x: 7 }", "vertices { x: 8 }"},
      {"normals { z: 1 x: 0.25 }", "normals { z: 1 }"},
      {"offset: 1.5", "offset: 1.6"},
      {"name: \"c\"", "name: \"d\""},
      {"eye { z: 5 }", "eye { z: 6 }"},
      {"up { y: 1 }", "up { y: 1 x: 0.5 }"},
      {"fov_deg: 40", "fov_deg: 41"},
      {"objects { material: \"m\" box { max { x: 1 y: 1 z: 1 } } }", ""},
  };
  for (const auto& [from, to] : changes) {
    EXPECT_TRUE(versions.insert(VersionOfText(Replaced(from, to))).second) << from << " -> " << to;
  }
}

TEST(Canonical, NffAndItsConversionAgree) {
  for (const char* name : {"balls_2", "gears_1", "teapot_2", "mount_2", "tree_4", "rings_1"}) {
    const auto source =
        ReadSceneFile(std::string(LINETREE_SOURCE_DIR "/scenes/spd/") + name + ".nff");
    ASSERT_TRUE(source.ok()) << source.status();
    const auto imported = BuildScene(**source);
    ASSERT_TRUE(imported.ok()) << imported.status();
    EXPECT_EQ(VersionOfText(WriteSceneText((*source)->message())), (*imported)->version) << name;
  }
}

}  // namespace
}  // namespace linetree
