#include "client/command/speed_run.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "core/io/load_scene.h"

namespace linetree {
namespace {

// The scenes of the planned comparison.
constexpr std::array<std::string_view, 13> kScenes = {
    "room.textproto",  "face.textproto",  "glass.textproto",  "many_lights.textproto",
    "spd/balls_2.nff", "spd/balls_4.nff", "spd/gears_1.nff",  "spd/mount_4.nff",
    "spd/mount_6.nff", "spd/rings_1.nff", "spd/teapot_2.nff", "spd/tetra_6.nff",
    "spd/tree_8.nff"};

using Sources = std::vector<SpeedSource>;

absl::StatusOr<SpeedSource> SourceOfFile(const std::string& file) {
  auto scene = LoadSceneFile(file);
  if (!scene.ok()) return scene.status();
  if ((*scene)->cameras.empty()) {
    return absl::InvalidArgumentError(absl::StrCat(file, ": expected a camera"));
  }
  return SpeedSource{std::filesystem::path(file).stem(), *std::move(scene), std::nullopt};
}

absl::StatusOr<SpeedSource> SourceOfMade(const std::string& text) {
  const auto made = ParseMadeScene(text);
  if (!made.ok()) return made.status();
  return SpeedSource{text, Make(*made), *made};
}

absl::StatusOr<Sources> SourcesOf(const std::vector<std::string>& files,
                                  const std::vector<std::string>& made) {
  Sources sources;
  for (const std::string& file : files) {
    auto source = SourceOfFile(file);
    if (!source.ok()) return source.status();
    sources.push_back(*std::move(source));
  }
  for (const std::string& text : made) {
    auto source = SourceOfMade(text);
    if (!source.ok()) return source.status();
    sources.push_back(*std::move(source));
  }
  return sources;
}

// Of the `done`-th of `all` equal parts.
Progress PartOf(const Progress& progress, size_t done, size_t all) {
  return [&progress, done, all](double share) {
    progress((static_cast<double>(done) + share) / static_cast<double>(all));
  };
}

absl::StatusOr<SpeedRow> MeasureRow(const SpeedPlan& plan, SpeedSetting setting,
                                    const Progress& progress) {
  auto paths = StudyPaths(setting, plan.flights, progress);
  if (!paths.ok()) return paths.status();
  SpeedRow row;
  row.paths = *std::move(paths);
  if (plan.stages) {
    WorkerPool pool(setting.threads);
    const auto stages =
        StudyStages(setting.scene, setting.options, plan.flights.still_frames, pool);
    if (!stages.ok()) return stages.status();
    row.stages = *stages;
  }
  row.setting = std::move(setting);
  return row;
}

SpeedStudy StudyTracers(const SpeedSetting& setting) {
  const Tracer tracer(*setting.scene);
  const PacketTracer packets(tracer);
  const FrameSpeedOptions& options = setting.options;
  return StudySpeed(tracer, packets, setting.scene->cameras[0],
                    {options.width, options.height, options.repeats, options.limits});
}

}  // namespace

bool SpeedRow::Holds() const {
  if (tracers && (tracers->different_topology != 0 || tracers->different_counts != 0 ||
                  !(tracers->largest_difference <= tracers->allowed_difference))) {
    return false;
  }
  return std::all_of(paths.begin(), paths.end(),
                     [](const PathSpeed& path) { return path.flight.beyond == 0; });
}

absl::StatusOr<std::vector<SpeedRow>> MeasureScenes(const SpeedPlan& plan,
                                                    const Progress& progress) {
  std::vector<std::string> files = plan.scenes;
  if (files.empty() && plan.made.empty()) {
    for (const std::string_view name : kScenes) {
      files.push_back(plan.scenes_dir + "/" + std::string(name));
    }
  }
  const auto sources = SourcesOf(files, plan.made);
  if (!sources.ok()) return sources.status();
  std::vector<SpeedRow> rows;
  for (const SpeedSource& source : *sources) {
    SpeedSetting setting = plan.base;
    setting.name = source.name;
    setting.scene = source.scene;
    auto row = MeasureRow(plan, setting, PartOf(progress, rows.size(), sources->size()));
    if (!row.ok()) return row.status();
    row->tracers = StudyTracers(setting);
    rows.push_back(*std::move(row));
  }
  return rows;
}

absl::StatusOr<std::vector<SpeedRow>> MeasureSweep(const SpeedPlan& plan, Sweep sweep,
                                                   const std::vector<double>& points,
                                                   const Progress& progress) {
  const bool given = !plan.scenes.empty() || !plan.made.empty();
  const auto sources = SourcesOf(plan.scenes, given ? plan.made : DefaultMadeScenes(sweep));
  if (!sources.ok()) return sources.status();
  std::vector<SpeedRow> rows;
  for (const SpeedSource& source : *sources) {
    for (const double point : points) {
      const auto setting = SettingAt(sweep, point, source, plan.base);
      if (!setting.ok()) return setting.status();
      auto row = MeasureRow(plan, *setting,
                            PartOf(progress, rows.size(), sources->size() * points.size()));
      if (!row.ok()) return row.status();
      row->point = point;
      rows.push_back(*std::move(row));
    }
  }
  return rows;
}

absl::StatusOr<std::vector<TargetResult>> MeasureAllTargets(const SpeedPlan& plan,
                                                            const std::string& part,
                                                            const Progress& progress) {
  std::vector<SpeedTarget> targets;
  for (SpeedTarget& target : SpeedTargets()) {
    if (absl::StrContains(target.scene, part)) targets.push_back(std::move(target));
  }
  std::vector<TargetResult> results;
  while (results.size() < targets.size()) {
    const SpeedTarget& first = targets[results.size()];
    std::vector<SpeedTarget> run;
    for (size_t i = results.size(); i < targets.size() && targets[i].SharesRunWith(first); ++i) {
      run.push_back(targets[i]);
    }
    const bool is_made = ParseMadeScene(first.scene).ok();
    auto source =
        is_made ? SourceOfMade(first.scene) : SourceOfFile(plan.scenes_dir + "/" + first.scene);
    if (!source.ok()) return source.status();
    const size_t done = results.size();
    const auto share = [&](double of_run) {
      progress((static_cast<double>(done) + of_run * static_cast<double>(run.size())) /
               static_cast<double>(targets.size()));
    };
    auto measured =
        MeasureTargets(run, source->scene, plan.base.options.repeats, plan.flights, share);
    if (!measured.ok()) return measured.status();
    for (TargetResult& result : *measured) results.push_back(std::move(result));
  }
  return results;
}

}  // namespace linetree
