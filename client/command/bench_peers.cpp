// linetree bench peers: the same pictures by other ray tracers.
#include <algorithm>
#include <iostream>
#include <memory>
#include <thread>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "client/command/command.h"
#include "client/command/flags.h"
#include "client/command/output.h"
#include "client/command/peers_report.h"
#include "client/command/progress_bar.h"
#include "client/command/session.h"
#include "core/io/wire.h"

namespace linetree {
namespace {

struct BenchPeersFlags {
  std::vector<std::string> scenes = {"scenes/room.textproto"};
  ViewFlags view;
  SizeFlags size;
  PathLimits limits;
  std::vector<std::string> peers;
  int repeats = 5;
  int threads = 0;
  std::string json;
  std::string pictures;
  bool quiet = false;
};

std::vector<std::string> PeerNames() {
  std::vector<std::string> names;
  for (const PeerKind& kind : AllPeers()) names.push_back(kind.name);
  return names;
}

// The peers asked for; the first one, the reference, is always among them.
std::vector<PeerKind> Chosen(const std::vector<std::string>& names) {
  std::vector<PeerKind> kinds = AllPeers();
  if (names.empty()) return kinds;
  const auto unwanted = [&](const PeerKind& kind) {
    return std::find(names.begin(), names.end(), kind.name) == names.end();
  };
  kinds.erase(std::remove_if(kinds.begin() + 1, kinds.end(), unwanted), kinds.end());
  return kinds;
}

std::vector<int> ThreadCounts(int threads) {
  if (threads == 0) threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  return threads == 1 ? std::vector<int>{1} : std::vector<int>{1, threads};
}

// What is to be rendered.
struct View {
  SceneFile file;
  Camera camera;
};

// All of them: what is missing is better known before the work than after it.
absl::StatusOr<std::vector<View>> ReadViews(const BenchPeersFlags& flags) {
  std::vector<View> views;
  for (const std::string& path : flags.scenes) {
    auto file = ReadSceneFileChecked(path);
    if (!file.ok()) return file.status();
    const auto camera = ResolveCamera(SceneInfoToWire(file->name, *file->scene, 0), flags.view);
    if (!camera.ok()) return camera.status();
    views.push_back({*std::move(file), *camera});
  }
  return views;
}

ScenePeers Measure(const BenchPeersFlags& flags, const View& view) {
  PeerStudyOptions options;
  options.camera = view.camera;
  options.width = flags.size.width;
  options.height = flags.size.height;
  options.repeats = flags.repeats;
  options.thread_counts = ThreadCounts(flags.threads);
  options.limits = flags.limits;
  ProgressBar bar(!flags.quiet && IsTerminal(), "bench peers: " + view.file.name);
  return {view.file.name, options.width, options.height,
          StudyPeers(Chosen(flags.peers), view.file.scene, options,
                     [&bar](double share) { bar.Show(share); })};
}

absl::Status WritePictures(const ScenePeers& scene, const std::string& folder) {
  for (const PeerRow& row : scene.rows) {
    if (!row.status.ok() || row.threads != 1) continue;
    Frame frame;
    frame.width = scene.width;
    frame.height = scene.height;
    frame.radiance.assign(row.radiance.begin(), row.radiance.end());
    const std::string path = absl::StrCat(folder, "/", scene.scene, "_", row.peer, ".png");
    if (auto s = WritePicture(frame, Layer::kBeauty, path); !s.ok()) return s;
  }
  return absl::OkStatus();
}

std::string Heading(const ScenePeers& scene, int repeats) {
  return absl::StrCat(scene.scene, ", ", scene.width, " x ", scene.height, ", ", repeats,
                      repeats == 1 ? " picture each\n" : " pictures each\n");
}

// Whether some peer that is there failed; says so on standard error.
bool ReportFailures(const ScenePeers& scene) {
  bool failed = false;
  for (const PeerRow& row : scene.rows) {
    if (!row.Failed()) continue;
    failed = true;
    Report(absl::Status(row.status.code(), absl::StrCat(scene.scene, ": ", row.status.message())));
  }
  return failed;
}

absl::StatusOr<int> BenchPeers(const BenchPeersFlags& flags) {
  std::vector<std::string> outputs;
  if (!flags.json.empty()) outputs.push_back(flags.json);
  if (!flags.pictures.empty()) outputs.push_back(flags.pictures + "/");
  if (absl::Status status = CheckFolders(outputs); !status.ok()) return status;
  const auto views = ReadViews(flags);
  if (!views.ok()) return views.status();
  std::vector<ScenePeers> measured;
  bool failed = false;
  for (const View& view : *views) {
    const ScenePeers& scene = measured.emplace_back(Measure(flags, view));
    if (!flags.quiet) {
      std::cout << Heading(scene, flags.repeats) << PeersTable(scene) << PeersNotes(scene)
                << std::endl;
    }
    failed = ReportFailures(scene) || failed;
    if (flags.pictures.empty()) continue;
    if (auto s = WritePictures(scene, flags.pictures); !s.ok()) return s;
  }
  if (!flags.json.empty()) {
    if (auto s = WriteJson(PeersJson(measured, flags.repeats), flags.json); !s.ok()) return s;
  }
  return failed ? kExitFailure : kExitOk;
}

// "512x384" into two numbers; the message of what is wrong with it, or nothing.
std::string ParseSize(const std::string& text, SizeFlags& size) {
  const std::vector<std::string> sides = absl::StrSplit(text, 'x');
  SizeFlags read;
  if (sides.size() != 2 || !absl::SimpleAtoi(sides[0], &read.width) ||
      !absl::SimpleAtoi(sides[1], &read.height)) {
    return absl::StrCat("expected WIDTHxHEIGHT, found '", text, "'");
  }
  if (auto s = ValidateSize(read.width, read.height, RenderLimits{}); !s.ok()) {
    return std::string(s.message());
  }
  size = read;
  return {};
}

void AddFlags(CLI::App& app, BenchPeersFlags& flags) {
  app.add_option("--scene", flags.scenes, "Scene file; may be given again")
      ->type_name("FILE")
      ->allow_extra_args(false)
      ->capture_default_str()
      ->group("Scene");
  AddViewFlags(app, flags.view);
  app.add_option_function<std::string>(
         "--size",
         [&flags](const std::string& text) {
           const std::string error = ParseSize(text, flags.size);
           if (!error.empty()) throw CLI::ValidationError("--size", error);
         },
         "Columns and rows of the pictures")
      ->type_name("WxH")
      ->default_str(absl::StrCat(flags.size.width, "x", flags.size.height))
      ->group("View");
  AddLimitsFlags(app, flags.limits);
  app.add_option("--peer", flags.peers, "Only these, beside the classical tracer")
      ->type_name("NAME")
      ->delimiter(',')
      ->check(CLI::IsMember(PeerNames()))
      ->default_str("all");
  app.add_option("--repeat", flags.repeats, "Pictures by each, of which the median time counts")
      ->type_name("N")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--threads", flags.threads,
                 "Each renders with one thread and with this many; 0: all hardware threads")
      ->type_name("T")
      ->check(CLI::Range(0, 256))
      ->capture_default_str();
  AddJsonFlag(app, flags.json, "the tables");
  app.add_option("--pictures", flags.pictures, "Also write SCENE_PEER.png into this folder")
      ->type_name("DIR")
      ->group("Output");
  AddQuietFlag(app, flags.quiet);
}

}  // namespace

void AddBenchPeers(CLI::App& bench, Commands& commands) {
  auto flags = std::make_shared<BenchPeersFlags>();
  CLI::App* app = bench.add_subcommand("peers", "The same pictures by other ray tracers, timed");
  AddFlags(*app, *flags);
  app->footer(
      "classical is this project's tracer without its cache, embree a plain loop over rays that\n"
      "Embree intersects, povray and tachyon are the programs of that name (Debian packages\n"
      "povray, tachyon). All render in turn, in one run. What is timed is the picture alone, not\n"
      "the reading of scenes and the building of hierarchies: the programs' own figures for them.\n"
      "Differences are from the first row's picture, of values clipped to [0, 1]. Ends with\n"
      "status 1 when a peer that is there fails.\n\n"
      "Examples:\n"
      "  linetree bench peers --scene scenes/room.textproto --json peers.json\n"
      "  linetree bench peers --scene scenes/glass.textproto --scene scenes/spd/balls_4.nff "
      "--size 256x256 --threads 1");
  commands.push_back({app, [flags] { return BenchPeers(*flags); }});
}

}  // namespace linetree
