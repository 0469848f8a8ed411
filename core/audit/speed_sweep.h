// Speed over one number: what a sweep varies, and the setting at each of its points.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "core/audit/speed_paths.h"
#include "core/audit/speed_scenes.h"

namespace linetree {

enum class Sweep {
  kLights,
  kObjects,     // of made scenes only
  kDepth,       // PathLimits::max_depth
  kResolution,  // pixels a side of a square picture; 2880 x 2880 are as many as 3840 x 2160
  kEpsilon,
  kThreads,
  kSamples,  // of every pixel
};
inline constexpr std::array<std::string_view, 7> kSweepNames = {
    "lights", "objects", "depth", "resolution", "epsilon", "threads", "samples"};

inline std::string_view NameOf(Sweep sweep) { return kSweepNames[static_cast<size_t>(sweep)]; }

std::vector<double> DefaultPoints(Sweep sweep);
// The scenes that are worth sweeping when none are given.
std::vector<std::string> DefaultMadeScenes(Sweep sweep);

// INVALID_ARGUMENT for a point that the sweep does not have: all but epsilons are whole numbers.
absl::Status ValidatePoint(Sweep sweep, double point);

// A scene that is swept over: one from a file, or one that can be made anew.
struct SpeedSource {
  std::string name;
  std::shared_ptr<const Scene> scene;
  std::optional<MadeScene> made;
};

// The setting at a valid point, of one name for all points (room:18:N); what the sweep does not
// vary is `base`'s (but for scene and name). Scenes from files get their lights as WithLights sets
// them. INVALID_ARGUMENT when the sweep needs a made scene and the source is none.
absl::StatusOr<SpeedSetting> SettingAt(Sweep sweep, double point, const SpeedSource& source,
                                       const SpeedSetting& base);

}  // namespace linetree
