#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/scene/make_shape.h"
#include "tests/io/scene_fixture.h"

namespace linetree {
namespace {

v1::Scene Parsed(const std::string& text) {
  auto source = ParseNff(text, "s.nff");
  EXPECT_TRUE(source.ok()) << source.status();
  return source.ok() ? (*source)->message() : v1::Scene();
}

constexpr const char* kView =
    "v\nfrom 0 0 5\nat 0 1 0\nup 0 0 1\nangle 30\nhither 1\nresolution 640 480\n";

TEST(Nff, ViewBackgroundAndLights) {
  const v1::Scene scene = Parsed(std::string("b 0.1 0.2 0.3\n") + kView +
                                 "l 1 2 3\nl 4 5 6 0.7 0.8 0.9\nl 7 8 9\nl 1 1 1");
  EXPECT_EQ(scene.background().g(), 0.2);
  ASSERT_EQ(scene.cameras_size(), 1);
  EXPECT_EQ(scene.cameras(0).name(), "nff");
  EXPECT_EQ(scene.cameras(0).eye().z(), 5);
  EXPECT_EQ(scene.cameras(0).look_at().y(), 1);
  EXPECT_EQ(scene.cameras(0).up().z(), 1);
  EXPECT_EQ(scene.cameras(0).fov_deg(), 30);
  EXPECT_THAT(scene.description(), testing::HasSubstr("Resolution 640 x 480"));
  ASSERT_EQ(scene.lights_size(), 4);
  EXPECT_EQ(scene.lights(0).point().position().y(), 2);
  EXPECT_EQ(scene.lights(0).irradiance().r(), 0.5);  // 1 / sqrt(4)
  EXPECT_EQ(scene.lights(1).irradiance().b(), 0.9);
  EXPECT_EQ(scene.lights(3).irradiance().b(), 0.5);
}

TEST(Nff, FillsBecomeMaterialsOnce) {
  const v1::Scene scene = Parsed(
      "s 0 0 0 1 "
      "f 1 0.5 0.25 0.8 0.1 30 0.6 1.5 s 0 0 0 1 "
      "f 1 1 1 1 0 100000 0 0 s 0 0 0 1 "
      "f 1 0.5 0.25 0.8 0.1 30 0.6 1.5 s 0 0 0 1 "
      "f 1 1 1 0.5 1.25 2e7 0.6 0 s 0 0 0 1");
  ASSERT_EQ(scene.materials_size(), 4);
  // Before the first fill: matt white.
  EXPECT_EQ(scene.materials(0).diffuse().r(), 1);
  const v1::Material& glass = scene.materials(1);
  EXPECT_EQ(glass.diffuse().g(), 0.4);
  EXPECT_EQ(glass.specular().b(), 0.1);
  EXPECT_EQ(glass.reflect().r(), 0.1);
  EXPECT_EQ(glass.transmit().g(), 0.6);
  EXPECT_EQ(glass.exponent(), 30);
  EXPECT_EQ(glass.ior(), 1.5);
  EXPECT_FALSE(glass.has_ambient());
  EXPECT_FALSE(scene.materials(2).has_transmit());
  EXPECT_EQ(scene.materials(3).exponent(), 1e6);
  EXPECT_EQ(scene.materials(3).ior(), 1);
  EXPECT_EQ(scene.materials(3).specular().r(), 1.25);
  EXPECT_EQ(scene.materials(3).reflect().r(), 1);
  EXPECT_EQ(scene.objects(1).material(), scene.objects(3).material());
  EXPECT_NE(scene.objects(1).material(), scene.objects(2).material());
}

TEST(Nff, RecordsMayStandOnAnyLines) {
  const v1::Scene scene = Parsed(
      "c\n0 0 0 2\n0 0 1 1\n# a comment s 1 2\nc 0 0 0 1.5 0 0 2 1.5 c 0 0 0 1 0 1\n0 0"
      " s 1 2 3 -0.5 # inside out\nc 0 0 0 -1 1 0 0 -2");
  ASSERT_EQ(scene.objects_size(), 5);
  EXPECT_EQ(scene.objects(0).cone().base_radius(), 2);
  EXPECT_EQ(scene.objects(0).cone().top_radius(), 1);
  EXPECT_TRUE(scene.objects(0).cone().open());
  EXPECT_EQ(scene.objects(1).cylinder().radius(), 1.5);
  EXPECT_EQ(scene.objects(1).cylinder().top().z(), 2);
  EXPECT_TRUE(scene.objects(1).cylinder().open());
  EXPECT_EQ(scene.objects(2).cone().top_radius(), 0);
  EXPECT_EQ(scene.objects(3).sphere().radius(), 0.5);
  EXPECT_EQ(scene.objects(4).cone().top_radius(), 2);
}

TEST(Nff, PatchesBecomeSmoothTriangles) {
  const v1::Scene scene = Parsed(
      "pp 4\n0 0 0 0 0 1\n1 0 0 1 0 1\n1 1 0 1 1 1\n0 1 0 0 1 1\n"
      "pp 4 0 0 0 0 0 1 0 0 0 0 0 1 1 1 0 0 0 1 0 1 0 0 0 1\n"  // two corners coincide
      "pp 3 0 0 0 0 0 1 1 0 0 0 0 0 0 1 0 0 0 1\n"              // a normal is missing
      "pp 3 0 0 0 0 0 1 1 0 0 0 0 1 2 0 0 0 0 1\n");            // no area
  ASSERT_EQ(scene.objects_size(), 4);
  EXPECT_EQ(scene.objects(0).triangle().vertices_size(), 3);
  EXPECT_EQ(scene.objects(1).triangle().normals(2).y(), 1);
  EXPECT_EQ(scene.objects(1).triangle().vertices(2).y(), 1);
  EXPECT_EQ(scene.objects(2).triangle().vertices(1).y(), 1);
  EXPECT_EQ(scene.objects(3).triangle().normals_size(), 0);
  EXPECT_THAT(scene.description(), testing::HasSubstr("1 degenerate primitives were left out"));
}

TEST(Nff, PolygonsOfEveryKind) {
  const v1::Scene scene = Parsed(
      "p 4 0 0 0 2 0 0 1 0.2 0 1 2 0\n"  // concave
      "p 4 0 0 0 1 0 0 1 1 0.5 0 1 0\n"  // bent: two triangles
      "p 3 0 0 0 1 1 1 2 2 2\np 2 0 0 0 1 1 1\ns 0 0 0 0\nc 0 0 0 0 1 1 1 0\nc 1 1 1 1 1 1 1 2");
  ASSERT_EQ(scene.objects_size(), 3);
  EXPECT_EQ(scene.objects(0).polygon().vertices_size(), 4);
  EXPECT_EQ(scene.objects(1).triangle().vertices_size(), 3);
  EXPECT_EQ(scene.objects(2).triangle().vertices_size(), 3);
  EXPECT_THAT(scene.description(), testing::HasSubstr("5 degenerate primitives were left out"));
  const auto built = BuildScene(*SceneFromMessage(scene));
  ASSERT_TRUE(built.ok()) << built.status();
  EXPECT_EQ((*built)->objects.size(), 4u);
}

struct Rule {
  const char* name;
  const char* text;
  const char* message;
};
class NffRule : public testing::TestWithParam<Rule> {};

TEST_P(NffRule, IsRefusedWithItsPlace) {
  const auto scene = BuildNff(GetParam().text);
  ASSERT_FALSE(scene.ok());
  EXPECT_EQ(scene.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(scene.status().message()), testing::StartsWith(GetParam().message));
}

INSTANTIATE_TEST_SUITE_P(
    Rules, NffRule,
    testing::Values(
        Rule{"NotANumber", "s 0 0 0 1\n\n  s 0 0 0 abc",
             "s.nff:3:11: expected a number for the radius of the sphere, got 'abc'"},
        Rule{"Truncated", "s 0 0",
             "s.nff:1:6: expected a number for z of the center of the sphere, "
             "got the end of the file"},
        Rule{"UnknownKeyword", "b 0 0 0\ntorus 1",
             "s.nff:2:1: expected a record (v, b, l, f, s, c, p or pp), got 'torus'"},
        Rule{"Infinite", "s 0 0 inf 1",
             "s.nff:1:7: expected a finite number of magnitude <= 1e+30 "
             "for z of the center of the sphere, got 'inf'"},
        Rule{"Nan", "l nan 0 0", "s.nff:1:3: expected a finite number"},
        Rule{"Huge", "s 1e31 0 0 1", "s.nff:1:3: expected a finite number of magnitude <= 1e+30"},
        Rule{"HalfAColour", "l 0 0 0 1 1\ns 0 0 0 1",
             "s.nff:2:1: expected a number for the light's colour, got 's'"},
        Rule{"ShortFill", "f 1 1 1 1 0 10 0\ns 0 0 0 1",
             "s.nff:2:1: expected a number for the index of refraction, got 's'"},
        Rule{"NegativeCount", "p -3 0 0 0",
             "s.nff:1:3: expected a whole number for the number of "
             "vertices, got '-3'"},
        Rule{"BrokenCount", "pp 2.5", "s.nff:1:4: expected a whole number"},
        Rule{"ShortPolygon", "p 3 0 0 0 1 0 0 1 1",
             "s.nff:1:20: expected a number for z of vertex 2, got the end of the file"},
        Rule{"ShortPatch", "pp 3 0 0 0 1 0 0 1 1 x",
             "s.nff:1:22: expected a number for z of vertex 1, got 'x'"},
        Rule{"TwoViews", "v from 0 0 1 at 0 0 0 v at 0 0 0", "s.nff:1:23: expected only one view"},
        Rule{"Control", "\x01\x02",
             "s.nff:1:1: expected a record (v, b, l, f, s, c, p or pp), got "
             "'\\x01\\x02'"},
        // Rules on values name the record.
        Rule{"NegativeKd", "\nf 1 1 1 -1 0 0 0 0 s 0 0 0 1",
             "s.nff:2:1: materials[0].diffuse.r: expected a number in [0, 1e+30], got -1"},
        Rule{"WideView", "b 0 0 0 v from 0 0 1 at 0 0 0 up 0 1 0 angle 190",
             "s.nff:1:9: cameras[0].fov_deg: expected an angle in (0, 180), got 190"},
        Rule{"Crossing", "s 0 0 0 1\n p 4 0 0 0 2 1 0 2 0 0 0 2 0",
             "s.nff:2:2: objects[1].polygon.vertices: expected a polygon that does not cross "
             "itself"},
        Rule{"NegativeLight", "s 0 0 0 1 l 0 0 0 -1 0 0",
             "s.nff:1:11: lights[0].irradiance.r: expected a number in"},
        Rule{"Background", "b -1 0 0", "s.nff: background.r: expected a number in"}),
    [](const auto& info) { return std::string(info.param.name); });

TEST(Nff, LimitsAreRefused) {
  SceneLimits limits;
  limits.max_polygon_vertices = 4;
  EXPECT_EQ(BuildNff("p 5", limits).status().code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(BuildNff("p 5", limits).status().message()),
              testing::StartsWith("s.nff:1:3: expected at most 4 for the number of vertices"));
  limits.max_objects = 1;
  const auto many = BuildNff("s 0 0 0 1\ns 0 0 0 1", limits).status();
  EXPECT_EQ(many.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(many.message()), testing::StartsWith("s.nff:2:1: expected at most 1"));
  limits.max_file_bytes = 3;
  EXPECT_EQ(BuildNff("b 0 0 0", limits).status().code(), absl::StatusCode::kResourceExhausted);
}

struct File {
  const char* name;
  size_t records;  // published number of primitives
};
class SpdFile : public testing::TestWithParam<File> {};

TEST_P(SpdFile, IsReadWhole) {
  const auto source =
      ReadSceneFile(std::string(LINETREE_SOURCE_DIR "/scenes/spd/") + GetParam().name + ".nff");
  ASSERT_TRUE(source.ok()) << source.status();
  EXPECT_EQ(static_cast<size_t>((*source)->message().objects_size()), GetParam().records);
  EXPECT_THAT((*source)->message().description(), testing::Not(testing::HasSubstr("left out")));
  const auto scene = BuildScene(**source);
  ASSERT_TRUE(scene.ok()) << scene.status();
  EXPECT_GE((*scene)->objects.size(), GetParam().records);
}

INSTANTIATE_TEST_SUITE_P(
    Spd, SpdFile,
    testing::Values(File{"balls_2", 92}, File{"balls_3", 821}, File{"balls_4", 7382},
                    File{"gears_1", 147}, File{"jacks_2", 81}, File{"lattice_2", 81},
                    File{"mount_2", 36}, File{"mount_4", 516}, File{"mount_6", 8196},
                    File{"rings_1", 61}, File{"shells_1", 361}, File{"teapot_2", 244},
                    File{"tetra_4", 256}, File{"tetra_6", 4096}, File{"tree_4", 63},
                    File{"tree_8", 1023}, File{"tree_11", 8191}),
    [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace linetree
