// linetree bench speed: classical frames by packets against those of the scalar tracer, and cached
// frames by packets against classical ones.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>

#include "absl/strings/str_cat.h"
#include "client/command/command.h"
#include "client/command/explain_report.h"
#include "client/command/flags.h"
#include "client/command/output.h"
#include "client/command/parse_values.h"
#include "client/command/progress_bar.h"
#include "client/command/speed_report.h"
#include "client/command/speed_run.h"
#include "core/io/atomic_file.h"
#include "core/io/camera_path.h"

namespace linetree {
namespace {

struct BenchSpeedFlags {
  SpeedPlan plan;
  SizeFlags size;
  std::vector<Sweep> sweeps;
  std::vector<double> points;
  std::string walk;
  bool explain = false;
  bool targets = false;
  std::string target_part;
  std::string json;
  std::string svg;
  bool quiet = false;
};

template <class Rows>
bool AllHold(const Rows& rows) {
  return std::all_of(rows.begin(), rows.end(), [](const auto& row) { return row.Holds(); });
}

std::string SettingText(const BenchSpeedFlags& flags) {
  const FrameSpeedOptions& options = flags.plan.base.options;
  return absl::StrCat(options.width, " x ", options.height, ", ", options.sampling.samples,
                      " sample(s) a pixel, epsilon ", options.epsilon, ", ",
                      flags.plan.base.threads, " thread(s), median of ", options.repeats);
}

void PrintMore(const BenchSpeedFlags& flags, const std::vector<SpeedRow>& rows) {
  if (flags.plan.stages) {
    std::cout << "\nns per pixel that frames take more with a stage than without it\n"
              << StageTable(rows);
  }
  if (!flags.explain) return;
  for (const SpeedRow& row : rows) {
    const FrameSpeed& flight = row.paths.back().flight;
    std::cout << "\n"
              << row.setting.name << "\n"
              << ExplanationText(
                     ExplanationToWire(*row.setting.scene, flight.explanation, kUsualExplained));
  }
}

absl::StatusOr<bool> RunScenes(const BenchSpeedFlags& flags, nlohmann::json& json) {
  ProgressBar bar(!flags.quiet && IsTerminal(), "bench speed");
  const auto rows = MeasureScenes(flags.plan, [&](double share) { bar.Show(share); });
  if (!rows.ok()) return rows.status();
  std::cout << "Classical frames, " << flags.size.width << " x " << flags.size.height
            << ", one thread, median of " << flags.plan.base.options.repeats << "\n"
            << TracerTable(*rows)
            << "\nFrames by packets with the surface trees against classical ones by packets: "
            << SettingText(flags) << "\n"
            << PathTable(*rows);
  PrintMore(flags, *rows);
  json["scenes"] = nlohmann::json::array();
  for (const SpeedRow& row : *rows) json["scenes"].push_back(SpeedJson(row));
  return AllHold(*rows);
}

absl::StatusOr<bool> RunSweep(const BenchSpeedFlags& flags, Sweep sweep, nlohmann::json& json) {
  const std::string name(NameOf(sweep));
  ProgressBar bar(!flags.quiet && IsTerminal(), absl::StrCat("sweep over ", name));
  const std::vector<double> points = flags.points.empty() ? DefaultPoints(sweep) : flags.points;
  const auto rows = MeasureSweep(flags.plan, sweep, points, [&](double s) { bar.Show(s); });
  if (!rows.ok()) return rows.status();
  std::cout << "Cached frames against classical ones over " << name << ": " << SettingText(flags)
            << " where it does not say otherwise\n"
            << PathTable(*rows,
                         sweep == Sweep::kObjects || sweep == Sweep::kLights ? "point" : name);
  PrintMore(flags, *rows);
  std::cout << "\n";
  nlohmann::json out = {{"sweep", name}, {"rows", nlohmann::json::array()}};
  for (const SpeedRow& row : *rows) {
    out["rows"].push_back(SpeedJson(row));
    out["rows"].back()["point"] = row.point;
  }
  json["sweeps"].push_back(std::move(out));
  if (!flags.svg.empty()) {
    const std::string file = absl::StrCat(flags.svg, "/", name, ".svg");
    if (auto s = WriteFileAtomically(file, SvgPlots(SweepPlots(sweep, *rows))); !s.ok()) return s;
  }
  return AllHold(*rows);
}

absl::StatusOr<bool> RunTargets(const BenchSpeedFlags& flags, nlohmann::json& json) {
  ProgressBar bar(!flags.quiet && IsTerminal(), "targets");
  const auto results =
      MeasureAllTargets(flags.plan, flags.target_part, [&](double share) { bar.Show(share); });
  if (!results.ok()) return results.status();
  const auto met = std::count_if(results->begin(), results->end(),
                                 [](const TargetResult& result) { return result.IsMet(); });
  std::cout << "Targets, median of " << flags.plan.base.options.repeats << "\n"
            << TargetTable(*results) << met << " of " << results->size() << " met\n";
  json["targets"] = nlohmann::json::array();
  for (const TargetResult& result : *results) json["targets"].push_back(TargetJson(result));
  return std::all_of(results->begin(), results->end(),
                     [](const TargetResult& result) { return result.beyond == 0; });
}

absl::StatusOr<bool> RunAll(const BenchSpeedFlags& flags, nlohmann::json& json) {
  if (flags.targets) return RunTargets(flags, json);
  if (flags.sweeps.empty()) return RunScenes(flags, json);
  bool holds = true;
  json["sweeps"] = nlohmann::json::array();
  for (const Sweep sweep : flags.sweeps) {
    const auto held = RunSweep(flags, sweep, json);
    if (!held.ok()) return held.status();
    holds = holds && *held;
  }
  return holds;
}

absl::Status CheckSpeedFlags(const BenchSpeedFlags& flags) {
  for (const Sweep sweep : flags.sweeps) {
    for (const double point : flags.points) {
      if (auto s = ValidatePoint(sweep, point); !s.ok()) return s;
    }
  }
  std::vector<std::string> files;
  if (!flags.json.empty()) files.push_back(flags.json);
  if (!flags.svg.empty()) files.push_back(flags.svg + "/plot.svg");
  return CheckFolders(files);
}

absl::StatusOr<int> BenchSpeed(BenchSpeedFlags& flags) {
  if (auto s = CheckSpeedFlags(flags); !s.ok()) return s;
  flags.plan.base.options.width = flags.size.width;
  flags.plan.base.options.height = flags.size.height;
  if (!flags.walk.empty()) {
    const auto path = LoadCameraPath(flags.walk);
    if (!path.ok()) return path.status();
    auto views = SampleCameraPath(*path, flags.plan.flights.flight_frames);
    if (!views.ok()) return views.status();
    flags.plan.flights.walk = *std::move(views);
  }
  nlohmann::json json = nlohmann::json::object();
  const auto holds = RunAll(flags, json);
  if (!holds.ok()) return holds.status();
  if (!flags.json.empty()) {
    if (auto s = WriteJson(json, flags.json); !s.ok()) return s;
  }
  return *holds ? kExitOk : kExitFailure;
}

void AddSceneChoice(CLI::App& app, SpeedPlan& plan) {
  app.add_option("--scene", plan.scenes, "Scene file; may be given again")
      ->type_name("FILE")
      ->allow_extra_args(false)
      ->default_str("a choice of the folder's");
  app.add_option("--scenes", plan.scenes_dir, "Folder of the scenes")
      ->type_name("DIR")
      ->capture_default_str();
  app.add_option("--made", plan.made,
                 "KIND:OBJECTS:LIGHTS, a scene made for the purpose: spheres, room, mirrors or "
                 "glass; may be given again")
      ->type_name("SPEC")
      ->allow_extra_args(false);
}

template <size_t N, class Enum>
std::map<std::string, Enum> ByName(const std::array<std::string_view, N>& names) {
  std::map<std::string, Enum> values;
  for (size_t i = 0; i < N; ++i) values[std::string(names[i])] = static_cast<Enum>(i);
  return values;
}

void AddSweepFlags(CLI::App& app, BenchSpeedFlags& flags) {
  CLI::Option* sweep =
      app.add_option(
             "--sweep", flags.sweeps,
             "Over lights, objects, depth, resolution, epsilon, threads or samples, in place "
             "of one setting; may be given again")
          ->transform(CLI::CheckedTransformer(ByName<kSweepNames.size(), Sweep>(kSweepNames)))
          ->type_name("WHAT")
          ->allow_extra_args(false);
  app.add_option_function<std::string>(
         "--points",
         [&flags](const std::string& text) {
           const auto points = ParseNumbers(text);
           if (!points.ok()) {
             throw CLI::ValidationError("--points", std::string(points.status().message()));
           }
           if (flags.sweeps.size() > 1) {
             throw CLI::ValidationError("--points", "expected one --sweep");
           }
           flags.points = *points;
         },
         "Of the sweep")
      ->type_name("N,N,…")
      ->default_str("the sweep's own")
      ->needs(sweep);
  app.add_option("--svg", flags.svg, "Also draw each sweep into this folder, as WHAT.svg")
      ->type_name("DIR")
      ->needs(sweep);
  app.add_flag("--targets", flags.targets,
               "What was to be reached, row by row, in scenes and settings of its own, beside what "
               "a cache could reach that had all lights for nothing")
      ->excludes(sweep);
  app.add_option("--target-scenes", flags.target_part,
                 "Only targets whose scene's name contains this")
      ->type_name("TEXT")
      ->needs("--targets");
}

void AddPathFlags(CLI::App& app, BenchSpeedFlags& flags) {
  app.add_option("--path", flags.plan.flights.paths,
                 "cold: first frame of a cache; warm: last of --frames of one view; walk: an orbit "
                 "of a degree a frame; teleport: random views; may be given again")
      ->transform(
          CLI::CheckedTransformer(ByName<kSpeedPathNames.size(), SpeedPath>(kSpeedPathNames)))
      ->type_name("PATH")
      ->allow_extra_args(false)
      ->default_str("cold and warm");
  app.add_option("--walk", flags.walk, "Camera path for --path walk, in place of the orbit")
      ->type_name("FILE");
  app.add_option("--frames", flags.plan.flights.still_frames,
                 "Frames of one view on one cache; the last is the warm one")
      ->type_name("N")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--flight", flags.plan.flights.flight_frames, "Frames of a walk or of teleports")
      ->type_name("N")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
}

void AddMeasureFlags(CLI::App& app, BenchSpeedFlags& flags) {
  SpeedSetting& base = flags.plan.base;
  AddSizeFlags(app, flags.size);
  app.add_option("--epsilon", base.options.epsilon, "What cached frames promise")
      ->type_name("E")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  app.add_option("--threads", base.threads, "Of cached frames and those they are compared with")
      ->type_name("N")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  AddLimitsFlags(app, base.options.limits);
  AddSamplingFlags(app, base.options.sampling);
  app.add_option("--repeat", base.options.repeats,
                 "Times that each frame is taken; the median counts")
      ->type_name("N")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_flag("--stages", flags.plan.stages,
               "Also what each stage costs, by frames that are taken with and without it");
  app.add_flag("--explain", flags.explain,
               "Also print what was left out, for each scene and object, and why, after the last "
               "path's last frame");
  AddJsonFlag(app, flags.json, "everything");
  AddQuietFlag(app, flags.quiet);
}

}  // namespace

void AddBenchSpeed(CLI::App& bench, Commands& commands) {
  auto flags = std::make_shared<BenchSpeedFlags>();
  CLI::App* app = bench.add_subcommand(
      "speed", "Packets against the scalar tracer, cached frames against classical ones");
  AddSceneChoice(*app, flags->plan);
  AddPathFlags(*app, *flags);
  AddSweepFlags(*app, *flags);
  AddMeasureFlags(*app, *flags);
  app->footer(
      "Frames of the two tracers alternate in one process. \"Again\": rays that the packets leave\n"
      "to the scalar tracer. \"Ratio\": classical / cached of the same view in turn, the median of "
      "the repeats, then of\nthe frames; \"least\": of the frame that does worst. Ends with status "
      "1 when a pixel's ray tree differs, or\nradiance by more than allowed, or a cached pixel is "
      "beyond epsilon; a target that is missed does not count.\n\nTargets: \"without lights\" is "
      "the ratio of "
      "classical frames to those of the same scene by the same\ntracer when all its lights are "
      "gone; eye, branches (reflected and refracted rays) and lights are what\nclassical frames "
      "spend. Sheets, which spare hits as well, may do better.\n\nExamples:\n"
      "  linetree bench speed --json speed.json\n"
      "  linetree bench speed --scene scenes/room.textproto --width 1920 --height 1080 --repeat 9\n"
      "  linetree bench speed --sweep lights --sweep resolution --svg . --json sweeps.json\n"
      "  linetree bench speed --sweep objects --points 100,10000 --path walk --path teleport\n"
      "  linetree bench speed --targets --target-scenes room");
  commands.push_back({app, [flags] { return BenchSpeed(*flags); }});
}

}  // namespace linetree
