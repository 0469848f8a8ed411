#include "core/io/scene_edit.h"

#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <random>

#include "absl/status/statusor.h"
#include "core/io/load_scene.h"

namespace linetree {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

template <class Message>
Message Read(const std::string& text) {
  Message message;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &message)) << text;
  return message;
}

v1::Scene TwoBalls() {
  return Read<v1::Scene>(R"(
    materials { name: "red" }
    lights { name: "lamp" point {} }
    lights { name: "sun" directional { direction { y: -1 } } }
    objects { name: "a" material: "red" sphere { radius: 1 } transform { translate { x: 1 } } }
    objects { name: "b" material: "red" sphere { radius: 2 } })");
}

// The scene after the edits, or why there is none.
absl::StatusOr<v1::Scene> Edited(const std::string& edits) {
  v1::Scene scene = TwoBalls();
  const auto request = Read<v1::UpdateSceneRequest>(edits);
  if (auto status = ApplyEdits(request.edits(), scene); !status.ok()) return status;
  return scene;
}

SceneVersion VersionOfMessage(const v1::Scene& message) {
  const auto scene = BuildScene(*SceneFromMessage(message));
  EXPECT_TRUE(scene.ok()) << scene.status();
  return scene.ok() ? (*scene)->version : SceneVersion();
}

std::vector<std::string> ObjectNames(const v1::Scene& scene) {
  std::vector<std::string> names;
  for (const auto& object : scene.objects()) names.push_back(object.name());
  return names;
}

TEST(SceneEditTest, MovesComeAfterTheTransformsThatAreThere) {
  const auto scene = Edited(R"(edits { move_object {
    object { name: "a" } transform { rotate { axis { z: 1 } angle_deg: 90 } } } })");
  ASSERT_TRUE(scene.ok()) << scene.status();
  v1::Scene unfolded = TwoBalls();
  auto& turn = *unfolded.mutable_objects(0)->add_transform()->mutable_rotate();
  turn.mutable_axis()->set_z(1);
  turn.set_angle_deg(90);
  EXPECT_EQ(VersionOfMessage(*scene), VersionOfMessage(unfolded));
  EXPECT_NE(VersionOfMessage(*scene), VersionOfMessage(TwoBalls()));
}

// A scene that is moved again and again stays as large as it is, and means what all steps mean.
TEST(SceneEditTest, ManyMovesAreOneStep) {
  v1::Scene folded = TwoBalls(), unfolded = TwoBalls();
  std::mt19937_64 random(20261123);
  std::uniform_real_distribution<double> number(-2, 2);
  for (int move = 0; move < 1000; ++move) {
    v1::UpdateSceneRequest request;
    v1::MoveObject& edit = *request.add_edits()->mutable_move_object();
    edit.mutable_object()->set_name("a");
    v1::TransformStep& step = *edit.add_transform();
    if (move % 3 == 0) {
      step.mutable_translate()->set_x(number(random));
    } else if (move % 3 == 1) {
      step.mutable_rotate()->mutable_axis()->set_y(1);
      step.mutable_rotate()->mutable_axis()->set_z(number(random));
      step.mutable_rotate()->set_angle_deg(90 * number(random));
    } else {
      for (const auto set : {&v1::Vec3::set_x, &v1::Vec3::set_y, &v1::Vec3::set_z}) {
        (step.mutable_scale()->*set)(move % 2 == 0 ? 2 : 0.5);
      }
    }
    ASSERT_TRUE(ApplyEdits(request.edits(), folded).ok());
    *unfolded.mutable_objects(0)->add_transform() = step;
    if (move % 100 == 0) {
      EXPECT_EQ(VersionOfMessage(folded), VersionOfMessage(unfolded)) << move;
    }
  }
  EXPECT_EQ(folded.objects(0).transform_size(), 1);
  EXPECT_EQ(VersionOfMessage(folded), VersionOfMessage(unfolded));
}

TEST(SceneEditTest, StepsThatAreWrongAreLeftForTheirError) {
  const auto scene = Edited(R"(edits { move_object {
    object { name: "a" } transform { scale { x: 1 y: 0 z: 1 } } } })");
  ASSERT_TRUE(scene.ok()) << scene.status();
  const auto built = BuildScene(*SceneFromMessage(*scene));
  EXPECT_THAT(std::string(built.status().message()), HasSubstr("objects[0].transform[1].scale"));
}

TEST(SceneEditTest, ObjectsComeGoAndChange) {
  const auto scene = Edited(R"(
    edits { add_object { name: "c" material: "red" sphere { radius: 3 } } }
    edits { remove_object { index: 0 } }
    edits { replace_object { object { index: 0 } with { name: "d" } } }
    edits { set_material { object { name: "c" } material: "blue" } })");
  ASSERT_TRUE(scene.ok()) << scene.status();
  EXPECT_THAT(ObjectNames(*scene), ElementsAre("d", "c"));
  EXPECT_EQ(scene->objects(1).material(), "blue");
}

TEST(SceneEditTest, MaterialsAreReplacedByNameOrAdded) {
  const auto scene = Edited(R"(
    edits { put_material { name: "red" exponent: 7 } }
    edits { put_material { name: "blue" } })");
  ASSERT_TRUE(scene.ok()) << scene.status();
  ASSERT_EQ(scene->materials_size(), 2);
  EXPECT_EQ(scene->materials(0).exponent(), 7);
  EXPECT_EQ(scene->materials(1).name(), "blue");
}

TEST(SceneEditTest, LightsComeGoAndChange) {
  const auto scene = Edited(R"(
    edits { add_light { name: "new" } }
    edits { remove_light { name: "lamp" } }
    edits { replace_light { light { index: 0 } with { name: "moon" } } })");
  ASSERT_TRUE(scene.ok()) << scene.status();
  ASSERT_EQ(scene->lights_size(), 2);
  EXPECT_EQ(scene->lights(0).name(), "moon");
  EXPECT_EQ(scene->lights(1).name(), "new");
}

TEST(SceneEditTest, ErrorsNameTheFieldAndWhatWasExpected) {
  const auto expect_error = [](const std::string& edits, const std::string& message) {
    const auto scene = Edited(edits);
    EXPECT_TRUE(absl::IsInvalidArgument(scene.status())) << scene.status();
    EXPECT_THAT(std::string(scene.status().message()), HasSubstr(message));
  };
  expect_error("edits {}", "edits[0]: expected one of the edits");
  expect_error("edits { remove_object { index: 2 } }",
               "edits[0].remove_object.index: expected a number below 2, got 2");
  expect_error("edits { remove_object {} }",
               "edits[0].remove_object: expected either index or name");
  expect_error(R"(edits { add_light {} } edits { remove_light { name: "x" } })",
               "edits[1].remove_light.name: nothing has the name 'x'");
  expect_error(R"(edits { add_object { name: "a" } }
                  edits { set_material { object { name: "a" } material: "red" } })",
               "edits[1].set_material.object.name: expected a name that only one has");
}

}  // namespace
}  // namespace linetree
