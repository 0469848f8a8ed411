#include "core/scene/pixel_samples.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

namespace linetree {
namespace {

using Place = PixelSamples::Place;

Sampling Regular(int samples) { return {samples, SamplePattern::kRegular, 0}; }
Sampling Jittered(int samples, uint64_t seed) { return {samples, SamplePattern::kJittered, seed}; }

// In pixels, of one pixel's samples.
std::vector<Place> PlacesOf(const PixelSamples& samples, int column, int row) {
  std::vector<Place> places;
  for (int y = 0; y < samples.down(); ++y) {
    for (int x = 0; x < samples.across(); ++x) {
      const Place at = samples.PlaceIn(column * samples.across() + x, row * samples.down() + y);
      places.push_back({(x + at.x) / samples.across(), (y + at.y) / samples.down()});
    }
  }
  return places;
}

Place MeanOf(const std::vector<Place>& places) {
  Place mean = {0, 0};
  for (const Place& at : places) {
    mean.x += at.x / static_cast<double>(places.size());
    mean.y += at.y / static_cast<double>(places.size());
  }
  return mean;
}

// How many of `parts` equal parts of [0, 1) hold one of the values.
template <class Value>
size_t CountParts(const std::vector<Place>& places, int parts, const Value& value) {
  std::set<int> found;
  for (const Place& at : places) found.insert(static_cast<int>(value(at) * parts));
  return found.size();
}

TEST(PixelSamplesTest, SquareNumbersAreGrids) {
  const PixelSamples samples(Regular(9));
  EXPECT_EQ(samples.across(), 3);
  EXPECT_EQ(samples.down(), 3);
  EXPECT_TRUE(samples.AreCentred());
  const std::vector<Place> places = PlacesOf(samples, 5, 7);
  for (int i = 0; i < 9; ++i) {
    EXPECT_DOUBLE_EQ(places[static_cast<size_t>(i)].x, (i % 3 + 0.5) / 3);
    EXPECT_DOUBLE_EQ(places[static_cast<size_t>(i)].y, (i / 3 + 0.5) / 3);
  }
}

TEST(PixelSamplesTest, OtherNumbersAreLattices) {
  const std::vector<Place> two = PlacesOf(PixelSamples(Regular(2)), 0, 0);
  EXPECT_DOUBLE_EQ(two[0].y, 0.25);
  EXPECT_DOUBLE_EQ(two[1].y, 0.75);
  // 5 / 1.618 is 3.09: step 3.
  const std::vector<Place> five = PlacesOf(PixelSamples(Regular(5)), 0, 0);
  for (int i = 0; i < 5; ++i) {
    EXPECT_DOUBLE_EQ(five[static_cast<size_t>(i)].x, (i + 0.5) / 5);
    EXPECT_DOUBLE_EQ(five[static_cast<size_t>(i)].y, (3 * i % 5 + 0.5) / 5);
  }
}

TEST(PixelSamplesTest, EveryNumberHasSoManySamplesAndTheCentreAsTheirMean) {
  for (int n = 1; n <= kMaxPixelSamples; ++n) {
    const PixelSamples samples(Regular(n));
    EXPECT_EQ(samples.count(), n);
    EXPECT_EQ(samples.MeanOff(), 0);
    const std::vector<Place> places = PlacesOf(samples, 3, 4);
    const Place mean = MeanOf(places);
    EXPECT_NEAR(mean.x, 0.5, 1e-14) << n;
    EXPECT_NEAR(mean.y, 0.5, 1e-14) << n;
    const auto columns = static_cast<size_t>(samples.across());
    EXPECT_EQ(CountParts(places, samples.across(), [](auto& at) { return at.x; }), columns);
    EXPECT_EQ(CountParts(places, samples.across(), [](auto& at) { return at.y; }), columns) << n;
  }
}

TEST(PixelSamplesTest, JitteredSamplesStayInTheirParts) {
  for (int n = 1; n <= kMaxPixelSamples; ++n) {
    const PixelSamples samples(Jittered(n, 17));
    EXPECT_FALSE(samples.AreCentred());
    Place sum = {0, 0};
    constexpr int kSide = 16;
    for (int pixel = 0; pixel < kSide * kSide; ++pixel) {
      const std::vector<Place> places = PlacesOf(samples, pixel % kSide, pixel / kSide);
      const int parts = samples.across();
      const auto all = static_cast<size_t>(parts);
      ASSERT_EQ(CountParts(places, parts, [](auto& at) { return at.x; }), all) << n;
      ASSERT_EQ(CountParts(places, parts, [](auto& at) { return at.y; }), all) << n;
      for (const Place& at : places) {
        ASSERT_TRUE(at.x >= 0 && at.x < 1 && at.y >= 0 && at.y < 1);
      }
      const Place mean = MeanOf(places);
      ASSERT_LE(std::abs(mean.x - 0.5), samples.MeanOff() / 2 + 1e-14) << n;
      ASSERT_LE(std::abs(mean.y - 0.5), samples.MeanOff() / 2 + 1e-14) << n;
      sum.x += mean.x;
      sum.y += mean.y;
    }
    // Its standard deviation is 0.29 / 16 for one sample.
    EXPECT_NEAR(sum.x / (kSide * kSide), 0.5, 0.1) << n;
    EXPECT_NEAR(sum.y / (kSide * kSide), 0.5, 0.1) << n;
  }
}

TEST(PixelSamplesTest, JitterDependsOnSeedPixelAndSampleOnly) {
  const PixelSamples samples(Jittered(4, 1)), same(Jittered(4, 1)), other(Jittered(4, 2));
  std::set<double> seen;
  for (int row = 0; row < 8; ++row) {
    for (int column = 0; column < 8; ++column) {
      const Place at = samples.PlaceIn(column, row);
      EXPECT_EQ(at.x, same.PlaceIn(column, row).x);
      EXPECT_NE(at.x, other.PlaceIn(column, row).x);
      EXPECT_TRUE(seen.insert(at.x).second && seen.insert(at.y).second);
    }
  }
}

// Cells are counted in an image that is as much finer.
TEST(PixelSamplesTest, RaysAreThoseOfTheUndividedView) {
  Camera camera;
  camera.eye = {1, 2, 5};
  const EyeRays eye_rays(camera, 24, 18);
  for (const Sampling& sampling : {Regular(4), Regular(6), Jittered(9, 3), Jittered(7, 4)}) {
    const PixelSamples samples(sampling);
    const EyeRays finer = eye_rays.Divided(samples.across(), samples.down());
    for (int cell = 0; cell < samples.count(); ++cell) {
      const int x = cell % samples.across(), y = cell / samples.across();
      const Place at = PlacesOf(samples, 20, 3)[static_cast<size_t>(cell)];
      const Ray ray = samples.RayOf(finer, 20 * samples.across() + x, 3 * samples.down() + y);
      const Ray wanted = eye_rays.Through(20 + at.x, 3 + at.y);
      EXPECT_LT(Length(ray.direction - wanted.direction), 1e-15);
      EXPECT_EQ(ray.origin, wanted.origin);
    }
  }
}

TEST(PixelSamplesTest, NumbersOutsideTheRangeAreRefused) {
  for (const int n : {0, -1, kMaxPixelSamples + 1}) {
    const absl::Status status = ValidateSampling(Regular(n));
    EXPECT_TRUE(absl::IsInvalidArgument(status));
    EXPECT_NE(status.message().find("sampling.samples: expected 1 to 64"), std::string::npos);
  }
  EXPECT_TRUE(ValidateSampling(Regular(1)).ok());
  EXPECT_TRUE(ValidateSampling(Jittered(kMaxPixelSamples, 0)).ok());
}

TEST(PixelSamplesTest, PlainIsOneRayThroughTheCentre) {
  EXPECT_TRUE(Sampling{}.IsPlain());
  EXPECT_FALSE(Regular(2).IsPlain());
  EXPECT_FALSE(Jittered(1, 0).IsPlain());
}

}  // namespace
}  // namespace linetree
