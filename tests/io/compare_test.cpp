#include "core/io/compare.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/io/frames.h"

namespace linetree {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

std::vector<float> Grey(std::initializer_list<float> values) {
  std::vector<float> rgb;
  for (const float v : values) rgb.insert(rgb.end(), {v, v, v});
  return rgb;
}

TEST(Compare, EqualPicturesHaveNoError) {
  const std::vector<float> a = Grey({0, 1, 2});
  const ErrorFigures figures = CompareRadiance(a, a, {});
  EXPECT_EQ(figures.pixels, 3u);
  EXPECT_EQ(figures.beyond, 0u);
  EXPECT_EQ(figures.max, 0);
  EXPECT_EQ(figures.mean, 0);
  EXPECT_EQ(figures.p999, 0);
  EXPECT_EQ(figures.psnr_db, std::numeric_limits<double>::infinity());
}

TEST(Compare, TheReferenceDivides) {
  const std::vector<float> a = Grey({1});
  const std::vector<float> b = Grey({2});
  EXPECT_EQ(CompareRadiance(a, b, {}).max, 0.5);
  EXPECT_EQ(CompareRadiance(b, a, {}).max, 1.0);
}

TEST(Compare, TheWorstChannelOfTheWorstPixelCounts) {
  std::vector<float> a = Grey({1, 1, 1, 1});
  a[7] = 1.5f;
  a[9] = 0.75f;
  const ErrorFigures figures = CompareRadiance(a, Grey({1, 1, 1, 1}), {});
  EXPECT_EQ(figures.max, 0.5);
  EXPECT_EQ(figures.worst, 2u);
  EXPECT_EQ(figures.mean, 0.75 / 4);
  EXPECT_EQ(figures.beyond, 2u);
}

TEST(Compare, DarkPixelsAreMeasuredAgainstTheFloor) {
  CompareOptions options;
  options.white = 4;
  options.floor = 4.0 / 1024;
  const ErrorFigures figures = CompareRadiance(Grey({1.0f / 1024}), Grey({0}), options);
  EXPECT_EQ(figures.max, 0.25);
}

TEST(Compare, TheFloorFollowsWhiteUnlessGiven) {
  const CompareOptions options{.white = 8};
  EXPECT_EQ(options.floor, 8.0 / 1024);
}

TEST(Compare, PercentileIsTheNearestRank) {
  std::vector<float> a(3 * 2000, 1.0f);
  const std::vector<float> b = a;
  // Of 2000 pixels, 1998 must not exceed the figure: the third largest error.
  a[0] = 9;
  a[300] = 8;
  a[3000] = 3;
  a[4500] = 2;
  EXPECT_EQ(CompareRadiance(a, b, {}).p999, 2.0);
  EXPECT_EQ(CompareRadiance(a, b, {}).max, 8.0);
}

TEST(Compare, PsnrOfAKnownDifference) {
  // A mean square error of 0.01 against a peak of 1 is 20 dB; against a peak of 10, 40 dB.
  std::vector<float> a = Grey({0, 0, 0, 0});
  for (float& v : a) v = 0.1f;
  CompareOptions options;
  EXPECT_NEAR(CompareRadiance(a, Grey({0, 0, 0, 0}), options).psnr_db, 20, 1e-5);
  options.white = 10;
  EXPECT_NEAR(CompareRadiance(a, Grey({0, 0, 0, 0}), options).psnr_db, 40, 1e-5);
}

TEST(Compare, NonFinitePixelsAreBeyondEveryEpsilon) {
  CompareOptions options;
  options.max_relative_error = 1;
  const ErrorFigures figures =
      CompareRadiance(Grey({kNan, 1, kInf, 1}), Grey({1, kNan, kInf, 1}), options);
  EXPECT_EQ(figures.not_finite, 3u);
  EXPECT_EQ(figures.beyond, 3u);
  EXPECT_EQ(figures.max, std::numeric_limits<double>::infinity());
  EXPECT_EQ(figures.psnr_db, -std::numeric_limits<double>::infinity());
}

TEST(Compare, EpsilonZeroMeansEqualBits) {
  const std::vector<float> one = Grey({1});
  const std::vector<float> next = Grey({std::nextafter(1.0f, 2.0f)});
  EXPECT_EQ(CompareRadiance(next, one, {}).beyond, 1u);
}

TEST(Compare, AnErrorOfExactlyEpsilonIsKeptAfterRounding) {
  // 0.1 in double and in float lie on different sides; the promise was kept before rounding.
  CompareOptions options;
  options.max_relative_error = 0.1;
  for (const double reference : {1.0, 1.0 / 3, 0.7, 123.456}) {
    const auto b = static_cast<float>(reference);
    EXPECT_EQ(
        CompareRadiance(Grey({static_cast<float>(reference * 1.1)}), Grey({b}), options).beyond,
        0u);
    EXPECT_EQ(
        CompareRadiance(Grey({static_cast<float>(reference * 1.10001)}), Grey({b}), options).beyond,
        1u);
  }
}

TEST(Compare, DifferentSizesAreRefused) {
  const absl::Status status = CompareFrames(MakeFrame(4, 3), MakeFrame(3, 4), {}).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(status.message(), "expected pictures of one size, found 4 x 3 and 3 x 4");
}

TEST(Compare, JsonHoldsTheFigures) {
  std::vector<float> a = Grey({1, 1, 1, 1});
  a[9] = 2;
  const CompareOptions options{.max_relative_error = 0.5};
  const nlohmann::json json =
      ErrorJson(CompareRadiance(a, Grey({1, 1, 1, 1}), options), options, 2);
  EXPECT_EQ(json["beyond"], 1);
  EXPECT_EQ(json["max"], 1.0);
  EXPECT_EQ(json["worst"]["x"], 1);
  EXPECT_EQ(json["worst"]["y"], 1);
  EXPECT_EQ(json["epsilon"], 0.5);
  const nlohmann::json equal = ErrorJson(CompareRadiance(a, a, options), options, 2);
  EXPECT_TRUE(equal["psnr_db"].is_null());
}

}  // namespace
}  // namespace linetree
