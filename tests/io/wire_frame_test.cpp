#include "core/io/wire_frame.h"

#include <Imath/half.h>
#include <gtest/gtest.h>

#include <fstream>
#include <random>

#include "core/io/exr.h"
#include "core/io/jpeg.h"
#include "core/io/layer_colors.h"
#include "core/io/png.h"
#include "tests/io/temp_dir.h"

namespace linetree {
namespace {

// Every pixel of every layer differs from its neighbours.
Frame CountedFrame(int width, int height) {
  Frame frame;
  frame.width = width;
  frame.height = height;
  for (int i = 0; i < width * height; ++i) {
    for (int c = 0; c < 3; ++c) frame.radiance.push_back(static_cast<float>(3 * i + c));
    frame.object.push_back(i - 1);
    frame.source.push_back(static_cast<Source>(i % 3));
    frame.verdict.push_back(static_cast<Verdict>(i % kVerdictCount));
    frame.depth.push_back(0.5f * static_cast<float>(i));
  }
  frame.camera.name = "side";
  frame.max_relative_error = 0.25;
  frame.white = 3;
  frame.scene_version = "version";
  frame.stats.pixels = static_cast<uint64_t>(width * height);
  return frame;
}

std::vector<v1::FrameChunk> Cut(const Frame& frame, const FrameFormat& format) {
  auto chunks = FrameChunks::Make(frame, format);
  EXPECT_TRUE(chunks.ok()) << chunks.status();
  std::vector<v1::FrameChunk> messages;
  v1::FrameChunk chunk;
  while (chunks->Next(&chunk)) {
    EXPECT_LE(chunk.ByteSizeLong(), kMaxChunkBytes);
    messages.push_back(chunk);
  }
  return messages;
}

std::vector<v1::FrameChunk> Cut(const Frame& frame, bool all_layers) {
  return Cut(frame, FrameFormat{.all_layers = all_layers});
}

// What the parts of a file hold together.
std::string FileOf(const std::vector<v1::FrameChunk>& chunks) {
  std::string file;
  for (const auto& chunk : chunks) {
    if (chunk.has_end()) break;
    EXPECT_EQ(chunk.file().offset(), file.size());
    file += chunk.file().data();
  }
  EXPECT_EQ(chunks[0].file().file_bytes(), file.size());
  return file;
}

absl::Status AddAll(FrameAssembler& assembler, const std::vector<v1::FrameChunk>& chunks) {
  for (const auto& chunk : chunks) {
    if (auto status = assembler.Add(chunk); !status.ok()) return status;
  }
  return absl::OkStatus();
}

TEST(WireFrameTest, AFrameLosesNothing) {
  for (const auto& [width, height] : {std::pair(1, 1), {64, 64}, {65, 64}, {100, 70}, {130, 1}}) {
    const Frame frame = CountedFrame(width, height);
    FrameAssembler assembler(width, height, {.all_layers = true});
    ASSERT_TRUE(AddAll(assembler, Cut(frame, true)).ok());
    ASSERT_TRUE(assembler.complete());
    const Frame back = assembler.Take();
    EXPECT_EQ(back.radiance, frame.radiance) << width << "x" << height;
    EXPECT_EQ(back.object, frame.object);
    EXPECT_EQ(back.source, frame.source);
    EXPECT_EQ(back.verdict, frame.verdict);
    EXPECT_EQ(back.depth, frame.depth);
    EXPECT_EQ(back.camera, frame.camera);
    EXPECT_EQ(back.max_relative_error, frame.max_relative_error);
    EXPECT_EQ(back.white, frame.white);
    EXPECT_EQ(back.scene_version, frame.scene_version);
    EXPECT_EQ(back.stats.pixels, frame.stats.pixels);
  }
}

TEST(WireFrameTest, TilesComeInRowMajorOrderAndTheEndLast) {
  const auto chunks = Cut(CountedFrame(100, 70), false);
  ASSERT_EQ(chunks.size(), 5u);
  const std::vector<std::array<uint32_t, 4>> expected = {
      {0, 0, 64, 64}, {64, 0, 36, 64}, {0, 64, 64, 6}, {64, 64, 36, 6}};
  for (size_t i = 0; i < 4; ++i) {
    const v1::Tile& tile = chunks[i].tile();
    EXPECT_EQ((std::array{tile.x(), tile.y(), tile.width(), tile.height()}), expected[i]);
    EXPECT_EQ(tile.object_size(), 0);
  }
  EXPECT_TRUE(chunks[4].has_end());
}

TEST(WireFrameTest, TheShareDoneGrowsToOne) {
  FrameAssembler assembler(128, 64, {});
  const auto chunks = Cut(CountedFrame(128, 64), false);
  EXPECT_EQ(assembler.share_done(), 0);
  ASSERT_TRUE(assembler.Add(chunks[0]).ok());
  EXPECT_EQ(assembler.share_done(), 0.5);
  ASSERT_TRUE(assembler.Add(chunks[1]).ok());
  EXPECT_EQ(assembler.share_done(), 1);
}

TEST(WireFrameTest, WithoutAllLayersThereIsOnlyRadiance) {
  const Frame frame = CountedFrame(70, 3);
  FrameAssembler assembler(70, 3, {});
  ASSERT_TRUE(AddAll(assembler, Cut(frame, false)).ok());
  const Frame back = assembler.Take();
  EXPECT_EQ(back.radiance, frame.radiance);
  EXPECT_TRUE(back.object.empty());
  EXPECT_TRUE(back.depth.empty());
}

TEST(WireFrameTest, TilesOfMostBytesStayBelowTheBound) {
  Frame frame = CountedFrame(128, 128);
  std::fill(frame.object.begin(), frame.object.end(), -1);  // takes most as a varint
  EXPECT_EQ(Cut(frame, true).size(), 5u);
}

TEST(WireFrameTest, HalvesAreTheFloatsRounded) {
  Frame frame = CountedFrame(70, 66);
  frame.radiance[5] = 1e-6f;
  frame.radiance[6] = 1e9f;
  for (const bool all_layers : {false, true}) {
    size_t values = 0;
    for (const auto& chunk : Cut(frame, {all_layers, FrameCodec::kHalf})) {
      const v1::Tile& tile = chunk.tile();
      EXPECT_EQ(tile.radiance_size(), 0);
      EXPECT_EQ(static_cast<size_t>(tile.depth_size()),
                all_layers ? tile.radiance_half().size() / 6 : 0);
      for (size_t i = 0; i < tile.radiance_half().size() / 2; ++i, ++values) {
        const auto byte = [&](size_t k) {
          return static_cast<unsigned>(static_cast<uint8_t>(tile.radiance_half()[k]));
        };
        Imath::half value;
        value.setBits(static_cast<uint16_t>(byte(2 * i) | byte(2 * i + 1) << 8));
        const size_t x = tile.x() + i / 3 % tile.width(), y = tile.y() + i / 3 / tile.width();
        const float sent = frame.radiance[3 * (y * 70 + x) + i % 3];
        if (sent > 65519) {
          EXPECT_TRUE(value.isInfinity());
        } else {
          EXPECT_LE(std::abs(value - sent), std::max(0x1p-11 * sent, 0x1p-25)) << sent;
        }
      }
    }
    EXPECT_EQ(values, frame.radiance.size());
  }
}

TEST(WireFrameTest, FilesAreWhatTheyWouldBeOnDisk) {
  Frame frame = CountedFrame(400, 300);
  std::mt19937 random(7);  // several parts, however they are compressed
  for (float& value : frame.radiance) value = static_cast<float>(random() % 360'000);
  const TempDir folder;
  const auto chunks = Cut(frame, {true, FrameCodec::kExr});
  EXPECT_GT(chunks.size(), 3u);
  const std::string path = folder.File("sent.exr");
  std::ofstream(path, std::ios::binary) << FileOf(chunks);
  const auto exr = ReadExr(path);
  ASSERT_TRUE(exr.ok()) << exr.status();
  EXPECT_EQ(exr->radiance, frame.radiance);
  EXPECT_EQ(exr->object, frame.object);
  EXPECT_EQ(chunks.back().end().white(), frame.white);
  EXPECT_EQ(chunks.back().end().stats().width(), 400u);
  std::ofstream(path, std::ios::binary) << FileOf(Cut(frame, {false, FrameCodec::kExr}));
  EXPECT_TRUE(ReadExr(path)->object.empty());

  frame = CountedFrame(400, 300);
  frame.white = 360'000;  // what its radiance goes up to
  const Picture8 shown = PaintLayer(frame, Layer::kBeauty);
  EXPECT_EQ(FileOf(Cut(frame, {false, FrameCodec::kPng})), *EncodePng(shown));
  const std::string jpeg = FileOf(Cut(frame, {false, FrameCodec::kJpeg, 95}));
  EXPECT_LT(FileOf(Cut(frame, {false, FrameCodec::kJpeg, 20})).size(), jpeg.size());
  const auto decoded = DecodeJpeg(jpeg);
  ASSERT_TRUE(decoded.ok()) << decoded.status();
  ASSERT_EQ(decoded->rgb.size(), shown.rgb.size());
  double sum = 0;
  for (size_t i = 0; i < shown.rgb.size(); ++i) {
    sum += std::abs(int{decoded->rgb[i]} - int{shown.rgb[i]});
  }
  EXPECT_LT(sum / static_cast<double>(shown.rgb.size()), 3) << "codes of 255";
  EXPECT_TRUE(absl::IsInvalidArgument(DecodeJpeg("no picture").status()));
}

TEST(WireFrameTest, EveryFormIsPutTogetherAgain) {
  Frame frame = CountedFrame(100, 70);
  for (float& value : frame.radiance) value = std::fmod(value, 2048.f);  // halves hold these
  for (const FrameCodec codec : {FrameCodec::kFloat, FrameCodec::kHalf, FrameCodec::kExr,
                                 FrameCodec::kPng, FrameCodec::kJpeg}) {
    for (const bool all_layers : {false, true}) {
      if (all_layers && !HoldsLayers(codec)) continue;
      const FrameFormat format{all_layers, codec};
      FrameAssembler assembler(100, 70, format);
      ASSERT_TRUE(AddAll(assembler, Cut(frame, format)).ok());
      EXPECT_EQ(assembler.share_done(), 1);
      ASSERT_TRUE(assembler.complete());
      const Frame back = assembler.Take();
      EXPECT_EQ(back.scene_version, frame.scene_version);
      EXPECT_EQ(back.file, IsFile(codec) ? FileOf(Cut(frame, format)) : "");
      if (!HoldsLayers(codec)) {
        EXPECT_TRUE(back.radiance.empty());
        continue;
      }
      EXPECT_EQ(back.radiance, frame.radiance);
      EXPECT_EQ(back.object, all_layers ? frame.object : PixelLayer<int32_t>());
      EXPECT_EQ(back.verdict, all_layers ? frame.verdict : PixelLayer<Verdict>());
      EXPECT_EQ(back.depth, all_layers ? frame.depth : PixelLayer<float>());
    }
  }
}

TEST(WireFrameTest, WhatAsksForAFormatIsReadBack) {
  for (const FrameFormat& format :
       {FrameFormat{}, FrameFormat{true, FrameCodec::kExr},
        FrameFormat{false, FrameCodec::kJpeg, 7}, FrameFormat{true, FrameCodec::kHalf},
        FrameFormat{false, FrameCodec::kPng}}) {
    v1::RenderFrameRequest request;
    FrameFormatToWire(format, &request);
    const auto back = FrameFormatFromWire(request, "");
    ASSERT_TRUE(back.ok()) << back.status();
    EXPECT_EQ(back->all_layers, format.all_layers);
    EXPECT_EQ(back->codec, format.codec);
    EXPECT_EQ(back->jpeg_quality, format.jpeg_quality);
  }
}

TEST(WireFrameTest, PartsThatDoNotFitAreDataLoss) {
  const FrameFormat format{.codec = FrameCodec::kExr};
  Frame noise = CountedFrame(400, 300);
  std::mt19937 random(7);  // several parts, however they are compressed
  for (float& value : noise.radiance) value = static_cast<float>(random() % 360'000);
  const auto good = Cut(noise, format);
  ASSERT_GT(good.size(), 3u);
  const auto expect_refused = [&](auto damage) {
    auto chunks = good;
    damage(chunks);
    FrameAssembler assembler(400, 300, format);
    EXPECT_TRUE(absl::IsDataLoss(AddAll(assembler, chunks)));
  };
  using Parts = std::vector<v1::FrameChunk>;
  expect_refused([](Parts& c) { c.erase(c.begin()); });
  expect_refused([](Parts& c) { c.erase(c.begin() + 1); });
  expect_refused([](Parts& c) { c.insert(c.begin(), c[0]); });
  expect_refused([](Parts& c) { c.erase(c.begin(), c.end() - 1); });
  expect_refused([](Parts& c) { c[1].mutable_file()->set_file_bytes(1); });
  expect_refused([](Parts& c) { c[0].mutable_file()->set_file_bytes(~uint64_t{0}); });
  expect_refused([](Parts& c) { c[0].mutable_file()->clear_data(); });
  expect_refused([](Parts& c) { c[0].mutable_tile()->set_width(1); });
  expect_refused([](Parts& c) { (*c[0].mutable_file()->mutable_data())[0] ^= 1; });
  expect_refused([](Parts& c) { *c[1].mutable_file()->mutable_data() += "more"; });
  expect_refused([](Parts& c) { c = Cut(CountedFrame(300, 400), {.codec = FrameCodec::kExr}); });
  expect_refused([](Parts& c) { c = Cut(CountedFrame(400, 300), {true, FrameCodec::kExr}); });
  // A file that ends early, and says so.
  expect_refused([](Parts& c) {
    c.erase(c.begin() + 1, c.end() - 1);
    c[0].mutable_file()->set_file_bytes(c[0].file().data().size());
  });
}

// What a sender may do to the chunks of a 100 x 70 frame that must not get through.
struct Damage {
  const char* what;
  void (*apply)(std::vector<v1::FrameChunk>& chunks);
};

class WireFrameDamage : public testing::TestWithParam<Damage> {};

TEST_P(WireFrameDamage, IsDataLoss) {
  auto chunks = Cut(CountedFrame(100, 70), true);
  GetParam().apply(chunks);
  FrameAssembler assembler(100, 70, {.all_layers = true});
  EXPECT_TRUE(absl::IsDataLoss(AddAll(assembler, chunks)));
}

using Chunks = std::vector<v1::FrameChunk>;
const Damage kDamages[] = {
    {"a_file", [](Chunks& c) { c[0].mutable_file()->set_file_bytes(1); }},
    {"missing_tile", [](Chunks& c) { c.erase(c.begin() + 1); }},
    {"tile_twice", [](Chunks& c) { c.insert(c.begin(), c[0]); }},
    {"nothing_in_it", [](Chunks& c) { c[0].clear_content(); }},
    {"chunk_after_the_end", [](Chunks& c) { c.push_back(c[0]); }},
    {"no_width", [](Chunks& c) { c[0].mutable_tile()->set_width(0); }},
    {"beyond_the_right", [](Chunks& c) { c[1].mutable_tile()->set_x(65); }},
    {"beyond_the_bottom", [](Chunks& c) { c[2].mutable_tile()->set_y(4294967295u); }},
    {"too_little_radiance",
     [](Chunks& c) { c[0].mutable_tile()->mutable_radiance()->RemoveLast(); }},
    {"too_many_objects", [](Chunks& c) { c[0].mutable_tile()->add_object(1); }},
    {"halves_too", [](Chunks& c) { c[0].mutable_tile()->set_radiance_half("ab"); }},
    {"no_sources", [](Chunks& c) { c[0].mutable_tile()->clear_source(); }},
    {"unknown_source", [](Chunks& c) { (*c[0].mutable_tile()->mutable_source())[5] = 5; }},
    {"unknown_verdict", [](Chunks& c) { (*c[0].mutable_tile()->mutable_verdict())[5] = '\xff'; }},
};
INSTANTIATE_TEST_SUITE_P(All, WireFrameDamage, testing::ValuesIn(kDamages),
                         [](const auto& info) { return info.param.what; });

}  // namespace
}  // namespace linetree
