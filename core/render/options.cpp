#include "core/render/options.h"

#include "absl/strings/str_cat.h"

namespace linetree {

absl::Status ValidateOptions(const RenderOptions& options) {
  if (!(options.max_relative_error >= 0 && options.max_relative_error <= 1)) {
    return absl::InvalidArgumentError(
        absl::StrCat("options.max_relative_error: expected a number in [0, 1], got ",
                     options.max_relative_error));
  }
  if (options.limits.max_depth < 1 || options.limits.max_depth > kMaxPathDepth) {
    return absl::InvalidArgumentError(absl::StrCat(
        "options.max_depth: expected 1 to ", kMaxPathDepth, ", got ", options.limits.max_depth));
  }
  if (!(options.limits.min_weight >= 0 && options.limits.min_weight <= 1)) {
    return absl::InvalidArgumentError(absl::StrCat(
        "options.min_weight: expected a number in [0, 1], got ", options.limits.min_weight));
  }
  return absl::OkStatus();
}

absl::Status ValidateSize(int64_t width, int64_t height, const RenderLimits& limits) {
  for (const auto& [name, value] : {std::pair("width", width), std::pair("height", height)}) {
    if (value < 1) {
      return absl::InvalidArgumentError(
          absl::StrCat(name, ": expected at least 1 pixel, got ", value));
    }
    if (value > limits.max_side) {
      return absl::ResourceExhaustedError(
          absl::StrCat(name, ": at most ", limits.max_side, " pixels are allowed, got ", value));
    }
  }
  if (static_cast<uint64_t>(width) * static_cast<uint64_t>(height) > limits.max_pixels) {
    return absl::ResourceExhaustedError(absl::StrCat("width, height: at most ", limits.max_pixels,
                                                     " pixels are allowed, got ", width, " x ",
                                                     height));
  }
  return absl::OkStatus();
}

absl::Status ValidateSamples(const Sampling& sampling, int width, int height,
                             const RenderLimits& limits) {
  if (auto s = ValidateSampling(sampling); !s.ok()) return s;
  const uint64_t samples = static_cast<uint64_t>(width) * static_cast<uint64_t>(height) *
                           static_cast<uint64_t>(sampling.samples);
  if (samples <= limits.max_samples) return absl::OkStatus();
  return absl::ResourceExhaustedError(absl::StrCat("sampling.samples: at most ", limits.max_samples,
                                                   " are allowed in all pixels together, got ",
                                                   samples));
}

}  // namespace linetree
