#include "core/io/exr.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/io/frames.h"
#include "tests/io/temp_dir.h"

namespace linetree {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(Exr, RoundTripKeepsEveryBit) {
  TempDir dir;
  const Frame frame = MakeFrame(7, 5);
  ASSERT_EQ(WriteExr(frame, dir.File("a.exr")), absl::OkStatus());
  const absl::StatusOr<Frame> read = ReadExr(dir.File("a.exr"));
  ASSERT_EQ(read.status(), absl::OkStatus());
  EXPECT_EQ(read->width, 7);
  EXPECT_EQ(read->height, 5);
  EXPECT_EQ(read->radiance, frame.radiance);
  EXPECT_EQ(read->object, frame.object);
  EXPECT_EQ(read->source, frame.source);
  EXPECT_EQ(read->verdict, frame.verdict);
  EXPECT_EQ(read->depth, frame.depth);
  EXPECT_EQ(read->camera, frame.camera);
  EXPECT_EQ(read->max_relative_error, frame.max_relative_error);
  EXPECT_EQ(read->white, frame.white);
  EXPECT_EQ(read->scene_version, frame.scene_version);
  EXPECT_THAT(dir.Names(), ElementsAre("a.exr"));
}

TEST(Exr, RoundTripKeepsNonFiniteRadiance) {
  TempDir dir;
  Frame frame = MakeFrame(2, 2);
  frame.radiance[4] = std::numeric_limits<float>::quiet_NaN();
  frame.radiance[5] = std::numeric_limits<float>::infinity();
  ASSERT_EQ(WriteExr(frame, dir.File("a.exr")), absl::OkStatus());
  const absl::StatusOr<Frame> read = ReadExr(dir.File("a.exr"));
  ASSERT_EQ(read.status(), absl::OkStatus());
  EXPECT_TRUE(std::isnan(read->radiance[4]));
  EXPECT_TRUE(std::isinf(read->radiance[5]));
}

TEST(Exr, AFrameWithoutLayersHasBeautyOnly) {
  TempDir dir;
  Frame frame = MakeFrame(3, 2);
  frame.object.clear();
  frame.source.clear();
  frame.verdict.clear();
  frame.depth.clear();
  ASSERT_EQ(WriteExr(frame, dir.File("a.exr")), absl::OkStatus());
  const absl::StatusOr<Frame> read = ReadExr(dir.File("a.exr"));
  ASSERT_EQ(read.status(), absl::OkStatus());
  EXPECT_EQ(read->radiance, frame.radiance);
  EXPECT_THAT(read->object, IsEmpty());
  EXPECT_THAT(read->depth, IsEmpty());
}

// What other programs see: documented channel types, the background's number, the statistics.
TEST(Exr, HeaderIsAsDocumented) {
  TempDir dir;
  ASSERT_EQ(WriteExr(MakeFrame(3, 2), dir.File("a.exr")), absl::OkStatus());
  Imf::InputFile file(dir.File("a.exr").c_str());
  const Imf::ChannelList& channels = file.header().channels();
  for (const char* name : {"R", "G", "B", "Z"}) {
    ASSERT_NE(channels.findChannel(name), nullptr) << name;
    EXPECT_EQ(channels.findChannel(name)->type, Imf::FLOAT) << name;
  }
  for (const char* name : {"object", "source", "verdict"}) {
    ASSERT_NE(channels.findChannel(name), nullptr) << name;
    EXPECT_EQ(channels.findChannel(name)->type, Imf::UINT) << name;
  }
  EXPECT_EQ(file.header().compression(), Imf::ZIP_COMPRESSION);
  const auto* statistics = file.header().findTypedAttribute<Imf::StringAttribute>("statistics");
  ASSERT_NE(statistics, nullptr);
  EXPECT_EQ(nlohmann::json::parse(statistics->value())["pixels"], 6);
}

TEST(Exr, WhatIsNoPictureIsNamed) {
  TempDir dir;
  EXPECT_EQ(ReadExr(dir.File("none.exr")).status().code(), absl::StatusCode::kNotFound);
  std::ofstream(dir.File("text.exr")) << "not a picture";
  const absl::Status status = ReadExr(dir.File("text.exr")).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(status.message()), HasSubstr("text.exr: expected an OpenEXR file"));
}

TEST(Exr, AttributesThatErrorFiguresCannotUseAreRefused) {
  TempDir dir;
  Frame frame = MakeFrame(2, 2);
  frame.white = 0;
  ASSERT_EQ(WriteExr(frame, dir.File("a.exr")), absl::OkStatus());
  EXPECT_THAT(std::string(ReadExr(dir.File("a.exr")).status().message()),
              HasSubstr("a.exr: attribute white: expected a positive number, found 0"));
  frame.white = 1;
  frame.max_relative_error = -1;
  ASSERT_EQ(WriteExr(frame, dir.File("a.exr")), absl::OkStatus());
  EXPECT_EQ(ReadExr(dir.File("a.exr")).status().code(), absl::StatusCode::kInvalidArgument);
}

// OpenEXR goes on behind what a type takes, and would believe the sizes that it finds there.
TEST(Exr, AttributesOfOtherSizesThanTheirTypesAreRefused) {
  const std::string good = EncodeExr(MakeFrame(4, 3));
  ASSERT_TRUE(DecodeExr(good).ok());
  using namespace std::string_literals;
  for (const auto& attribute : {"dataWindow\0box2i\0"s, "fov_deg\0double\0"s, "eye\0v3d\0"s,
                                "channels\0chlist\0"s, "compression\0compression\0"s}) {
    const size_t at = good.find(attribute);
    ASSERT_NE(at, good.npos) << attribute;
    std::string bad = good;
    bad[at + attribute.size()] ^= 1;
    EXPECT_THAT(std::string(DecodeExr(bad).status().message()),
                HasSubstr("an attribute is not as large as its type"))
        << attribute;
  }
  std::string unknown = good;
  unknown.replace(unknown.find("fov_deg\0double"s) + 8, 6, "dbuole");
  EXPECT_EQ(DecodeExr(unknown).status().code(), absl::StatusCode::kInvalidArgument);
}

TEST(Exr, HalfAFileIsRefused) {
  TempDir dir;
  ASSERT_EQ(WriteExr(MakeFrame(64, 64), dir.File("a.exr")), absl::OkStatus());
  const auto size = std::filesystem::file_size(dir.File("a.exr"));
  std::filesystem::resize_file(dir.File("a.exr"), size / 2);
  EXPECT_EQ(ReadExr(dir.File("a.exr")).status().code(), absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace linetree
