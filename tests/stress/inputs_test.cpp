// NaN, infinity and extreme numbers at every numeric input of scenes: a clear error, or a scene
// whose answers are numbers.
#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "absl/strings/str_cat.h"
#include "core/io/load_scene.h"
#include "tests/stress/hard_rays.h"
#include "tests/stress/promise.h"

namespace linetree::stress {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kDenormal = std::numeric_limits<double>::denorm_min();

// Every message and every number that a scene may have.
constexpr const char* kEverything = R"(
  background { r: 0.1 g: 0.2 b: 0.3 } ambient { r: 0.2 g: 0.2 b: 0.2 } white: 2
  materials { name: "m" ambient { r: 0.5 g: 0.5 b: 0.5 } diffuse { r: 0.5 g: 0.5 b: 0.5 }
    specular { r: 0.1 g: 0.1 b: 0.1 } exponent: 20 reflect { r: 0.3 g: 0.3 b: 0.3 }
    transmit { r: 0.3 g: 0.3 b: 0.3 } ior: 1.5 }
  materials { name: "d" diffuse { r: 0.5 g: 0.5 b: 0.5 } }
  lights { irradiance { r: 1 g: 1 b: 1 }
    point { position { x: 3 y: 2 z: 5 } fade_distance: 4 fade_power: 2 } }
  lights { irradiance { r: 1 g: 1 b: 1 } directional { direction { x: 1 y: 2 z: -3 } } }
  objects { material: "m" sphere { center { x: 1 y: 1 z: 1 } radius: 0.5 } }
  objects { material: "d" ellipsoid { center { x: -1 y: 1 z: 1 }
    semi_axes { x: 0.5 y: 0.3 z: 0.2 } } }
  objects { material: "m" box { min { x: -2 y: -2 z: -1 } max { x: 2 y: 2 z: -0.5 } } }
  objects { material: "d" cylinder { base { x: 1 y: -1 z: 1 } top { x: 1 y: -1 z: 2 }
    radius: 0.3 } }
  objects { material: "d" cone { base { x: -1 y: -1 z: 1 } base_radius: 0.5
    top { x: -1 y: -1 z: 2 } top_radius: 0.1 open: true } }
  objects { material: "d" disc { center { x: 1 y: 1 z: 2 } normal { x: 1 y: 1 z: 2 }
    radius: 0.5 } }
  objects { material: "m" polygon { vertices { x: 1 y: 1 z: 3 } vertices { x: 2 y: 1 z: 3 }
    vertices { x: 2 y: 2 z: 3 } vertices { x: 1 y: 2 z: 3 } } }
  objects { material: "d" triangle { vertices { x: -1 y: 1 z: 3 } vertices { x: -2 y: 1 z: 3 }
    vertices { x: -2 y: 2 z: 3 } normals { x: 0.1 y: 0.1 z: 1 } normals { x: 0.1 y: 0.2 z: 1 }
    normals { x: 0.2 y: 0.1 z: 1 } } }
  objects { material: "d" polyhedron { half_spaces { normal { x: -1 y: -1 z: -1 } offset: 1 }
    half_spaces { normal { x: 1 y: 0.1 z: 0.1 } offset: 1 }
    half_spaces { normal { x: 0.1 y: 1 z: 0.1 } offset: 1 }
    half_spaces { normal { x: 0.1 y: 0.1 z: 1 } offset: 1 } }
    transform { translate { x: 0.5 y: 0.5 z: 0.5 } }
    transform { rotate { axis { x: 1 y: 2 z: 3 } angle_deg: 30 } }
    transform { scale { x: 2 y: 3 z: 4 } }
    transform { matrix { row_major_3x4: [1, 0.5, 0.25, 1, 0.25, 2, 0.5, 1, 0.5, 0.25, 3, 1] } } }
  cameras { eye { x: 1 y: 2 z: 9 } look_at { x: 0.5 y: 0.5 z: 1 } up { x: 0.1 y: 1 z: 0.2 }
    fov_deg: 50 })";

v1::Scene EverythingMessage() {
  const auto source = ParseSceneText(kEverything, "everything.textproto");
  EXPECT_TRUE(source.ok()) << source.status();
  return source.ok() ? (*source)->message() : v1::Scene();
}

