// linetree load: many clients that fly one path at the same time.
#include <atomic>
#include <chrono>
#include <iostream>
#include <memory>
#include <mutex>
#include <thread>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/command/command.h"
#include "client/command/flags.h"
#include "client/command/load_report.h"
#include "client/command/output.h"
#include "client/command/progress_bar.h"
#include "client/command/session.h"
#include "client/command/table.h"
#include "core/io/atomic_file.h"
#include "core/io/camera_path.h"

namespace linetree {
namespace {

constexpr int kMaxClients = 1024;

struct LoadFlags {
  ConnectionFlags connection;
  SceneFlags scene;
  SizeFlags size{256, 256};
  RenderOptions options;
  Sampling sampling;
  std::string path;
  int clients = 4;
  int frames = 0;  // of each client; 0: as many as the path has, or no bound with a duration
  double duration_s = 0;
  std::string plot;
  std::string stats;
  bool quiet = false;
};

// What the clients share. Frames go round the path; client c starts c/N of it further on.
class LoadTest {
 public:
  LoadTest(const LoadFlags& flags, std::string scene, std::vector<Camera> cameras)
      : flags_(flags), scene_(std::move(scene)), cameras_(std::move(cameras)) {
    frames_each_ = flags.frames;
    if (frames_each_ == 0 && flags.duration_s == 0) {
      frames_each_ = static_cast<int>(cameras_.size());
    }
  }

  // One client each on a thread of its own. The first error ends the test.
  absl::StatusOr<std::vector<LoadSample>> RunClients(
      const std::vector<std::unique_ptr<Client>>& clients, Client* shared) {
    std::vector<std::thread> threads;
    for (int c = 0; c < flags_.clients; ++c) {
      Client* client = shared != nullptr ? shared : clients[static_cast<size_t>(c)].get();
      threads.emplace_back([this, c, client] { Fly(c, *client); });
    }
    for (std::thread& thread : threads) thread.join();
    if (!error_.ok()) return error_;
    return std::move(samples_);
  }

 private:
  using Clock = std::chrono::steady_clock;

  double Now() const { return std::chrono::duration<double>(Clock::now() - began_).count(); }

  bool Goes(int frame) const {
    return !stop_ && (frames_each_ == 0 || frame < frames_each_) &&
           (flags_.duration_s == 0 || Now() < flags_.duration_s);
  }

  void Fly(int number, Client& client) {
    const size_t offset =
        static_cast<size_t>(number) * cameras_.size() / static_cast<size_t>(flags_.clients);
    for (int frame = 0; Goes(frame); ++frame) {
      const Camera& camera = cameras_[(offset + static_cast<size_t>(frame)) % cameras_.size()];
      LoadSample sample{.start_s = Now()};
      const absl::StatusOr<Frame> answer = client.RenderFrame(
          scene_, {camera, flags_.size.width, flags_.size.height, flags_.options, flags_.sampling},
          "", false, {});
      sample.end_s = Now();
      const std::lock_guard lock(mutex_);
      if (!answer.ok()) {
        if (error_.ok()) error_ = answer.status();
        stop_ = true;
        return;
      }
      sample.hits = answer->stats.interpolated + answer->stats.replayed;
      sample.misses = answer->stats.traced - answer->stats.replayed;
      samples_.push_back(sample);
      ShowProgress(sample.end_s);
    }
  }

  void ShowProgress(double now_s) {
    const double by_time = flags_.duration_s > 0 ? now_s / flags_.duration_s : 0;
    const double all = static_cast<double>(frames_each_) * flags_.clients;
    const double by_frames = all > 0 ? static_cast<double>(samples_.size()) / all : 0;
    bar_.Show(std::max(by_time, by_frames));
  }

