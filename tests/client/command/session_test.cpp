#include "client/command/session.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/io/temp_dir.h"

namespace linetree {
namespace {

using ::testing::HasSubstr;

const std::string kGap = std::string(LINETREE_SOURCE_DIR) + "/scenes/gap.textproto";

TEST(Session, FilesAndNamesAreTold) {
  EXPECT_TRUE(IsSceneFile("scenes/room"));
  EXPECT_TRUE(IsSceneFile("room.textproto"));
  EXPECT_TRUE(IsSceneFile("balls.NFF"));
  EXPECT_FALSE(IsSceneFile("room"));
  EXPECT_FALSE(IsSceneFile("balls_3"));
}

TEST(Session, ASceneIsNamedAfterItsFile) {
  const absl::StatusOr<Session> session = OpenSession({.local = true}, {.scene = kGap});
  ASSERT_EQ(session.status(), absl::OkStatus());
  EXPECT_EQ(session->scene.name(), "gap");
  EXPECT_EQ(session->scene.objects(), 3u);
}

TEST(Session, ErrorsInAFileSayWhere) {
  TempDir dir;
  std::ofstream(dir.File("bad.textproto"))
      << "materials { name: \"m\" }\nobjects {\n  material: \"m\"\n"
         "  sphere { radius: -1 }\n}\n";
  const absl::Status status =
      OpenSession({.local = true}, {.scene = dir.File("bad.textproto")}).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(status.message()), HasSubstr("bad.textproto:4:"));
  EXPECT_THAT(std::string(status.message()), HasSubstr("objects[0].sphere.radius"));
}

TEST(Session, LocallyANameIsNotEnough) {
  const absl::Status status = OpenSession({.local = true}, {.scene = "room"}).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kNotFound);
  EXPECT_THAT(std::string(status.message()), HasSubstr("with --local a scene is given as a file"));
}

}  // namespace
}  // namespace linetree
