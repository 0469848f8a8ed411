#include "client/command/output.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/io/exr.h"
#include "core/io/jpeg.h"
#include "core/io/png.h"
#include "core/io/read_file.h"
#include "tests/io/frames.h"
#include "tests/io/temp_dir.h"

namespace linetree {
namespace {

TEST(Output, LayersAreNeededForExrAndForPicturesOfLayers) {
  EXPECT_FALSE(NeedsLayers({}));
  EXPECT_FALSE(NeedsLayers({.pictures = {"a.png"}}));
  EXPECT_TRUE(NeedsLayers({.pictures = {"a.png", "b.exr"}}));
  EXPECT_TRUE(NeedsLayers({.pictures = {"a.png"}, .layer = Layer::kVerdict}));
}

TEST(Output, TheExtensionDecides) {
  TempDir dir;
  const Frame frame = MakeFrame(5, 4);
  ASSERT_EQ(WritePicture(frame, Layer::kObject, dir.File("a.PNG")), absl::OkStatus());
  ASSERT_EQ(WritePicture(frame, Layer::kObject, dir.File("a.exr")), absl::OkStatus());
  EXPECT_EQ(ReadPng(dir.File("a.PNG"))->rgb, PaintLayer(frame, Layer::kObject).rgb);
  EXPECT_EQ(ReadExr(dir.File("a.exr"))->radiance, frame.radiance);
}

TEST(Output, PicturesAreWrittenAsTheyCame) {
  TempDir dir;
  const Frame frame = MakeFrame(5, 4);
  const auto bytes = [&](const std::string& name) {
    return *ReadFileAtMost(dir.File(name), 1 << 20);
  };
  ASSERT_EQ(WritePicture(frame, Layer::kObject, dir.File("a.jpg")), absl::OkStatus());
  EXPECT_EQ(DecodeJpeg(bytes("a.jpg"))->width, 5);
  Frame picture;
  picture.file = "what a server has sent";
  ASSERT_EQ(WritePicture(picture, Layer::kBeauty, dir.File("b.png")), absl::OkStatus());
  EXPECT_EQ(bytes("b.png"), picture.file);
}

TEST(Output, PicturesCannotBeMoreThanTheyAre) {
  const FrameFormat png{.codec = FrameCodec::kPng}, jpeg{.codec = FrameCodec::kJpeg};
  EXPECT_TRUE(CheckFormat({.pictures = {"a.exr", "a.png", "a.jpg"}}, {}).ok());
  EXPECT_TRUE(CheckFormat({.pictures = {"a.png"}}, png).ok());
  EXPECT_TRUE(CheckFormat({.pictures = {"a.jpg", "b.JPEG"}}, jpeg).ok());
  EXPECT_FALSE(CheckFormat({.pictures = {"a.png", "a.exr"}}, png).ok());
  EXPECT_FALSE(CheckFormat({.pictures = {"a.jpg"}}, png).ok());
  EXPECT_FALSE(CheckFormat({.pictures = {"a.png"}}, jpeg).ok());
  EXPECT_FALSE(CheckFormat({.pictures = {"a.png"}, .layer = Layer::kDepth}, png).ok());
}

TEST(Output, MissingFoldersAreNoticedBeforehand) {
  TempDir dir;
  EXPECT_EQ(CheckFolders({dir.File("a.exr"), "b.exr"}), absl::OkStatus());
  const absl::Status status = CheckFolders({dir.File("none/a.exr")});
  EXPECT_EQ(status.code(), absl::StatusCode::kNotFound);
  EXPECT_THAT(std::string(status.message()), ::testing::HasSubstr("none/a.exr: no folder"));
}

}  // namespace
}  // namespace linetree
