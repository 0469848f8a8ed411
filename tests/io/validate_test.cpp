// One row per rule: what breaks it, and the message with its place.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/io/scene_fixture.h"

namespace linetree {
namespace {

struct Rule {
  const char* name;
  std::string text;
  std::string message;
};

class RuleTest : public testing::TestWithParam<Rule> {};

TEST_P(RuleTest, IsRefusedWithItsPlace) {
  const auto scene = BuildText(GetParam().text);
  ASSERT_FALSE(scene.ok());
  EXPECT_EQ(scene.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(scene.status().message()), testing::StartsWith(GetParam().message));
}

const auto kName = [](const auto& info) { return std::string(info.param.name); };

std::string Material(const std::string& fields) {
  return absl::StrCat("materials {\n  name: \"m\" ", fields, "\n}\n");
}

INSTANTIATE_TEST_SUITE_P(
    Materials, RuleTest,
    testing::Values(
        Rule{"NoName", "materials { }", "s.textproto:1:1: materials[0].name: expected a name"},
        Rule{"SameName", "materials { name: \"a\" }\nmaterials { name: \"a\" }",
             "s.textproto:2:13: materials[1].name: expected a name that no other has, got 'a'"},
        Rule{"BadText", "materials { name: \"\\377\" }",
             "s.textproto:1:13: materials[0].name: expected UTF-8 text"},
        Rule{"NegativeAmbient", Material("ambient { g: -0.5 }"),
             "s.textproto:2:23: materials[0].ambient.g: expected a number in [0, 1e+30], got -0.5"},
        Rule{"NanDiffuse", Material("diffuse { r: nan }"),
             "s.textproto:2:23: materials[0].diffuse.r: expected a number in [0, 1e+30], got nan"},
        Rule{"InfiniteSpecular", Material("specular { b: inf }"),
             "s.textproto:2:24: materials[0].specular.b: expected a number in [0, 1e+30], got inf"},
        Rule{"ReflectAboveOne", Material("reflect { r: 1.5 }"),
             "s.textproto:2:23: materials[0].reflect.r: expected a number in [0, 1], got 1.5"},
        Rule{"NegativeTransmit", Material("transmit { b: -1 }"),
             "s.textproto:2:24: materials[0].transmit.b: expected a number in [0, 1], got -1"},
        Rule{"NegativeExponent", Material("exponent: -1"),
             "s.textproto:2:13: materials[0].exponent: expected a number in [0, 1e+06], got -1"},
        Rule{"HugeExponent", Material("exponent: 2e6"),
             "s.textproto:2:13: materials[0].exponent: expected a number in [0, 1e+06], got "
             "2e+06"},
        Rule{"ZeroIor", Material("ior: 0"),
             "s.textproto:2:13: materials[0].ior: expected a number in [0.05, 20], got 0"},
        Rule{"NanIor", Material("ior: nan"),
             "s.textproto:2:13: materials[0].ior: expected a number in [0.05, 20], got nan"}),
    kName);

INSTANTIATE_TEST_SUITE_P(
    Globals, RuleTest,
    testing::Values(Rule{"Background", "background { r: -1 }",
                         "s.textproto:1:14: background.r: expected a number in [0, 1e+30], got -1"},
                    Rule{"Ambient", "ambient { b: nan }",
                         "s.textproto:1:11: ambient.b: expected a number in [0, 1e+30], got nan"},
                    Rule{"ZeroWhite", "white: 0",
                         "s.textproto:1:1: white: expected a finite number > 0, got 0"},
                    Rule{"InfiniteWhite", "\n  white: inf",
                         "s.textproto:2:3: white: expected a finite number > 0, got inf"},
                    Rule{"Name", "name: \"\\xc0\\x80\"",
                         "s.textproto:1:1: name: expected UTF-8 text"},
                    Rule{"Description", "description: \"\\xed\\xa0\\x80\"",
                         "s.textproto:1:1: description: expected UTF-8 text"}),
    kName);

INSTANTIATE_TEST_SUITE_P(
    Lights, RuleTest,
    testing::Values(
        Rule{"NoKind", "lights { name: \"sun\" }",
             "s.textproto:1:1: lights[0]: expected a kind of light: point or directional"},
        Rule{"NegativeIrradiance", "lights { irradiance { r: -1 } point { } }",
             "s.textproto:1:23: lights[0].irradiance.r: expected a number in [0, 1e+30], got -1"},
        Rule{"NanPosition", "lights { point { position { y: nan } } }",
             "s.textproto:1:18: lights[0].point.position: expected finite coordinates"},
        Rule{"NegativeFadeDistance", "lights { point { fade_distance: -2 } }",
             "s.textproto:1:18: lights[0].point.fade_distance: expected a finite number > 0, got "
             "-2"},
        Rule{"ZeroFadePower", "lights { point { fade_power: 0 } }",
             "s.textproto:1:18: lights[0].point.fade_power: expected a number in (0, 8], got 0"},
        Rule{"HighFadePower", "lights { point { fade_power: 9 } }",
             "s.textproto:1:18: lights[0].point.fade_power: expected a number in (0, 8], got 9"},
        Rule{"NoDirection", "lights { directional { } }",
             "s.textproto:1:10: lights[0].directional.direction: expected a finite, non-zero "
             "vector"},
        Rule{"InfiniteDirection", "lights { directional { direction { x: inf } } }",
             "s.textproto:1:24: lights[0].directional.direction: expected a finite, non-zero "
             "vector"},
        Rule{"Name", "lights { name: \"\\200\" point { } }",
             "s.textproto:1:10: lights[0].name: expected UTF-8 text"}),
    kName);

INSTANTIATE_TEST_SUITE_P(
    Cameras, RuleTest,
    testing::Values(
        Rule{"NoDistance", "cameras { eye { x: 1 } look_at { x: 1 } }",
             "s.textproto:1:24: cameras[0].look_at: expected a point other than"},
        Rule{"NanEye", "cameras { eye { x: nan } }",
             "s.textproto:1:11: cameras[0].eye: expected finite coordinates"},
        Rule{"HugeLookAt", "cameras { eye { x: 1 } look_at { z: 1e31 } }",
             "s.textproto:1:24: cameras[0].look_at: expected finite coordinates of magnitude <= "},
        Rule{"ZeroUp", "cameras { eye { x: 1 } up { } }",
             "s.textproto:1:24: cameras[0].up: expected a vector of finite, non-zero length"},
        Rule{"ParallelUp", "cameras { eye { x: 1 } up { x: 3 } }",
             "s.textproto:1:24: cameras[0].up: expected a vector that is not parallel"},
        Rule{"ZeroFov", "cameras { eye { x: 1 } fov_deg: 0 }",
             "s.textproto:1:24: cameras[0].fov_deg: expected an angle in (0, 180), got 0"},
        Rule{"NanFov", "cameras { eye { x: 1 } fov_deg: nan }",
             "s.textproto:1:24: cameras[0].fov_deg: expected an angle in (0, 180), got nan"},
        Rule{"SameName",
             "cameras { name: \"a\" eye { x: 1 } }\ncameras { name: \"a\" eye { x: 1 } }",
             "s.textproto:2:11: cameras[1].name: expected a name that no other has, got 'a'"},
        Rule{"Name", "cameras { name: \"\\377\" eye { x: 1 } }",
             "s.textproto:1:11: cameras[0].name: expected UTF-8 text"}),
    kName);

INSTANTIATE_TEST_SUITE_P(
    Objects, RuleTest,
    testing::Values(
        Rule{"NoMaterial", "objects { sphere { radius: 1 } }",
             "s.textproto:1:1: objects[0].material: expected the name of a material"},
        Rule{"UnknownMaterial", WithMaterial("objects { material: \"x\" sphere { radius: 1 } }"),
             "s.textproto:2:11: objects[0].material: expected the name of one of the scene's "
             "materials, got 'x'"},
        Rule{"NoShape", WithShape(""), "s.textproto:2:1: objects[0]: expected a shape (sphere, "},
        Rule{"SameName",
             WithMaterial("objects { name: \"a\" material: \"m\" sphere { radius: 1 } }\n"
                          "objects { name: \"a\" material: \"m\" sphere { radius: 1 } }"),
             "s.textproto:3:11: objects[1].name: expected a name that no other has, got 'a' again"},
        Rule{"Name", WithMaterial("objects { name: \"\\377\" material: \"m\" }"),
             "s.textproto:2:11: objects[0].name: expected UTF-8 text"}),
    kName);

std::string Transformed(const std::string& step) {
  return WithMaterial(
      absl::StrCat("objects { material: \"m\" sphere { radius: 1 }\ntransform { ", step, " } }"));
}

INSTANTIATE_TEST_SUITE_P(
    Transforms, RuleTest,
    testing::Values(
        Rule{"Empty", Transformed(""),
             "s.textproto:3:1: objects[0].transform[0]: expected translate, rotate, scale or "
             "matrix"},
        Rule{"NanTranslate", Transformed("translate { x: nan }"),
             "s.textproto:3:13: objects[0].transform[0].translate: expected finite coordinates"},
        Rule{"NoAxis", Transformed("rotate { angle_deg: 3 }"),
             "s.textproto:3:13: objects[0].transform[0].rotate.axis: expected a finite, non-zero"},
        Rule{"NanAngle", Transformed("rotate { axis { x: 1 } angle_deg: nan }"),
             "s.textproto:3:36: objects[0].transform[0].rotate.angle_deg: expected a number in"},
        Rule{"ZeroScale", Transformed("scale { x: 1 y: 1 }"),
             "s.textproto:3:13: objects[0].transform[0].scale: expected factors other than 0, got "
             "(1, 1, 0)"},
        Rule{"ShortMatrix", Transformed("matrix { row_major_3x4: [1, 2, 3] }"),
             "s.textproto:3:22: objects[0].transform[0].matrix.row_major_3x4: expected 12 numbers, "
             "got 3"},
        Rule{
            "NanMatrix", Transformed("matrix { row_major_3x4: [1,0,0,0, 0,1,0,nan, 0,0,1,0] }"),
            "s.textproto:3:22: objects[0].transform[0].matrix.row_major_3x4[7]: expected a number"},
        Rule{"Singular", Transformed("matrix { row_major_3x4: [1,0,0,0, 0,1,0,0, 1,1,0,0] }"),
             "s.textproto:3:1: objects[0].transform: expected an invertible map"},
        Rule{"TooLarge",
             Transformed("scale { x: 1e30 y: 1e30 z: 1e30 } } transform { scale { x: "
                         "1e9 y: 1e9 z: 1e9 }"),
             "s.textproto:3:1: objects[0].transform: expected a map that keeps coordinates"}),
    kName);

}  // namespace
}  // namespace linetree
