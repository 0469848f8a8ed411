#include "client/command/output.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/io/exr.h"
#include "core/io/png.h"
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

TEST(Output, MissingFoldersAreNoticedBeforehand) {
  TempDir dir;
  EXPECT_EQ(CheckFolders({dir.File("a.exr"), "b.exr"}), absl::OkStatus());
  const absl::Status status = CheckFolders({dir.File("none/a.exr")});
  EXPECT_EQ(status.code(), absl::StatusCode::kNotFound);
  EXPECT_THAT(std::string(status.message()), ::testing::HasSubstr("none/a.exr: no folder"));
}

}  // namespace
}  // namespace linetree