// Calls visit(name) with one number after the other set to the value; the message is as before
// afterwards.
class Spoiler {
 public:
  Spoiler(google::protobuf::Message& root, double value,
          std::function<void(const std::string&)> visit)
      : value_(value), visit_(std::move(visit)) {
    Walk(root, "");
  }

 private:
  void Walk(google::protobuf::Message& message, const std::string& path) {
    const auto& reflection = *message.GetReflection();
    std::vector<const google::protobuf::FieldDescriptor*> fields;
    reflection.ListFields(message, &fields);
    for (const auto* field : fields) {
      const std::string name = absl::StrCat(path, ".", std::string(field->name()));
      const int count = field->is_repeated() ? reflection.FieldSize(message, field) : 1;
      for (int i = 0; i < count; ++i) {
        if (field->cpp_type() == google::protobuf::FieldDescriptor::CPPTYPE_DOUBLE) {
          Spoil(message, *field, i, name);
        } else if (field->cpp_type() == google::protobuf::FieldDescriptor::CPPTYPE_MESSAGE) {
          Walk(field->is_repeated() ? *reflection.MutableRepeatedMessage(&message, field, i)
                                    : *reflection.MutableMessage(&message, field),
               name);
        }
      }
    }
  }

  void Spoil(google::protobuf::Message& message, const google::protobuf::FieldDescriptor& field,
             int i, const std::string& name) {
    const auto& reflection = *message.GetReflection();
    if (field.is_repeated()) {
      const double before = reflection.GetRepeatedDouble(message, &field, i);
      reflection.SetRepeatedDouble(&message, &field, i, value_);
      visit_(name);
      reflection.SetRepeatedDouble(&message, &field, i, before);
    } else {
      const double before = reflection.GetDouble(message, &field);
      reflection.SetDouble(&message, &field, value_);
      visit_(name);
      reflection.SetDouble(&message, &field, before);
    }
  }

  const double value_;
  const std::function<void(const std::string&)> visit_;
};

TEST(InputsTest, EveryNumberOfASceneIsChecked) {
  v1::Scene message = EverythingMessage();
  ASSERT_TRUE(BuildScene(*SceneFromMessage(message)).ok());
  int refused = 0;
  for (const double bad : {kNaN, -kNaN, kInf, -kInf}) {
    Spoiler(message, bad, [&](const std::string& name) {
      const auto scene = BuildScene(*SceneFromMessage(message));
      ASSERT_FALSE(scene.ok()) << name << " = " << bad;
      EXPECT_EQ(scene.status().code(), absl::StatusCode::kInvalidArgument) << name;
      // The error names the field, or, of vectors, the field that holds the component.
      const auto last = name.rfind('.'), before = name.rfind('.', last - 1);
      const std::string text(scene.status().message());
      const std::string holder = name.substr(before + 1, last - before - 1);
      EXPECT_TRUE(text.find(name.substr(last + 1)) != text.npos || text.find(holder) != text.npos)
          << name << ": " << text;
      EXPECT_NE(text.find("expected"), text.npos) << text;
      ++refused;
    });
  }
  std::printf("%d numbers that are not finite were refused by name\n", refused);
  EXPECT_GT(refused, 400);
}

// Finite, and perhaps allowed: if so, what a ray answers is a number, cached as without.
TEST(InputsTest, ExtremeNumbersAreRefusedOrHarmless) {
  v1::Scene message = EverythingMessage();
  test::Random random = RandomFor("Extreme");
  Largest largest("ExtremeNumbers", 1, "of the promise");
  PromiseOptions options;
  options.bounds = {0, 0.05};
  options.rounds = 2;
  int refused = 0, allowed = 0;
  for (const double extreme : {0.0, -0.0, -1.0, kDenormal, -kDenormal, 1e-308, 1e-200, 1e-30, 1e30,
                               -1e30, 1e200, 1e308, -1e308}) {
    Spoiler(message, extreme, [&](const std::string& name) {
      const auto scene = BuildScene(*SceneFromMessage(message));
      ++(scene.ok() ? allowed : refused);
      if (!scene.ok()) {
        EXPECT_EQ(scene.status().code(), absl::StatusCode::kInvalidArgument) << name;
        return;
      }
      SCOPED_TRACE(absl::StrCat(name, " = ", extreme));
      ExpectPromise(*scene, HardRays(**scene, Times(100), random), largest, options);
    });
  }
  std::printf("%d refused, %d allowed\n", refused, allowed);
}

}  // namespace
}  // namespace linetree::stress
