#include "core/io/layer_colors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "tests/io/frames.h"

namespace linetree {
namespace {

using ::testing::ElementsAre;

Color8 At(const Picture8& picture, size_t pixel) {
  return {picture.rgb[3 * pixel], picture.rgb[3 * pixel + 1], picture.rgb[3 * pixel + 2]};
}

TEST(LayerColors, SrgbCodesOfKnownValues) {
  EXPECT_EQ(SrgbCode(0), 0);
  EXPECT_EQ(SrgbCode(1), 255);
  EXPECT_EQ(SrgbCode(0.5), 188);  // IEC 61966-2-1
  EXPECT_EQ(SrgbCode(0.2158605), 128);
  EXPECT_EQ(SrgbCode(0.002), 7);  // the linear part: 12.92 * 0.002 * 255 = 6.6
  EXPECT_EQ(SrgbCode(-1), 0);
  EXPECT_EQ(SrgbCode(7), 255);
  EXPECT_EQ(SrgbCode(std::numeric_limits<double>::quiet_NaN()), 0);
  EXPECT_EQ(SrgbCode(std::numeric_limits<double>::infinity()), 255);
}

TEST(LayerColors, BeautyIsScaledByWhite) {
  Frame frame = MakeFrame(1, 1);
  frame.radiance = {1.25f, 2.5f, 9.0f};
  frame.white = 2.5;
  EXPECT_THAT(PaintLayer(frame, Layer::kBeauty).rgb, ElementsAre(188, 255, 255));
}

// Color Plate 1: silhouette yellow, self-shadow green, specular cyan, epsilon purple, blocker red.
TEST(LayerColors, VerdictsWearThePlatesColors) {
  Frame frame = MakeFrame(kVerdictCount, 2);  // pixel 0 is background
  for (size_t i = 0; i < kVerdictCount; ++i) {
    frame.verdict[kVerdictCount + i] = static_cast<Verdict>(i);
  }
  const Picture8 picture = PaintLayer(frame, Layer::kVerdict);
  const auto color = [&](Verdict verdict) {
    return At(picture, kVerdictCount + static_cast<size_t>(verdict));
  };
  EXPECT_EQ(At(picture, 0), (Color8{0, 0, 0}));
  const Color8 yellow = color(Verdict::kGap);
  EXPECT_TRUE(yellow[0] > 200 && yellow[1] > 200 && yellow[2] < 60);
  const Color8 green = color(Verdict::kSelfShadow);
  EXPECT_TRUE(green[0] < 80 && green[1] > 150 && green[2] < 80);
  const Color8 cyan = color(Verdict::kPeak);
  EXPECT_TRUE(cyan[0] < 80 && cyan[1] > 200 && cyan[2] > 200);
  const Color8 purple = color(Verdict::kEpsilon);
  EXPECT_TRUE(purple[0] > 100 && purple[1] < 80 && purple[2] > 150);
  const Color8 red = color(Verdict::kBlocker);
  EXPECT_TRUE(red[0] > 200 && red[1] < 60 && red[2] < 60);
  const Color8 orange = color(Verdict::kFunnel);
  EXPECT_TRUE(orange[0] > 200 && orange[1] > 100 && orange[1] < 180 && orange[2] < 60);
  const Color8 certified = color(Verdict::kCertified);
  EXPECT_EQ(certified[0], certified[1]);
  EXPECT_EQ(certified[1], certified[2]);
}

TEST(LayerColors, CertifiedPixelsShowThePictureNeverBrighterThanItsLegend) {
  Frame frame = MakeFrame(2, 1);
  frame.source = {Source::kInterpolated, Source::kInterpolated};
  frame.verdict = {Verdict::kCertified, Verdict::kCertified};
  frame.white = 1;
  frame.radiance = {0, 0, 0, 50, 50, 50};
  const Picture8 picture = PaintLayer(frame, Layer::kVerdict);
  EXPECT_EQ(At(picture, 0), (Color8{0, 0, 0}));
  EXPECT_EQ(At(picture, 1), VerdictLegend()[static_cast<size_t>(Verdict::kCertified)].color);
}

TEST(LayerColors, LegendsAreTellableApart) {
  std::set<Color8> colors;
  for (const LegendEntry& entry : VerdictLegend()) colors.insert(entry.color);
  EXPECT_EQ(colors.size(), VerdictLegend().size());
}

TEST(LayerColors, ObjectsDifferAndTheBackgroundIsBlack) {
  const Frame frame = MakeFrame(32, 4);
  const Picture8 picture = PaintLayer(frame, Layer::kObject);
  EXPECT_EQ(At(picture, 0), (Color8{0, 0, 0}));
  std::set<Color8> colors;
  for (size_t i = 0; i < 128; ++i) colors.insert(At(picture, i));
  EXPECT_GT(colors.size(), 120u);
}

TEST(LayerColors, NearIsBright) {
  Frame frame = MakeFrame(3, 1);
  frame.depth = {10, 20, std::numeric_limits<float>::infinity()};
  const Picture8 picture = PaintLayer(frame, Layer::kDepth);
  EXPECT_EQ(At(picture, 0), (Color8{255, 255, 255}));
  EXPECT_LT(At(picture, 1)[0], 255);
  EXPECT_GT(At(picture, 1)[0], 0);
  EXPECT_EQ(At(picture, 2), (Color8{0, 0, 0}));
}

TEST(LayerColors, NamesFindLayers) {
  for (size_t i = 0; i < kLayerNames.size(); ++i) {
    EXPECT_EQ(FindLayer(kLayerNames[i]), static_cast<Layer>(i));
  }
  EXPECT_EQ(FindLayer("beauties"), std::nullopt);
}

TEST(LayerColors, MissingLayersAreSeen) {
  Frame frame = MakeFrame(2, 2);
  EXPECT_TRUE(HasLayer(frame, Layer::kDepth));
  frame.depth.clear();
  EXPECT_FALSE(HasLayer(frame, Layer::kDepth));
  EXPECT_TRUE(HasLayer(frame, Layer::kBeauty));
}

}  // namespace
}  // namespace linetree
