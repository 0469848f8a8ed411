#include "core/io/png.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/io/frames.h"
#include "tests/io/temp_dir.h"

namespace linetree {
namespace {

TEST(Png, RoundTripKeepsEveryByte) {
  TempDir dir;
  Picture8 picture{5, 3, {}};
  for (int i = 0; i < 45; ++i) picture.rgb.push_back(static_cast<uint8_t>(i * 37));
  ASSERT_EQ(WritePng(picture, dir.File("a.png")), absl::OkStatus());
  const absl::StatusOr<Picture8> read = ReadPng(dir.File("a.png"));
  ASSERT_EQ(read.status(), absl::OkStatus());
  EXPECT_EQ(read->width, 5);
  EXPECT_EQ(read->height, 3);
  EXPECT_EQ(read->rgb, picture.rgb);
}

TEST(Png, WhatIsNoPictureIsNamed) {
  TempDir dir;
  EXPECT_EQ(ReadPng(dir.File("none.png")).status().code(), absl::StatusCode::kNotFound);
  std::ofstream(dir.File("text.png")) << "not a picture";
  const absl::Status status = ReadPng(dir.File("text.png")).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(status.message()), ::testing::HasSubstr("text.png"));
}

}  // namespace
}  // namespace linetree
