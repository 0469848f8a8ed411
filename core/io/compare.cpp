#include "core/io/compare.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/io/stats_json.h"
#include "core/math/check.h"

namespace linetree {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double ChannelError(double a, double reference, double floor) {
  if (!std::isfinite(a) || !std::isfinite(reference)) return kInfinity;
  return std::abs(a - reference) / std::max(std::abs(reference), floor);
}

std::vector<double> PixelErrors(std::span<const float> a, std::span<const float> reference,
                                double floor) {
  std::vector<double> errors(a.size() / 3);
  for (size_t i = 0; i < a.size(); ++i) {
    errors[i / 3] = std::max(errors[i / 3], ChannelError(a[i], reference[i], floor));
  }
  return errors;
}

double Psnr(std::span<const float> a, std::span<const float> reference, double white) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    const double difference = double{a[i]} - reference[i];
    sum += difference * difference;
  }
  if (a.empty() || sum == 0) return kInfinity;
  if (!std::isfinite(sum)) return -kInfinity;
  return 10 * std::log10(white * white * static_cast<double>(a.size()) / sum);
}

// The nearest rank: element ceil(0.999 n) of the sorted errors, counted from 1.
double Percentile999(std::vector<double>& errors) {
  const size_t rank = (999 * errors.size() + 999) / 1000;
  const auto place = errors.begin() + static_cast<ptrdiff_t>(rank - 1);
  std::nth_element(errors.begin(), place, errors.end());
  return *place;
}

}  // namespace

ErrorFigures CompareRadiance(std::span<const float> a, std::span<const float> reference,
                             const CompareOptions& options) {
  LT_CHECK(a.size() == reference.size() && a.size() % 3 == 0);
  LT_CHECK(options.floor > 0 && options.white > 0 && options.max_relative_error >= 0);
  ErrorFigures figures;
  figures.psnr_db = Psnr(a, reference, options.white);
  std::vector<double> errors = PixelErrors(a, reference, options.floor);
  figures.pixels = errors.size();
  if (errors.empty()) return figures;
  const double epsilon = options.max_relative_error;
  const double limit = epsilon > 0 ? epsilon + (1 + epsilon) * kFloatRounding : 0;
  double sum = 0;
  for (size_t i = 0; i < errors.size(); ++i) {
    sum += errors[i];
    if (errors[i] > limit) ++figures.beyond;
    if (errors[i] == kInfinity) ++figures.not_finite;
    if (errors[i] > figures.max) {
      figures.max = errors[i];
      figures.worst = i;
    }
  }
  figures.mean = sum / static_cast<double>(errors.size());
  figures.p999 = Percentile999(errors);
  return figures;
}

absl::StatusOr<ErrorFigures> CompareFrames(const Frame& a, const Frame& reference,
                                           const CompareOptions& options) {
  if (a.width != reference.width || a.height != reference.height) {
    return absl::InvalidArgumentError(absl::StrCat("expected pictures of one size, found ", a.width,
                                                   " x ", a.height, " and ", reference.width, " x ",
                                                   reference.height));
  }
  return CompareRadiance(a.radiance, reference.radiance, options);
}

nlohmann::json ErrorJson(const ErrorFigures& figures, const CompareOptions& options, int width) {
  LT_CHECK(width > 0);
  const auto columns = static_cast<uint64_t>(width);
  return {{"pixels", figures.pixels},
          {"beyond", figures.beyond},
          {"not_finite", figures.not_finite},
          {"epsilon", options.max_relative_error},
          {"white", options.white},
          {"floor", options.floor},
          {"max", JsonNumber(figures.max)},
          {"mean", JsonNumber(figures.mean)},
          {"p999", JsonNumber(figures.p999)},
          {"psnr_db", JsonNumber(figures.psnr_db)},
          {"worst", {{"x", figures.worst % columns}, {"y", figures.worst / columns}}}};
}

}  // namespace linetree
