#include "peers/picture_difference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace linetree {
namespace {

TEST(PictureDifference, EqualPicturesDoNotDiffer) {
  const std::vector<float> picture = {0.1F, 0.2F, 0.3F, 0.4F, 0.5F, 0.6F};
  const PictureDifference d = DifferenceOf(picture, picture);
  EXPECT_EQ(d.rms, 0);
  EXPECT_EQ(d.largest, 0);
  EXPECT_EQ(d.share_beyond_code, 0);
  EXPECT_EQ(d.share_beyond_5_percent, 0);
}

TEST(PictureDifference, CountsPixelsByTheirWorstChannel) {
  const std::vector<float> reference(12, 0.5F);
  std::vector<float> picture = reference;
  picture[0] += 0.01F;  // beyond a code
  picture[1] -= 0.01F;  // the same pixel
  picture[5] += 0.1F;   // beyond both
  picture[6] += 0.001F;
  const PictureDifference d = DifferenceOf(picture, reference);
  EXPECT_NEAR(d.largest, 0.1, 1e-6);
  EXPECT_EQ(d.share_beyond_code, 0.5);
  EXPECT_EQ(d.share_beyond_5_percent, 0.25);
  EXPECT_NEAR(d.rms, std::sqrt((0.01 * 0.01 * 2 + 0.1 * 0.1 + 1e-6) / 12), 1e-6);
}

TEST(PictureDifference, ValuesAreClippedFirst) {
  const std::vector<float> reference = {7, 1, 0};
  const std::vector<float> picture = {1, 2, -3};
  EXPECT_EQ(DifferenceOf(picture, reference).largest, 0);
}

TEST(PictureDifference, OfNoPixelsIsNone) { EXPECT_EQ(DifferenceOf({}, {}).rms, 0); }

}  // namespace
}  // namespace linetree
