#include <google/protobuf/util/message_differencer.h>
#include <gtest/gtest.h>

#include "tests/io/scene_fixture.h"

namespace linetree {
namespace {

TEST(SceneText, WritesWhatItReads) {
  v1::Scene scene;
  scene.set_name("quotes \" and \\ and \n and \xc3\xa9");
  // Numbers that need all seventeen digits, the smallest and the largest.
  for (const double x : {0.1, 1.0 / 3, 0.30000000000000004, 5e-324, 1.7976931348623157e308, -0.0}) {
    scene.add_objects()->mutable_sphere()->set_radius(x);
  }
  scene.mutable_objects(0)->add_transform()->mutable_matrix()->add_row_major_3x4(2.5);
  const auto source = ParseSceneText(WriteSceneText(scene), "s");
  ASSERT_TRUE(source.ok()) << source.status();
  EXPECT_TRUE(google::protobuf::util::MessageDifferencer::Equals((*source)->message(), scene));
}

TEST(SceneText, WhereFindsTheDeepestFieldThatIsWritten) {
  const auto source =
      ParseSceneText("name: \"a\"\nobjects {\n  sphere {\n    radius: 1 } }\n", "f");
  ASSERT_TRUE(source.ok()) << source.status();
  EXPECT_EQ((*source)->Where("name"), "f:1:1");
  EXPECT_EQ((*source)->Where("objects"), "f:2:1");
  EXPECT_EQ((*source)->Where("objects[0].sphere.radius"), "f:4:5");
  EXPECT_EQ((*source)->Where("objects[0].sphere.center.x"), "f:3:3");
  EXPECT_EQ((*source)->Where("objects[1].sphere"), "f");
  EXPECT_EQ((*source)->Where("white"), "f");
  EXPECT_EQ((*source)->Where(""), "f");
}

}  // namespace
}  // namespace linetree
