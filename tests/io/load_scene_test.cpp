#include "core/io/load_scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/io/scene_fixture.h"
#include "tests/io/temp_dir.h"

namespace linetree {
namespace {

TEST(LoadScene, ReadsByExtension) {
  const TempDir folder;
  std::ofstream(folder.File("a.textproto")) << WithShape("sphere { radius: 1 }");
  std::ofstream(folder.File("b.NFF")) << "s 0 0 0 1\n";
  const auto text = LoadSceneFile(folder.File("a.textproto"));
  ASSERT_TRUE(text.ok()) << text.status();
  const auto nff = LoadSceneFile(folder.File("b.NFF"));
  ASSERT_TRUE(nff.ok()) << nff.status();
  EXPECT_EQ((*nff)->objects.size(), 1u);
}

TEST(LoadScene, SaysWhatIsWrongWithTheFile) {
  const TempDir folder;
  const auto missing = LoadSceneFile(folder.File("none.textproto"));
  EXPECT_EQ(missing.status().code(), absl::StatusCode::kNotFound);
  EXPECT_THAT(std::string(missing.status().message()), testing::HasSubstr("none.textproto"));

  std::ofstream(folder.File("large.textproto"))
      << "description: \"" << std::string(100, 'x') << '"';
  SceneLimits limits;
  limits.max_file_bytes = 50;
  EXPECT_EQ(LoadSceneFile(folder.File("large.textproto"), limits).status().code(),
            absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(ParseSceneText(std::string(51, ' '), "s", limits).status().code(),
            absl::StatusCode::kResourceExhausted);
}

TEST(LoadScene, SyntaxErrorsSayWhere) {
  const auto unknown = BuildText("name: \"a\"\nobjects { blob { } }");
  EXPECT_EQ(unknown.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(unknown.status().message()), testing::StartsWith("s.textproto:2:"));
  EXPECT_THAT(std::string(unknown.status().message()), testing::HasSubstr("blob"));
  const auto two_shapes = BuildText(WithShape("sphere { } box { }"));
  EXPECT_THAT(std::string(two_shapes.status().message()), testing::StartsWith("s.textproto:2:"));
}

TEST(LoadScene, MessagesHaveFieldPathsWithoutPlaces) {
  v1::Scene message;
  message.add_objects()->mutable_sphere()->set_radius(-1);
  EXPECT_EQ(BuildScene(*SceneFromMessage(message)).status().message(),
            "objects[0].material: expected the name of a material");
}

TEST(LoadScene, DefaultsOfTheFormat) {
  const auto scene = BuildText(
      "materials { name: \"m\" }\n"
      "lights { point { } } lights { directional { direction { x: 0 y: -2 } } }\n"
      "cameras { eye { z: 3 } }");
  ASSERT_TRUE(scene.ok()) << scene.status();
  const Scene& s = **scene;
  EXPECT_EQ(s.white, 1);
  EXPECT_EQ(s.background, Rgb{});
  EXPECT_EQ(s.materials[0].exponent, 10);
  EXPECT_EQ(s.materials[0].ior, 1);
  EXPECT_EQ(s.lights[0].irradiance, (Rgb{1, 1, 1}));
  EXPECT_EQ(s.lights[0].fade_distance, 0);
  EXPECT_EQ(s.lights[0].fade_power, 2);
  EXPECT_EQ(s.lights[1].kind, LightKind::kDirectional);
  EXPECT_EQ(s.lights[1].to_light, (Vec3d{0, 1, 0}));
  EXPECT_EQ(s.cameras[0].up, (Vec3d{0, 1, 0}));
  EXPECT_EQ(s.cameras[0].fov_deg, 45);
}

TEST(LoadScene, NothingIsAScene) {
  EXPECT_TRUE(BuildText("").ok());
  EXPECT_TRUE(BuildText("name: \"empty\"").ok());
}

TEST(LoadScene, StepsApplyInTheOrderWritten) {
  const auto scene = BuildText(WithShape(
      "sphere { center { x: 1 } radius: 1 } transform { scale { x: 2 y: 2 z: 2 } } "
      "transform { rotate { axis { z: 1 } angle_deg: 90 } } transform { translate { x: 10 } }"));
  ASSERT_TRUE(scene.ok()) << scene.status();
  const Vec3d center = std::get<SphereShape>((*scene)->objects[0].shape).frame.center;
  EXPECT_NEAR(center.x, 10, 1e-15);
  EXPECT_NEAR(center.y, 2, 1e-15);
  const Box3 bounds = (*scene)->objects[0].bounds;
  EXPECT_NEAR(bounds.max.y, 4, 1e-12);
  EXPECT_NEAR(bounds.min.x, 8, 1e-12);
}

struct Limit {
  const char* name;
  uint64_t SceneLimits::*limit;
  uint64_t value;
  std::string text;
  const char* message;
};
class LimitTest : public testing::TestWithParam<Limit> {};

TEST_P(LimitTest, IsExhaustedBeyondIt) {
  SceneLimits limits;
  limits.*GetParam().limit = GetParam().value;
  EXPECT_TRUE(BuildText(GetParam().text).ok());
  const auto scene = BuildText(GetParam().text, limits);
  EXPECT_EQ(scene.status().code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(scene.status().message(), GetParam().message);
}

const char kArrow[] =
    "polygon { vertices { } vertices { x: 2 } vertices { x: 1 y: 0.2 } vertices { x: 1 y: 2 } }";

INSTANTIATE_TEST_SUITE_P(
    Limits, LimitTest,
    testing::Values(
        Limit{"Materials", &SceneLimits::max_materials, 1,
              "materials { name: \"a\" }\nmaterials { name: \"b\" }",
              "s.textproto:1:1: materials: expected at most 1, got 2"},
        Limit{"Lights", &SceneLimits::max_lights, 0, "lights { point { } }",
              "s.textproto:1:1: lights: expected at most 0, got 1"},
        Limit{"Cameras", &SceneLimits::max_cameras, 0, "\ncameras { eye { x: 1 } }",
              "s.textproto:2:1: cameras: expected at most 0, got 1"},
        Limit{"Objects", &SceneLimits::max_objects, 0, WithShape("sphere { radius: 1 }"),
              "s.textproto:2:1: objects: expected at most 0, got 1"},
        Limit{"Pieces", &SceneLimits::max_objects, 1, WithShape(kArrow),
              "s.textproto:2:1: objects: expected at most 1, got 2"},
        Limit{"Vertices", &SceneLimits::max_polygon_vertices, 3, WithShape(kArrow),
              "s.textproto:2:35: objects[0].polygon.vertices: expected at most 3, got 4"},
        Limit{"HalfSpaces", &SceneLimits::max_half_spaces, 3,
              WithShape("polyhedron { half_spaces { normal { x: -1 } } half_spaces { normal { y: "
                        "-1 } } half_spaces { normal { z: -1 } } half_spaces { normal { x: 1 y: 1 "
                        "z: 1 } offset: 1 } }"),
              "s.textproto:2:38: objects[0].polyhedron.half_spaces: expected at most 3, got 4"}),
    [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace linetree
