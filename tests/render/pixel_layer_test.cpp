#include "core/render/pixel_layer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <thread>

#include "core/render/scene_host.h"
#include "tests/support/demo_scenes.h"
#include "tests/support/render_frame.h"

namespace linetree {
namespace {

constexpr size_t kLarge = size_t{3} << 20;

TEST(PixelLayerTest, BlocksComeBack) {
  PixelLayer<uint8_t> layer(kLarge, 7);
  const uint8_t* block = layer.data();
  const size_t before = IdleLayerBytes();
  layer = {};
  layer.shrink_to_fit();
  const size_t after = IdleLayerBytes();
  EXPECT_GE(after, before + kLarge);
  PixelLayer<uint8_t> next;
  next.resize(kLarge);
  EXPECT_EQ(next.data(), block);
  EXPECT_LT(IdleLayerBytes(), after);
  next.assign(kLarge, 9);
  EXPECT_EQ(std::count(next.begin(), next.end(), 9), static_cast<std::ptrdiff_t>(kLarge));
}

TEST(PixelLayerTest, NoMoreIsKeptThanAllowed) {
  {
    std::vector<PixelLayer<uint8_t>> layers(40);
    for (auto& layer : layers) layer.resize(2 * kLarge);
    PixelLayer<uint8_t> huge;
    huge.resize(kMostIdleLayerBytes + 1);
  }
  EXPECT_LE(IdleLayerBytes(), kMostIdleLayerBytes);
  EXPECT_GT(IdleLayerBytes(), kMostIdleLayerBytes / 2);
}

TEST(PixelLayerTest, ItemsHaveTheValueThatTheyAreGiven) {
  for (const size_t size : {size_t{10}, kLarge}) {
    PixelLayer<int32_t> layer(size, -3);
    layer.resize(size + 5, 8);
    EXPECT_EQ(std::count(layer.begin(), layer.end(), -3), static_cast<std::ptrdiff_t>(size));
    EXPECT_EQ(layer.back(), 8);
  }
}

TEST(PixelLayerTest, ThreadsDoNotShareBlocks) {
  std::vector<std::thread> threads;
  for (uint8_t mine = 1; mine <= 4; ++mine) {
    threads.emplace_back([mine] {
      for (int repeat = 0; repeat < 20; ++repeat) {
        PixelLayer<uint8_t> layer;
        layer.resize(kLeastLayerBytes);
        std::fill(layer.begin(), layer.end(), mine);
        ASSERT_EQ(std::count(layer.begin(), layer.end(), mine),
                  static_cast<std::ptrdiff_t>(kLeastLayerBytes));
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
}

// Leaves blocks that are full of `byte` to the frames of that size that come next.
void Fill(int width, int height, uint8_t byte) {
  const auto pixels = static_cast<size_t>(width) * static_cast<size_t>(height);
  std::vector<PixelLayer<uint8_t>> layers(10);
  for (size_t i = 0; i < layers.size(); ++i) {
    layers[i].resize(std::vector<size_t>{12, 4, 4, 1, 1}[i % 5] * pixels);
    std::fill(layers[i].begin(), layers[i].end(), byte);
  }
}

// Large enough for blocks, but for layers of a byte a pixel, which get what Fill left all the same
// as a rule; in no whole number of tiles.
TEST(PixelLayerTest, FramesDoNotDependOnWhatWasThereBefore) {
  constexpr int kWidth = 1031, kHeight = 257;
  const auto scene = test::BallsOnFloor(3, 1);
  WorkerPool pool(2);
  for (const Mode mode : {Mode::kClassical, Mode::kCached}) {
    for (const Lanes lanes : {Lanes::kScalar, Lanes::kSimd}) {
      for (const int samples : {1, 4}) {
        if (samples > 1 && lanes == Lanes::kScalar) continue;  // slow, and the same as for one
        std::vector<Frame> frames;
        for (const uint8_t before : {uint8_t{0x7f}, uint8_t{0x33}}) {
          Fill(kWidth, kHeight, before);
          SceneHost host(scene);
          FrameRequest request{scene->cameras[0], kWidth, kHeight, {}};
          request.options.mode = mode;
          request.options.lanes = lanes;
          request.sampling.samples = samples;
          frames.push_back(test::RenderFrame(host, request, pool));
        }
        EXPECT_EQ(frames[0].radiance, frames[1].radiance);
        EXPECT_EQ(frames[0].object, frames[1].object);
        EXPECT_EQ(frames[0].source, frames[1].source);
        EXPECT_EQ(frames[0].verdict, frames[1].verdict);
        EXPECT_EQ(frames[0].depth, frames[1].depth);
      }
    }
  }
}

}  // namespace
}  // namespace linetree
