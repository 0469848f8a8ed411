#include "peers/picture_difference.h"

#include <algorithm>
#include <cmath>

#include "core/math/check.h"

namespace linetree {

PictureDifference DifferenceOf(std::span<const float> picture, std::span<const float> reference) {
  LT_CHECK(picture.size() == reference.size() && picture.size() % 3 == 0);
  PictureDifference result;
  if (picture.empty()) return result;
  double squares = 0;
  size_t beyond_code = 0, beyond_5_percent = 0;
  for (size_t pixel = 0; pixel < picture.size(); pixel += 3) {
    double worst = 0;
    for (size_t i = pixel; i < pixel + 3; ++i) {
      const double difference = std::abs(double{std::clamp(picture[i], 0.0F, 1.0F)} -
                                         double{std::clamp(reference[i], 0.0F, 1.0F)});
      squares += difference * difference;
      worst = std::max(worst, difference);
    }
    result.largest = std::max(result.largest, worst);
    if (worst > kCodeStep) ++beyond_code;
    if (worst > 0.05) ++beyond_5_percent;
  }
  const auto pixels = static_cast<double>(picture.size()) / 3;
  result.rms = std::sqrt(squares / (3 * pixels));
  result.share_beyond_code = static_cast<double>(beyond_code) / pixels;
  result.share_beyond_5_percent = static_cast<double>(beyond_5_percent) / pixels;
  return result;
}

}  // namespace linetree
