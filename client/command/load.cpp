// linetree load: many clients that fly camera paths at the same time.
#include <fstream>
#include <iostream>
#include <memory>

#include "absl/strings/str_cat.h"
#include "client/command/command.h"
#include "client/command/flags.h"
#include "client/command/load_page.h"
#include "client/command/load_run.h"
#include "client/command/output.h"
#include "client/command/progress_bar.h"
#include "client/command/session.h"
#include "core/io/atomic_file.h"
#include "core/io/camera_path.h"
#include "core/io/read_file.h"

namespace linetree {
namespace {

constexpr int kMaxClients = 1024;
constexpr double kMaxRate = 1e5;      // frames per second
constexpr double kMaxArrivals = 1e7;  // of one test: a sample is kept of each
constexpr uint64_t kMaxStatsBytes = uint64_t{64} << 20;

struct LoadFlags {
  ConnectionFlags connection;
  SceneFlags scene;
  SizeFlags size{256, 256};
  RenderOptions options;
  Sampling sampling;
  std::vector<std::string> paths;
  std::optional<double> overlap;
  int clients = 4;
  size_t frames = 0;  // of each client; 0: as many as its piece has, or no bound with a duration
  double duration_s = 0;
  size_t warm_up_frames = 0;
  std::optional<double> rate;
  ArrivalOptions arrivals;
  bool stream = false;
  FrameFormat format;
  std::optional<double> newest;  // viewpoints a second of each client
  std::vector<LoadObjective> objectives;
  std::string compare;
  std::vector<std::string> plots;  // .svg
  std::string stats, csv, html;
  bool quiet = false;
};

absl::StatusOr<LoadPlan> PlanOf(const LoadFlags& flags) {
  LoadPlan plan{.frames_each = flags.frames,
                .duration_s = flags.duration_s,
                .warm_up_frames = flags.warm_up_frames,
                .stream = flags.stream,
                .format = flags.format,
                .newest = flags.newest};
  plan.frame.width = flags.size.width;
  plan.frame.height = flags.size.height;
  plan.frame.options = flags.options;
  plan.frame.sampling = flags.sampling;
  std::vector<size_t> path_frames;
  for (const std::string& file : flags.paths) {
    const absl::StatusOr<CameraPath> path = LoadCameraPath(file);
    if (!path.ok()) return path.status();
    absl::StatusOr<std::vector<Camera>> cameras = SampleCameraPath(*path, path->frames);
    if (!cameras.ok()) return cameras.status();
    path_frames.push_back(cameras->size());
    plan.paths.push_back(*std::move(cameras));
  }
  plan.pieces = PlanPieces(static_cast<size_t>(flags.clients), path_frames, flags.overlap);
  if (flags.rate && *flags.rate * flags.duration_s > kMaxArrivals) {
    return absl::InvalidArgumentError(absl::StrCat("--rate: expected at most ", kMaxArrivals,
                                                   " frames within --duration, got ",
                                                   *flags.rate * flags.duration_s));
  }
  if (flags.rate) {
    plan.arrivals = flags.arrivals;
    plan.arrivals->rate = *flags.rate;
  }
  return plan;
}

// In this process all clients share the cache through one object; against a server each has a
// connection of its own. A refusal counts, so nothing is tried again in silence.
absl::StatusOr<std::vector<std::unique_ptr<Client>>> ConnectAll(const LoadFlags& flags) {
  std::vector<std::unique_ptr<Client>> clients;
  if (flags.connection.local) return clients;
  absl::StatusOr<ClientOptions> options = ReadClientOptions(flags.connection);
  if (!options.ok()) return options.status();
  options->retry.max_attempts = 1;
  for (int c = 0; c < flags.clients; ++c) {
    absl::StatusOr<std::unique_ptr<Client>> client =
        Client::Connect(flags.connection.server, *options);
    if (!client.ok()) return client.status();
    clients.push_back(*std::move(client));
  }
  return clients;
}

absl::StatusOr<std::vector<LoadPhase>> Measure(const LoadFlags& flags) {
  absl::StatusOr<LoadPlan> plan = PlanOf(flags);
  if (!plan.ok()) return plan.status();
  const absl::StatusOr<Session> session = OpenSession(flags.connection, flags.scene);
  if (!session.ok()) return session.status();
  const auto own = ConnectAll(flags);
  if (!own.ok()) return own.status();
  std::vector<Client*> clients(plan->pieces.size(), session->client.get());
  for (size_t c = 0; c < own->size(); ++c) clients[c] = (*own)[c].get();
  plan->scene = session->scene.name();
  ProgressBar bar(!flags.quiet && IsTerminal(), "load");
  return RunLoad(
      *plan, clients, [&bar](double share) { bar.Show(share); }, session->client.get());
}

// The run to compare with, read before the new one begins.
absl::StatusOr<nlohmann::json> ReadStats(const std::string& path) {
  const absl::StatusOr<std::string> text = ReadFileAtMost(path, kMaxStatsBytes);
  if (!text.ok()) return text.status();
  nlohmann::json json = nlohmann::json::parse(*text, nullptr, /*allow_exceptions=*/false);
  const absl::Status status = CompareLoads(json, {}).status();
  if (status.ok()) return json;
  return absl::Status(status.code(), absl::StrCat("--compare: ", path, ": ", status.message()));
}

absl::Status WriteFiles(const LoadFlags& flags, const LoadResult& result) {
  std::vector<std::pair<std::string, std::string>> files;  // name, content
  if (!flags.stats.empty()) {
    nlohmann::json json = LoadResultJson(result);
    json["clients"] = flags.clients;
    json["epsilon"] = flags.options.max_relative_error;
    files.emplace_back(flags.stats, json.dump(2) + "\n");
  }
  if (!flags.csv.empty()) files.emplace_back(flags.csv, LoadCsv(result.phases));
  if (!flags.html.empty()) files.emplace_back(flags.html, LoadHtml(result));
  for (const std::string& plot : flags.plots) {
    files.emplace_back(plot, SvgPlots(LoadResultPlots(result)));
  }
  for (const auto& [name, content] : files) {
    if (absl::Status status = WriteFileAtomically(name, content); !status.ok()) return status;
  }
  return absl::OkStatus();
}

absl::StatusOr<int> Load(const LoadFlags& flags) {
  std::vector<std::string> files = flags.plots;
  for (const std::string& file : {flags.stats, flags.csv, flags.html}) {
    if (!file.empty()) files.push_back(file);
  }
  if (absl::Status status = CheckFolders(files); !status.ok()) return status;
  absl::StatusOr<nlohmann::json> before = nlohmann::json();
  if (!flags.compare.empty()) before = ReadStats(flags.compare);
  if (!before.ok()) return before.status();
  absl::StatusOr<std::vector<LoadPhase>> phases = Measure(flags);
  if (!phases.ok()) return phases.status();
  LoadResult result{.title = absl::StrCat(flags.scene.scene, ", ", flags.clients, " clients"),
                    .phases = *std::move(phases),
                    .objectives = flags.objectives,
                    .provenance = ProvenanceOf()};
  for (const LoadPhase& phase : result.phases) result.figures.push_back(SummarizeLoad(phase));
  if (!flags.compare.empty()) result.changes = *CompareLoads(*before, result.measured());
  if (!flags.quiet) std::cout << "clients     " << flags.clients << "\n" << LoadText(result);
  if (absl::Status status = WriteFiles(flags, result); !status.ok()) return status;
  return result.MeetsObjectives() ? kExitOk : kExitMissed;
}

void AddPathFlags(CLI::App& app, LoadFlags& flags) {
  app.add_option("--path,--paths", flags.paths,
                 "Camera paths, which the clients take in turn; FILE,FILE or given again")
      ->type_name("FILE")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->required()
      ->group("View");
  app.add_option("--overlap", flags.overlap,
                 "How much of their pieces two neighbours on a path share:\n"
                 "0: pieces join end to end and cover the path once;\n"
                 "1: everybody flies the whole path from its beginning;\n"
                 "left out: everybody flies the whole path, starts are spread over it")
      ->type_name("F")
      ->check(CLI::Range(0.0, 1.0))
      ->group("View");
}

// When frames begin.
void AddLoopFlags(CLI::App& app, LoadFlags& flags) {
  auto* duration = app.add_option("--duration", flags.duration_s, "Begin no frame later than this")
                       ->type_name("SECONDS")
                       ->check(CLI::PositiveNumber)
                       ->group("Load");
  app.add_option("--warm-up", flags.warm_up_frames,
                 "First fly N frames of each client, reported apart; then all begin again")
      ->type_name("N")
      ->check(CLI::PositiveNumber)
      ->group("Load");
  auto* rate =
      app.add_option("--rate", flags.rate,
                     "Open loop: so many frames begin each second, whatever came of the others,\n"
                     "each at a client that is free; latency counts from when it was to begin")
          ->type_name("FRAMES_PER_S")
          ->check(CLI::Range(1e-3, kMaxRate))
          ->group("Load");
  const std::map<std::string, ArrivalKind> kinds = {{"fixed", ArrivalKind::kFixed},
                                                    {"poisson", ArrivalKind::kPoisson}};
  app.add_option("--arrivals", flags.arrivals.kind,
                 "fixed: at equal steps; poisson: independent of each other")
      ->transform(CLI::CheckedTransformer(kinds))
      ->type_name("KIND")
      ->default_str("fixed")
      ->needs(rate)
      ->group("Load");
  app.add_option("--seed", flags.arrivals.seed, "Of --arrivals poisson")
      ->type_name("SEED")
      ->capture_default_str()
      ->needs(rate)
      ->group("Load");
  auto* stream =
      app.add_flag(
             "--stream", flags.stream,
             "A flight for each client in place of single frames; a frame's latency is the time\n"
             "since the one before it, and the server's times are of frames sent ahead")
          ->excludes(rate)
          ->excludes(duration)
          ->group("Load");
  AddNewestFlag(app, flags.newest)->needs(stream)->group("Load");
}

void AddGoalFlags(CLI::App& app, LoadFlags& flags) {
  app.add_option_function<std::vector<std::string>>(
         "--objective",
         [&flags](const std::vector<std::string>& texts) {
           for (const std::string& text : texts) {
             const auto objective = ParseObjective(text);
             if (!objective.ok()) {
               throw CLI::ValidationError("--objective", std::string(objective.status().message()));
             }
             flags.objectives.push_back(*objective);
           }
         },
         "What the measured frames are to reach, such as p99_ms=50 or hit_rate=0.8 (which is at\n"
         "least, not at most); may be given again. A name that is none lists them all")
      ->type_name("NAME=NUMBER")
      ->allow_extra_args(false)
      ->group("Goals");
  app.add_option("--compare", flags.compare, "Show what has changed since the run of this --stats")
      ->type_name("FILE")
      ->group("Goals");
}

void AddFileFlags(CLI::App& app, LoadFlags& flags) {
  app.add_option("-o,--output", flags.plots, "Plots over time and of latencies, .svg")
      ->type_name("FILE")
      ->allow_extra_args(false)
      ->check(HasExtension({".svg"}))
      ->group("Output");
  AddStatsFlag(app, flags.stats);
  app.add_option("--csv", flags.csv, "A line for each frame")->type_name("FILE")->group("Output");
  app.add_option("--html", flags.html, "One page with everything, plots included")
      ->type_name("FILE")
      ->group("Output");
  AddQuietFlag(app, flags.quiet);
}

void AddFlags(CLI::App& app, LoadFlags& flags) {
  AddConnectionFlags(app, flags.connection);
  AddPriorityFlag(app, flags.connection);
  AddSceneFlags(app, flags.scene);
  AddPathFlags(app, flags);
  AddSizeFlags(app, flags.size);
  AddOptionsFlags(app, flags.options);
  AddSamplingFlags(app, flags.sampling);
  app.add_option("--clients", flags.clients, "Clients at the same time")
      ->type_name("N")
      ->check(CLI::Range(1, kMaxClients))
      ->capture_default_str()
      ->group("Load");
  app.add_option("--frames", flags.frames,
                 "Frames of each client; left out: once along its piece, or until the time is up")
      ->type_name("M")
      ->check(CLI::PositiveNumber)
      ->group("Load");
  AddLoopFlags(app, flags);
  AddGoalFlags(app, flags);
  AddFileFlags(app, flags);
  AddFormatFlags(app, flags.format);
}

}  // namespace

void AddLoad(CLI::App& parent, Commands& commands) {
  auto flags = std::make_shared<LoadFlags>();
  CLI::App* app =
      parent.add_subcommand("load", "Many clients that fly camera paths at the same time");
  AddFlags(*app, *flags);
  app->footer(
      "Frames that the server refuses for want of room are counted and do not end the test; other "
      "errors do.\nlate: no client was free when a frame was to begin; not begun: nor before the "
      "time was up.\nlight calls: GetStats, 40 times a second meanwhile, counted from when each "
      "was to begin.\n"
      "Exit status: 0; 1 on errors; 2 for a wrong command line; 3 when an objective was missed.\n\n"
      "Examples:\n"
      "  linetree load --scene room --path scenes/paths/room_walk.textproto --clients 8\n"
      "  linetree load --scene room --path scenes/paths/room_walk.textproto --clients 16 "
      "--overlap 0.5 --warm-up 8 --rate 30 --arrivals poisson --duration 60 --objective p99_ms=100 "
      "--html load.html --stats load.json\n"
      "  linetree load --scene room --path scenes/paths/room_walk.textproto --stream --newest 30 "
      "--codec jpeg --priority batch\n"
      "  linetree load --local --scene scenes/face.textproto --path "
      "scenes/paths/face_walk.textproto --duration 20 --stats new.json --compare load.json");
  commands.push_back({app, [flags] { return Load(*flags); }});
}

}  // namespace linetree
