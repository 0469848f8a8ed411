#include "core/io/proto_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "linetree/v1/camera_path.pb.h"

namespace linetree {
namespace {

constexpr char kText[] = "name: \"a\"\nkeyframes {\n  camera {\n    eye { x: 1 }\n  }\n}\n";

TEST(ProtoText, ParsesOrSaysWhere) {
  v1::CameraPath message;
  EXPECT_EQ(ParseProtoText(kText, "f", &message), absl::OkStatus());
  EXPECT_EQ(message.keyframes(0).camera().eye().x(), 1);
  const absl::Status status = ParseProtoText("name: \"a\"\n  title: 3", "f", &message);
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(status.message()), ::testing::StartsWith("f:2:8: "));
}

TEST(ProtoText, KnowsWhereFieldsStand) {
  const v1::CameraPath type;
  EXPECT_EQ(WhereInProtoText(kText, "f", type, "name"), "f:1:1");
  EXPECT_EQ(WhereInProtoText(kText, "f", type, "keyframes[0].camera.eye"), "f:4:5");
}

TEST(ProtoText, TheDeepestPartThatIsThereStandsForTheRest) {
  const v1::CameraPath type;
  EXPECT_EQ(WhereInProtoText(kText, "f", type, "keyframes[0].camera.up.x"), "f:3:3");
  EXPECT_EQ(WhereInProtoText(kText, "f", type, "keyframes[7].time_s"), "f");
  EXPECT_EQ(WhereInProtoText(kText, "f", type, "frames"), "f");
}

}  // namespace
}  // namespace linetree
