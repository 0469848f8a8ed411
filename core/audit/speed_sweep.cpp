#include "core/audit/speed_sweep.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "core/audit/light_study.h"

namespace linetree {
namespace {

struct Range {
  double low, high;
};

Range RangeOf(Sweep sweep) {
  switch (sweep) {
    case Sweep::kLights:
      return {1, 1024};
    case Sweep::kObjects:
      return {1, 100'000};
    case Sweep::kDepth:
      return {1, kMaxPathDepth};
    case Sweep::kResolution:
      return {1, static_cast<double>(RenderLimits{}.max_side) / 2};
    case Sweep::kEpsilon:
      return {0, 1};
    case Sweep::kThreads:
      return {1, 256};
    case Sweep::kSamples:
      return {1, kMaxPixelSamples};
  }
  return {};
}

}  // namespace

std::vector<double> DefaultPoints(Sweep sweep) {
  switch (sweep) {
    case Sweep::kLights:
      return {1, 2, 4, 8, 16, 32, 64, 128};
    case Sweep::kObjects:
      return {10, 30, 100, 300, 1000, 3000, 10'000};
    case Sweep::kDepth:
      return {1, 2, 3, 4, 6, 8};
    case Sweep::kResolution:
      return {256, 512, 1024, 2048, 2880};
    case Sweep::kEpsilon:
      return {0, 0.01, 0.02, 0.05, 0.1, 0.25, 0.5};
    case Sweep::kThreads:
      return {1, 2};
    case Sweep::kSamples:
      return {1, 4, 9, 16};
  }
  return {};
}

std::vector<std::string> DefaultMadeScenes(Sweep sweep) {
  switch (sweep) {
    case Sweep::kLights:
      return {"room:18:1", "spheres:200:1"};
    case Sweep::kObjects:
      return {"spheres:10:4", "room:18:16"};
    case Sweep::kDepth:
      return {"mirrors:18:3", "glass:18:3"};
    case Sweep::kResolution:
    case Sweep::kEpsilon:
    case Sweep::kThreads:
    case Sweep::kSamples:
      return {"room:18:16", "spheres:200:4"};
  }
  return {};
}

absl::Status ValidatePoint(Sweep sweep, double point) {
  const auto [low, high] = RangeOf(sweep);
  const bool whole = sweep == Sweep::kEpsilon || point == std::floor(point);
  if (whole && point >= low && point <= high) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat(std::string(NameOf(sweep)), ": expected ",
                   sweep == Sweep::kEpsilon ? "numbers" : "whole numbers", " in [", low, ", ", high,
                   "], got ", point));
}

absl::StatusOr<SpeedSetting> SettingAt(Sweep sweep, double point, const SpeedSource& source,
                                       const SpeedSetting& base) {
  SpeedSetting setting = base;
  setting.name = source.name;
  setting.scene = source.scene;
  const int whole = static_cast<int>(point);
  std::optional<MadeScene> made = source.made;
  switch (sweep) {
    case Sweep::kLights:
      if (!made) setting.scene = WithLights(*source.scene, static_cast<size_t>(whole));
      if (made) made->lights = whole;
      break;
    case Sweep::kObjects:
      if (!made) {
        return absl::InvalidArgumentError(
            absl::StrCat(source.name, ": a sweep over objects takes scenes of --made"));
      }
      made->objects = whole;
      break;
    case Sweep::kDepth:
      setting.options.limits.max_depth = whole;
      break;
    case Sweep::kResolution:
      setting.options.width = setting.options.height = whole;
      break;
    case Sweep::kEpsilon:
      setting.options.epsilon = point;
      break;
    case Sweep::kThreads:
      setting.threads = whole;
      break;
    case Sweep::kSamples:
      setting.options.sampling.samples = whole;
      break;
  }
  if (made && (sweep == Sweep::kLights || sweep == Sweep::kObjects)) {
    setting.scene = Make(*made);
    const bool lights = sweep == Sweep::kLights;
    setting.name = absl::StrCat(made->kind, ":", lights ? absl::StrCat(made->objects) : "N", ":",
                                lights ? "N" : absl::StrCat(made->lights));
  }
  return setting;
}

}  // namespace linetree
