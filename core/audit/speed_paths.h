// What the cameras of a measurement do, and how fast frames are along the way.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/audit/frame_speed.h"

namespace linetree {

enum class SpeedPath {
  kCold,      // the first frame of a cache
  kWarm,      // the last of several frames of one view
  kWalk,      // an orbit, a degree a frame, or a path that is given
  kTeleport,  // a random view at every frame
};
inline constexpr std::array<std::string_view, 4> kSpeedPathNames = {"cold", "warm", "walk",
                                                                    "teleport"};

// `frames` cameras one degree apart around what the camera looks at, in the middle the camera.
std::vector<Camera> WalkViews(const Camera& camera, int frames);

// `frames` cameras that the seed scatters: each somewhere on the way from the camera to what one of
// its pixels sees (so in no object), and looking at what another of its pixels sees. The camera
// itself where it sees nothing.
std::vector<Camera> TeleportViews(const Scene& scene, const Camera& camera, int frames,
                                  uint64_t seed = 1);

// A scene in one setting.
struct SpeedSetting {
  std::string name;
  std::shared_ptr<const Scene> scene;  // its first camera counts
  FrameSpeedOptions options;
  int threads = 1;
};

struct SpeedFlights {
  std::vector<SpeedPath> paths = {SpeedPath::kCold, SpeedPath::kWarm};
  int still_frames = 5;      // of one view; the last is the warm one
  int flight_frames = 40;    // of walks and teleports
  std::vector<Camera> walk;  // when not empty, in place of an orbit
};

// What frames along a path are compared to classical ones of the same views.
struct PathSpeed : FlightRatios {  // each frame's ratio is the median of its repeats
  SpeedPath path = SpeedPath::kCold;
  size_t frames = 1;              // that count
  SpeedSpread classical, cached;  // ns per pixel, of the frames' medians
  FrameSpeed flight;              // the whole one; a cold and a warm frame may share one
};

// Cold: the first frame of `still_frames` of one view. Warm: the last one, but the least ratio is
// that of all frames after the first.
absl::StatusOr<std::vector<PathSpeed>> StudyPaths(const SpeedSetting& setting,
                                                  const SpeedFlights& flights,
                                                  const std::function<void(double)>& progress);

}  // namespace linetree