  const LoadFlags& flags_;
  const std::string scene_;
  const std::vector<Camera> cameras_;
  int frames_each_ = 0;  // 0: until the time is up
  const Clock::time_point began_ = Clock::now();
  std::atomic<bool> stop_{false};
  std::mutex mutex_;
  std::vector<LoadSample> samples_;  // guarded by mutex_
  absl::Status error_;               // guarded by mutex_
  ProgressBar bar_{!flags_.quiet && IsTerminal(), "load"};
};

absl::StatusOr<std::vector<LoadSample>> Measure(const LoadFlags& flags) {
  const absl::StatusOr<CameraPath> path = LoadCameraPath(flags.path);
  if (!path.ok()) return path.status();
  const absl::StatusOr<std::vector<Camera>> cameras = SampleCameraPath(*path, path->frames);
  if (!cameras.ok()) return cameras.status();
  absl::StatusOr<Session> session = OpenSession(flags.connection, flags.scene);
  if (!session.ok()) return session.status();
  // In this process all clients share the cache through one object; against a server each has a
  // connection of its own.
  std::vector<std::unique_ptr<Client>> clients;
  for (int c = 0; c < flags.clients && !flags.connection.local; ++c) {
    absl::StatusOr<std::unique_ptr<Client>> client = Connect(flags.connection);
    if (!client.ok()) return client.status();
    clients.push_back(*std::move(client));
  }
  LoadTest test(flags, session->scene.name(), *cameras);
  return test.RunClients(clients, flags.connection.local ? session->client.get() : nullptr);
}

void Print(const LoadFlags& flags, const LoadFigures& figures) {
  std::cout << absl::StrFormat("clients     %d\nframes      %s in %.2f s: %.2f frames/s\n",
                               flags.clients, Grouped(figures.frames), figures.seconds,
                               figures.frames_per_s)
            << absl::StrFormat("latency ms  p50 %.1f  p90 %.1f  p99 %.1f  max %.1f\n",
                               figures.p50_ms, figures.p90_ms, figures.p99_ms, figures.max_ms)
            << "hit rate    " << Percent(figures.hit_rate) << "\n\n";
  Table table({{"seconds", Align::kRight}, {"frames", Align::kRight}, {"hit rate", Align::kRight}});
  for (const LoadBucket& bucket : figures.buckets) {
    if (bucket.frames == 0) continue;
    table.AddRow(
        {absl::StrFormat("%.2f", bucket.to_s), Grouped(bucket.frames), Percent(bucket.hit_rate)});
  }
  std::cout << table.ToString();
}

absl::StatusOr<int> Load(const LoadFlags& flags) {
  std::vector<std::string> files;
  for (const std::string& file : {flags.plot, flags.stats}) {
    if (!file.empty()) files.push_back(file);
  }
  if (absl::Status status = CheckFolders(files); !status.ok()) return status;
  const absl::StatusOr<std::vector<LoadSample>> samples = Measure(flags);
  if (!samples.ok()) return samples.status();
  const LoadFigures figures = SummarizeLoad(*samples);
  if (!flags.quiet) Print(flags, figures);
  if (!flags.stats.empty()) {
    nlohmann::json json = LoadJson(figures);
    json["clients"] = flags.clients;
    json["epsilon"] = flags.options.max_relative_error;
    if (absl::Status status = WriteJson(json, flags.stats); !status.ok()) return status;
  }
  if (!flags.plot.empty()) {
    const std::string title = absl::StrCat(flags.scene.scene, ", ", flags.clients, " clients");
    absl::Status status = WriteFileAtomically(flags.plot, SvgPlots(LoadPlots(figures, title)));
    if (!status.ok()) return status;
  }
  return kExitOk;
}

void AddFlags(CLI::App& app, LoadFlags& flags) {
  AddConnectionFlags(app, flags.connection);
  AddSceneFlags(app, flags.scene);
  app.add_option("--path", flags.path,
                 "Camera path that every client flies, each from another place")
      ->type_name("FILE")
      ->required()
      ->group("View");
  AddSizeFlags(app, flags.size);
  AddOptionsFlags(app, flags.options);
  AddSamplingFlags(app, flags.sampling);
  app.add_option("--clients", flags.clients, "Clients at the same time")
      ->type_name("N")
      ->check(CLI::Range(1, kMaxClients))
      ->capture_default_str()
      ->group("Load");
  app.add_option("--frames", flags.frames,
                 "Frames of each client; left out: once along the path, or until the time is up")
      ->type_name("M")
      ->check(CLI::PositiveNumber)
      ->group("Load");
  app.add_option("--duration", flags.duration_s, "Begin no frame later than this")
      ->type_name("SECONDS")
      ->check(CLI::PositiveNumber)
      ->group("Load");
  app.add_option("-o,--output", flags.plot, "Plot of hit rate and throughput over time, .svg")
      ->type_name("FILE")
      ->check(HasExtension({".svg"}))
      ->group("Output");
  AddStatsFlag(app, flags.stats);
  AddQuietFlag(app, flags.quiet);
}

}  // namespace

void AddLoad(CLI::App& parent, Commands& commands) {
  auto flags = std::make_shared<LoadFlags>();
  CLI::App* app = parent.add_subcommand("load", "Many clients that fly one path at the same time");
  AddFlags(*app, *flags);
  app->footer(
      "Examples:\n"
      "  linetree load --scene room --path scenes/paths/room_walk.textproto --clients 8\n"
      "  linetree load --local --scene scenes/face.textproto --path "
      "scenes/paths/face_walk.textproto --duration 20 --stats load.json -o load.svg");
  commands.push_back({app, [flags] { return Load(*flags); }});
}

}  // namespace linetree
