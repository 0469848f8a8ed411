#include "core/io/wire_frame.h"

#include <gtest/gtest.h>

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

std::vector<v1::FrameChunk> Cut(const Frame& frame, bool all_layers) {
  FrameChunks chunks(frame, all_layers);
  std::vector<v1::FrameChunk> messages;
  v1::FrameChunk chunk;
  while (chunks.Next(&chunk)) messages.push_back(chunk);
  return messages;
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
    FrameAssembler assembler(width, height, true);
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
  FrameAssembler assembler(128, 64, false);
  const auto chunks = Cut(CountedFrame(128, 64), false);
  EXPECT_EQ(assembler.share_done(), 0);
  ASSERT_TRUE(assembler.Add(chunks[0]).ok());
  EXPECT_EQ(assembler.share_done(), 0.5);
  ASSERT_TRUE(assembler.Add(chunks[1]).ok());
  EXPECT_EQ(assembler.share_done(), 1);
}

TEST(WireFrameTest, WithoutAllLayersThereIsOnlyRadiance) {
  const Frame frame = CountedFrame(70, 3);
  FrameAssembler assembler(70, 3, false);
  ASSERT_TRUE(AddAll(assembler, Cut(frame, false)).ok());
  const Frame back = assembler.Take();
  EXPECT_EQ(back.radiance, frame.radiance);
  EXPECT_TRUE(back.object.empty());
  EXPECT_TRUE(back.depth.empty());
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
  FrameAssembler assembler(100, 70, true);
  EXPECT_TRUE(absl::IsDataLoss(AddAll(assembler, chunks)));
}

using Chunks = std::vector<v1::FrameChunk>;
const Damage kDamages[] = {
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
    {"no_sources", [](Chunks& c) { c[0].mutable_tile()->clear_source(); }},
    {"unknown_source", [](Chunks& c) { (*c[0].mutable_tile()->mutable_source())[5] = 5; }},
    {"unknown_verdict", [](Chunks& c) { (*c[0].mutable_tile()->mutable_verdict())[5] = '\xff'; }},
};
INSTANTIATE_TEST_SUITE_P(All, WireFrameDamage, testing::ValuesIn(kDamages),
                         [](const auto& info) { return info.param.what; });

}  // namespace
}  // namespace linetree
