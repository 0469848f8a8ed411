// linetree bench speed: classical frames by packets against those of the scalar tracer, and cached
// frames by packets against classical ones.
#include <algorithm>
#include <array>
#include <filesystem>
#include <iostream>
#include <memory>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"
#include "client/command/command.h"
#include "client/command/flags.h"
#include "client/command/output.h"
#include "client/command/progress_bar.h"
#include "client/command/table.h"
#include "core/audit/frame_speed.h"
#include "core/audit/speed_scenes.h"
#include "core/audit/speed_study.h"
#include "core/io/load_scene.h"

namespace linetree {
namespace {

struct BenchSpeedFlags {
  std::vector<std::string> scenes;
  std::string scenes_dir = "scenes";
  SizeFlags size;
  SpeedStudyOptions study;
  std::vector<std::string> made;
  double epsilon = 0.02;
  int frames = 5;
  int threads = 1;
  std::string json;
  bool quiet = false;
};

struct SpeedRow {
  std::string scene;
  SpeedStudy study;
  FrameSpeed frames;

  bool Holds() const {
    return frames.beyond == 0 && study.different_topology == 0 && study.different_counts == 0 &&
           study.largest_difference <= study.allowed_difference;
  }
};

// The scenes of the planned comparison.
constexpr std::array<std::string_view, 13> kScenes = {
    "room.textproto",  "face.textproto",  "glass.textproto",  "many_lights.textproto",
    "spd/balls_2.nff", "spd/balls_4.nff", "spd/gears_1.nff",  "spd/mount_4.nff",
    "spd/mount_6.nff", "spd/rings_1.nff", "spd/teapot_2.nff", "spd/tetra_6.nff",
    "spd/tree_8.nff"};

double Share(uint64_t part, uint64_t all) {
  return all == 0 ? 0 : static_cast<double>(part) / static_cast<double>(all);
}
double HitsAgain(const PacketCounts& c) {
  return Share(c.hits_again, c.rays.intersect - c.rays.shadow);
}
double ShadowsAgain(const PacketCounts& c) { return Share(c.shadows_again, c.rays.shadow); }

std::string SpeedTable(const std::vector<SpeedRow>& rows) {
  Table table({{"scene"},
               {"objects", Align::kRight},
               {"lights", Align::kRight},
               {"scalar ns/px", Align::kRight},
               {"packet ns/px", Align::kRight},
               {"least..most", Align::kRight},
               {"ratio", Align::kRight},
               {"hits again", Align::kRight},
               {"shadows again", Align::kRight},
               {"other trees", Align::kRight},
               {"largest difference", Align::kRight},
               {"allowed", Align::kRight}});
  for (const SpeedRow& row : rows) {
    const SpeedStudy& s = row.study;
    table.AddRow(
        {row.scene, Grouped(s.objects), Grouped(s.lights), absl::StrFormat("%.1f", s.scalar.median),
         absl::StrFormat("%.1f", s.packet.median),
         absl::StrFormat("%.1f..%.1f", s.packet.least, s.packet.most),
         absl::StrFormat("%.1f", s.ratio), absl::StrFormat("%.3f %%", 100 * HitsAgain(s.counts)),
         absl::StrFormat("%.3f %%", 100 * ShadowsAgain(s.counts)), Grouped(s.different_topology),
         absl::StrFormat("%.1e", s.largest_difference),
         absl::StrFormat("%.1e", s.allowed_difference)});
  }
  return table.ToString();
}

std::string FrameTable(const std::vector<SpeedRow>& rows) {
  Table table({{"scene"},
               {"objects", Align::kRight},
               {"lights", Align::kRight},
               {"classical ns/px", Align::kRight},
               {"cold ns/px", Align::kRight},
               {"ratio", Align::kRight},
               {"second", Align::kRight},
               {"warm ns/px", Align::kRight},
               {"ratio", Align::kRight},
               {"interpolated", Align::kRight},
               {"replayed", Align::kRight},
               {"MB", Align::kRight},
               {"largest error", Align::kRight},
               {"beyond", Align::kRight}});
  for (const SpeedRow& row : rows) {
    const FrameSpeed& f = row.frames;
    const FrameSpeed::Turn &cold = f.turns.front(), &warm = f.turns.back();
    const FrameSpeed::Turn& second = f.turns[std::min<size_t>(1, f.turns.size() - 1)];
    table.AddRow({row.scene, Grouped(row.study.objects), Grouped(row.study.lights),
                  absl::StrFormat("%.1f", warm.classical.median),
                  absl::StrFormat("%.1f", cold.cached.median), absl::StrFormat("%.2f", cold.ratio),
                  absl::StrFormat("%.2f", second.ratio),
                  absl::StrFormat("%.1f", warm.cached.median), absl::StrFormat("%.2f", warm.ratio),
                  absl::StrFormat("%.1f %%", 100 * f.interpolated),
                  absl::StrFormat("%.1f %%", 100 * f.replayed),
                  absl::StrFormat("%.2f", static_cast<double>(f.bytes) / 1e6),
                  absl::StrFormat("%.2g", f.largest_error), Grouped(f.beyond)});
  }
  return table.ToString();
}

nlohmann::json SpreadJson(const SpeedSpread& spread) {
  return {{"median", spread.median}, {"least", spread.least}, {"most", spread.most}};
}

nlohmann::json FramesJson(const FrameSpeed& frames) {
  nlohmann::json json = {{"interpolated", frames.interpolated},
                         {"replayed", frames.replayed},
                         {"residual", frames.residual},
                         {"cells", frames.cells},
                         {"bytes", frames.bytes},
                         {"pixels", frames.pixels},
                         {"beyond", frames.beyond},
                         {"largest_error", frames.largest_error}};
  json["turns"] = nlohmann::json::array();
  for (const FrameSpeed::Turn& turn : frames.turns) {
    json["turns"].push_back({{"classical_ns_per_pixel", SpreadJson(turn.classical)},
                             {"cached_ns_per_pixel", SpreadJson(turn.cached)},
                             {"ratio", turn.ratio}});
  }
  return json;
}

nlohmann::json SpeedJson(const BenchSpeedFlags& flags, const std::vector<SpeedRow>& rows) {
  nlohmann::json json = {{"width", flags.study.width},
                         {"height", flags.study.height},
                         {"repeats", flags.study.repeats},
                         {"epsilon", flags.epsilon},
                         {"threads", flags.threads},
                         {"max_depth", flags.study.limits.max_depth},
                         {"min_weight", flags.study.limits.min_weight}};
  json["scenes"] = nlohmann::json::array();
  for (const SpeedRow& row : rows) {
    const SpeedStudy& s = row.study;
    json["scenes"].push_back({{"scene", row.scene},
                              {"objects", s.objects},
                              {"lights", s.lights},
                              {"pixels", s.pixels},
                              {"scalar_ns_per_pixel", SpreadJson(s.scalar)},
                              {"packet_ns_per_pixel", SpreadJson(s.packet)},
                              {"ratio", s.ratio},
                              {"intersect", s.counts.rays.intersect},
                              {"shadow", s.counts.rays.shadow},
                              {"packets", s.counts.packets},
                              {"shadow_packets", s.counts.shadow_packets},
                              {"hits_again", HitsAgain(s.counts)},
                              {"shadows_again", ShadowsAgain(s.counts)},
                              {"different_topology", s.different_topology},
                              {"different_counts", s.different_counts},
                              {"largest_difference", s.largest_difference},
                              {"allowed_difference", s.allowed_difference},
                              {"frames", FramesJson(row.frames)}});
  }
  return json;
}

using ScenePtr = std::shared_ptr<const Scene>;

// KIND:OBJECTS:LIGHTS, as --made takes it.
absl::StatusOr<ScenePtr> MadeScene(const std::string& text) {
  const std::vector<std::string> parts = absl::StrSplit(text, ':');
  int objects = 0, lights = 0;
  const bool good = parts.size() == 3 && absl::SimpleAtoi(parts[1], &objects) && objects >= 1 &&
                    objects <= 100'000 && absl::SimpleAtoi(parts[2], &lights) && lights >= 1 &&
                    lights <= 1024;
  if (good && parts[0] == "spheres") return MakeSpheres(objects, lights);
  if (good && parts[0] == "room") return MakeRoom(objects, lights, /*mirrors=*/false);
  if (good && parts[0] == "mirrors") return MakeRoom(objects, lights, /*mirrors=*/true);
  return absl::InvalidArgumentError(
      absl::StrCat("--made ", text,
                   ": expected spheres, room or mirrors, then the number of objects (up to "
                   "100,000) and of lights (up to 1,024), such as room:18:16"));
}

struct NamedScene {
  std::string name;
  ScenePtr scene;
};

absl::StatusOr<std::vector<NamedScene>> ScenesOf(const BenchSpeedFlags& flags) {
  std::vector<std::string> files = flags.scenes;
  if (files.empty() && flags.made.empty()) {
    for (const std::string_view name : kScenes) {
      files.push_back(flags.scenes_dir + "/" + std::string(name));
    }
  }
  std::vector<NamedScene> scenes;
  for (const std::string& file : files) {
    auto scene = LoadSceneFile(file);
    if (!scene.ok()) return scene.status();
    if ((*scene)->cameras.empty()) {
      return absl::InvalidArgumentError(absl::StrCat(file, ": expected a camera"));
    }
    scenes.push_back({std::filesystem::path(file).stem(), *std::move(scene)});
  }
  for (const std::string& made : flags.made) {
    auto scene = MadeScene(made);
    if (!scene.ok()) return scene.status();
    scenes.push_back({made, *std::move(scene)});
  }
  return scenes;
}

absl::StatusOr<std::vector<SpeedRow>> Measure(const BenchSpeedFlags& flags) {
  const auto scenes = ScenesOf(flags);
  if (!scenes.ok()) return scenes.status();
  std::vector<SpeedRow> rows;
  WorkerPool pool(flags.threads);
  ProgressBar bar(!flags.quiet && IsTerminal(), "bench speed");
  for (const auto& [name, scene] : *scenes) {
    const Tracer tracer(*scene);
    const PacketTracer packets(tracer);
    const Camera& camera = scene->cameras[0];
    const FrameSpeedOptions frames = {flags.study.width, flags.study.height, flags.study.repeats,
                                      flags.frames,      flags.epsilon,      flags.study.limits};
    auto speed = StudyFrameSpeed(scene, camera, frames, pool);
    if (!speed.ok()) return speed.status();
    rows.push_back({name, StudySpeed(tracer, packets, camera, flags.study), *std::move(speed)});
    bar.Show(static_cast<double>(rows.size()) / static_cast<double>(scenes->size()));
  }
  return rows;
}

absl::StatusOr<int> BenchSpeed(BenchSpeedFlags& flags) {
  if (!flags.json.empty()) {
    if (absl::Status status = CheckFolders({flags.json}); !status.ok()) return status;
  }
  flags.study.width = flags.size.width;
  flags.study.height = flags.size.height;
  const auto rows = Measure(flags);
  if (!rows.ok()) return rows.status();
  std::cout << "Classical frames, " << flags.study.width << " x " << flags.study.height
            << ", one thread, median of " << flags.study.repeats << "\n"
            << SpeedTable(*rows) << "\nFrames by packets with the surface trees, epsilon "
            << flags.epsilon << ", against classical ones by packets, " << flags.threads
            << " thread(s): first, second and frame " << flags.frames << " of one view\n"
            << FrameTable(*rows);
  if (!flags.json.empty()) {
    if (auto s = WriteJson(SpeedJson(flags, *rows), flags.json); !s.ok()) return s;
  }
  const bool holds = std::all_of(rows->begin(), rows->end(), [](auto& row) { return row.Holds(); });
  return holds ? kExitOk : kExitFailure;
}

}  // namespace

void AddBenchSpeed(CLI::App& bench, Commands& commands) {
  auto flags = std::make_shared<BenchSpeedFlags>();
  CLI::App* app = bench.add_subcommand(
      "speed", "Packets against the scalar tracer, cached frames against classical ones");
  app->add_option("--scene", flags->scenes, "Scene file; may be given again")
      ->type_name("FILE")
      ->allow_extra_args(false)
      ->default_str("a choice of the folder's");
  app->add_option("--scenes", flags->scenes_dir, "Folder of the scenes")
      ->type_name("DIR")
      ->capture_default_str();
  app->add_option(
         "--made", flags->made,
         "KIND:OBJECTS:LIGHTS, a scene made for the purpose: spheres, room or mirrors; may be "
         "given again")
      ->type_name("SPEC")
      ->allow_extra_args(false);
  AddSizeFlags(*app, flags->size);
  app->add_option("--epsilon", flags->epsilon, "What cached frames promise")
      ->type_name("E")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  app->add_option("--frames", flags->frames,
                  "Frames of one view on one cache; the last is the warm one")
      ->type_name("N")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app->add_option("--threads", flags->threads, "Of cached frames and those they are compared with")
      ->type_name("N")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  AddLimitsFlags(*app, flags->study.limits);
  app->add_option("--repeat", flags->study.repeats, "Frames of each tracer; the median counts")
      ->type_name("N")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app->add_option("--json", flags->json, "Also write the table as JSON to this file");
  AddQuietFlag(*app, flags->quiet);
  app->footer(
      "Frames of the two tracers alternate in one process and one thread. \"Again\": rays that the "
      "packets leave\nto the scalar tracer. Ends with status 1 when a pixel's ray tree differs, or "
      "radiance by more than allowed, or a cached pixel is beyond epsilon.\n\nExamples:\n  "
      "linetree bench speed --json speed.json\n  "
      "linetree bench speed --scene scenes/room.textproto --width 1920 --height 1080 --repeat 9");
  commands.push_back({app, [flags] { return BenchSpeed(*flags); }});
}

}  // namespace linetree
