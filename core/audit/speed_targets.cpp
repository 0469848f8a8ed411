#include "core/audit/speed_targets.h"

#include <algorithm>

#include "core/audit/thread_speed.h"
#include "core/math/check.h"

namespace linetree {
namespace {

using What = SpeedTarget::What;

constexpr double kNeverSlower = 0.95;

class TargetList {
 public:
  // Goals of a warm frame at 512 x 512, of a warm and of a cold one at 1920 x 1080; 0: none.
  void AddScene(const std::string& scene, double warm, double large_warm, double large_cold,
                int max_depth = PathLimits{}.max_depth) {
    SpeedTarget target{.scene = scene, .max_depth = max_depth};
    AddMedian(target, warm);
    target.width = 1920;
    target.height = 1080;
    AddMedian(target, large_warm);
    target.path = SpeedPath::kCold;
    AddMedian(target, large_cold);
  }
  // No frame, cold or warm, may be slower than that.
  void AddNeverSlower(const std::string& scene, int width, int height) {
    SpeedTarget target{.scene = scene, .width = width, .height = height};
    target.what = What::kLeast;
    target.goal = kNeverSlower;
    for (const SpeedPath path : {SpeedPath::kCold, SpeedPath::kWarm}) {
      target.path = path;
      targets_.push_back(target);
    }
  }
  void AddMedian(SpeedTarget target, double goal) {
    target.goal = goal;
    if (goal > 0) targets_.push_back(std::move(target));
  }
  void Add(SpeedTarget target) { targets_.push_back(std::move(target)); }
  std::vector<SpeedTarget> Take() { return std::move(targets_); }

 private:
  std::vector<SpeedTarget> targets_;
};

std::vector<SpeedPath> PathsOf(const std::vector<SpeedTarget>& targets) {
  std::vector<SpeedPath> paths;
  for (const SpeedTarget& target : targets) {
    const bool there = std::find(paths.begin(), paths.end(), target.path) != paths.end();
    if (!there) paths.push_back(target.path);
  }
  return paths;
}

TargetResult ResultOf(const SpeedTarget& target, const std::vector<PathSpeed>& speeds,
                      const ThreadSpeed& threads, const std::optional<Roofline>& roofline) {
  const auto speed = std::find_if(speeds.begin(), speeds.end(),
                                  [&](const PathSpeed& s) { return s.path == target.path; });
  LT_CHECK(speed != speeds.end());
  TargetResult result{target,
                      speed->median_ratio,
                      speed->flight.beyond,
                      speed->flight.largest_error,
                      threads.classical_ratio,
                      roofline};
  if (target.what == What::kLeast) result.measured = speed->least_ratio;
  if (target.what == What::kThreads) {
    result.measured = threads.ratio;
    result.beyond += threads.unequal;
  }
  return result;
}

bool WantsThreads(const std::vector<SpeedTarget>& targets) {
  return std::any_of(targets.begin(), targets.end(),
                     [](const SpeedTarget& target) { return target.what == What::kThreads; });
}

}  // namespace

bool SpeedTarget::SharesRunWith(const SpeedTarget& other) const {
  return scene == other.scene && width == other.width && height == other.height &&
         max_depth == other.max_depth && epsilon == other.epsilon && samples == other.samples;
}

std::vector<SpeedTarget> SpeedTargets() {
  TargetList list;
  list.AddScene("room:18:3", 2.5, 4, 2.5);
  list.AddScene("room:18:16", 6, 11, 7);
  list.Add(
      {.scene = "room:18:16", .width = 1920, .height = 1080, .what = What::kThreads, .goal = 1.8});
  list.AddScene("room:18:64", 12, 22, 13);
  list.AddScene("room:18:128", 15, 30, 16);
  list.AddScene("face.textproto", 1.5, 2, 1.3);
  list.AddScene("spheres:200:4", 2, 2.5, 1.3);
  list.AddScene("spheres:200:16", 3.5, 5, 2);
  list.AddScene("spheres:200:64", 5, 7.5, 2.5);
  list.AddScene("mirrors:18:3", 2, 3, 2, 8);
  list.AddScene("mirrors:18:16", 4.5, 7, 6, 8);
  list.AddScene("glass:18:3", 1.8, 3, 0);
  for (const char* scene : {"spd/balls_4.nff", "spd/mount_6.nff", "spd/rings_1.nff",
                            "spd/tree_8.nff", "spd/tetra_6.nff"}) {
    list.AddNeverSlower(scene, 512, 512);
    list.AddNeverSlower(scene, 1920, 1080);
  }
  list.Add({.scene = "room:18:3", .epsilon = 0, .goal = 2.3});
  list.Add({.scene = "room:18:16", .epsilon = 0, .goal = 5});
  list.Add({.scene = "room:18:64", .epsilon = 0, .goal = 8});
  list.Add({.scene = "room:18:16", .samples = 16, .goal = 8});
  list.AddNeverSlower("spheres:10000:4", 512, 512);
  for (const char* scene : {"spheres:10000:4", "room:18:16", "spheres:200:4", "spd/mount_6.nff"}) {
    list.Add(
        {.scene = scene, .path = SpeedPath::kTeleport, .what = What::kLeast, .goal = kNeverSlower});
  }
  return list.Take();
}

absl::StatusOr<std::vector<TargetResult>> MeasureTargets(
    const std::vector<SpeedTarget>& targets, std::shared_ptr<const Scene> scene, int repeats,
    const SpeedFlights& flights, const std::function<void(double)>& progress) {
  LT_CHECK(!targets.empty());
  const SpeedTarget& first = targets.front();
  SpeedSetting setting;
  setting.name = first.scene;
  setting.scene = std::move(scene);
  setting.options.width = first.width;
  setting.options.height = first.height;
  setting.options.repeats = repeats;
  setting.options.epsilon = first.epsilon;
  setting.options.limits.max_depth = first.max_depth;
  setting.options.sampling.samples = first.samples;
  SpeedFlights wanted = flights;
  wanted.paths = PathsOf(targets);
  const auto speeds = StudyPaths(setting, wanted, progress);
  if (!speeds.ok()) return speeds.status();
  ThreadSpeed threads;
  if (WantsThreads(targets)) {
    const auto measured = StudyThreads(setting.scene, setting.options, flights.still_frames);
    if (!measured.ok()) return measured.status();
    threads = *measured;
  }
  std::optional<Roofline> roofline;
  if (setting.options.sampling.samples == 1) {
    WorkerPool pool(setting.threads);
    const auto measured = StudyRoofline(setting.scene, setting.options, pool);
    if (!measured.ok()) return measured.status();
    roofline = *measured;
  }
  std::vector<TargetResult> results;
  for (const SpeedTarget& target : targets) {
    results.push_back(ResultOf(target, *speeds, threads, roofline));
  }
  return results;
}

}  // namespace linetree
