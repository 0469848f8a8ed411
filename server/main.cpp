// linetreed: flags in, a server until SIGTERM or SIGINT. SIGHUP: reads certificates and tokens
// anew.
#include <signal.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <thread>

#include "core/policy/policies.h"
#include "core/store/data_folder.h"
#include "server/log_capture.h"
#include "server/log_format.h"
#include "server/log_sink.h"
#include "server/server.h"
#include "server/service_manager.h"

namespace linetree {
namespace {

struct Flags {
  std::vector<std::string> scenes;
  std::vector<std::string> scene_weights;
  std::vector<std::string> warm_ups;
  std::string log_level = "info";
  std::string log_format = "text";
  std::string judge = "certified";
  std::string lanes = "scalar";
  bool no_store = false;
  int64_t drain_timeout_ms = 0;
  int64_t max_flight_s = 0;
  int64_t max_stall_s = 0;
};

void AddSceneFlags(CLI::App& app, ServerOptions& options, Flags& flags) {
  app.add_option("--scene", flags.scenes, "NAME=FILE: a scene to load; may be repeated");
  app.add_option("--scene-weight", flags.scene_weights,
                 "NAME=WEIGHT: the scene's part of --memory is its weight by the sum of all; "
                 "without, 1");
  app.add_option(
      "--warm-up", flags.warm_ups,
      "NAME=FILE: a camera path whose frames are rendered in the scene before the server "
      "calls itself ready");
  app.add_option("--scene-root", options.scene_root,
                 "folder from which clients may load scenes; without, they send them")
      ->type_name("FOLDER");
}

void AddServingFlags(CLI::App& app, ServerOptions& options, Flags& flags) {
  AddSceneFlags(app, options, flags);
  app.add_option("--listen", options.listen,
                 "HOST:PORT; port 0 takes a free one. What other machines can reach needs "
                 "--tls-cert, --tls-key and --token-file, or --insecure")
      ->capture_default_str();
  app.add_option("--http", options.http,
                 "HOST:PORT for /livez, /readyz and /metrics; none when left out. The same rule "
                 "holds: with --tls-cert it is HTTPS, with --token-file /metrics asks for a token")
      ->type_name("HOST:PORT");
  app.add_option("--threads", options.threads, "rendering threads; 0: one per hardware thread")
      ->capture_default_str();
  app.add_option("--render-slots", options.render_slots, "frames worked on at a time")
      ->capture_default_str();
  app.add_option("--memory", options.memory_bytes,
                 "bytes for the caches of all scenes; KiB, MiB, GiB are understood")
      ->transform(CLI::AsSizeValue(/*kb_is_1000=*/true))
      ->default_str("1GiB");
  app.add_option("--policy", options.policy,
                 "what makes room in a full cache is picked by one of " + PolicyNames())
      ->type_name("NAME")
      ->capture_default_str();
  app.add_option("--record-trace", options.record_trace,
                 "at the end, write what sessions have used to this file, and its costs beside it; "
                 "see linetree cache sim")
      ->type_name("FILE");
  app.add_flag("!--no-prefetch", options.prefetch,
               "do not render ahead along flights while nothing else is to be done");
  app.add_option("--data-dir", options.data_folder,
                 "folder where the caches' cells are kept, so that the next server starts warm")
      ->type_name("FOLDER")
      ->capture_default_str();
  app.add_flag("--no-store", flags.no_store, "keep nothing on the disk");
  app.add_option("--store-bytes", options.store_bytes,
                 "size that the file of cells may have; KiB, MiB, GiB are understood")
      ->transform(CLI::AsSizeValue(/*kb_is_1000=*/true))
      ->default_str("1GiB");
  app.add_option(
         "--audit", options.audit_share,
         "share of the answers from caches, in [0, 1], that is traced again in the background "
         "and compared; see linetree stats")
      ->type_name("SHARE")
      ->capture_default_str();
  flags.drain_timeout_ms = options.drain_timeout_ms.count();
  app.add_option("--drain-timeout-ms", flags.drain_timeout_ms,
                 "how long open calls may go on after the signal to stop")
      ->capture_default_str();
  app.add_option("--max-flight-s", flags.max_flight_s,
                 "how long a flight may last before the client has to go on in a new stream, with "
                 "the token that the last reply brings; 0: for ever")
      ->capture_default_str();
  flags.max_stall_s = options.max_stall_s.count();
  app.add_option("--max-stall-s", flags.max_stall_s,
                 "how long a client may take nothing of a frame that is sent to it before the call "
                 "is cancelled; 0: for ever")
      ->capture_default_str();
}

void AddDefaultsFlags(CLI::App& app, RenderOptions& defaults, Flags& flags) {
  app.add_option("--epsilon", defaults.max_relative_error,
                 "relative error that requests get which name none")
      ->capture_default_str();
  app.add_option("--judge", flags.judge, "judge of requests that name none")
      ->check(CLI::IsMember({"paper", "certified"}))
      ->capture_default_str();
  app.add_option("--lanes", flags.lanes,
                 "how rays are traced for requests that do not say: scalar, or simd")
      ->check(CLI::IsMember({"scalar", "simd"}))
      ->capture_default_str();
  app.add_option("--max-depth", defaults.limits.max_depth, "rays on a path, the eye ray counted")
      ->capture_default_str();
  app.add_option("--min-weight", defaults.limits.min_weight,
                 "a path ends when its weight falls below this")
      ->capture_default_str();
}

void AddSecurityFlags(CLI::App& app, ServerOptions& options) {
  app.add_option("--tls-cert", options.tls.cert,
                 "certificate of this server in PEM, and those that lead to its root")
      ->type_name("FILE");
  app.add_option("--tls-key", options.tls.key, "its key in PEM, without a password")
      ->type_name("FILE");
  app.add_option("--tls-client-ca", options.tls.client_ca,
                 "gRPC clients must show a certificate that leads to one of these")
      ->type_name("FILE");
  app.add_option("--token-file", options.token_file,
                 "lines 'viewer TOKEN' and 'admin TOKEN': callers must show one of them; viewers "
                 "may not load, change or unload scenes. Health and reflection answer anybody. "
                 "SIGHUP reads this file and those of TLS anew")
      ->type_name("FILE");
  app.add_flag("--insecure", options.insecure, "let other machines in without TLS or token");
}

void AddLogFlags(CLI::App& app, Flags& flags) {
  app.add_option("--log-level", flags.log_level,
                 "what is logged to standard error; debug has a line for every call")
      ->check(CLI::IsMember({"debug", "info", "warning", "error", "off"}))
      ->capture_default_str();
  app.add_option("--log-format", flags.log_format, "text, or json: one object a line")
      ->check(CLI::IsMember({"text", "json"}))
      ->capture_default_str();
}

void AddFlags(CLI::App& app, ServerOptions& options, Flags& flags) {
  AddServingFlags(app, options, flags);
  AddDefaultsFlags(app, options.defaults, flags);
  AddSecurityFlags(app, options);
  AddLogFlags(app, flags);
  app.set_version_flag("--version", "linetreed " LINETREE_VERSION);
  app.set_config("--config", "",
                 "file of lines 'flag = value' (TOML), for every flag by its name without the "
                 "dashes; flags of the command line win");
  app.allow_config_extras(CLI::config_extras_mode::error);
}

absl::Status Finish(const Flags& flags, ServerOptions& options) {
  for (const std::string& flag : flags.scenes) {
    auto scene = ParseSceneFlag(flag);
    if (!scene.ok()) return scene.status();
    options.scenes.push_back(*std::move(scene));
  }
  for (const std::string& flag : flags.scene_weights) {
    auto weight = ParseWeightFlag(flag);
    if (!weight.ok()) return weight.status();
    options.scene_weights.push_back(*std::move(weight));
  }
  for (const std::string& flag : flags.warm_ups) {
    auto warm_up = ParseSceneFlag(flag, "--warm-up");
    if (!warm_up.ok()) return warm_up.status();
    options.warm_ups.push_back(*std::move(warm_up));
  }
  options.defaults.judge = flags.judge == "certified" ? JudgeKind::kCertified : JudgeKind::kPaper;
  options.defaults.lanes = flags.lanes == "simd" ? Lanes::kSimd : Lanes::kScalar;
  if (flags.no_store) options.data_folder.clear();
  options.max_flight_s = std::chrono::seconds(flags.max_flight_s);
  options.max_stall_s = std::chrono::seconds(flags.max_stall_s);
  options.drain_timeout_ms = std::chrono::milliseconds(flags.drain_timeout_ms);
  return ValidateServerOptions(options);
}

// Blocks the signals that end the server in this thread and all that it starts, so that one thread
// may wait for them; and the one that asks for files to be read anew.
sigset_t BlockEndSignals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  sigset_t reload;
  sigemptyset(&reload);
  sigaddset(&reload, SIGHUP);
  pthread_sigmask(SIG_BLOCK, &reload, nullptr);
  // Whoever read our standard output may go away.
  signal(SIGPIPE, SIG_IGN);
  // A file that may not grow any more is an error of whoever writes it.
  signal(SIGXFSZ, SIG_IGN);
  return signals;
}

// Whoever asks twice means at once.
void ExitAtTheNext(const sigset_t& signals) {
  std::thread([signals] {
    int signal = 0;
    sigwait(&signals, &signal);
    std::_Exit(128 + signal);
  }).detach();
}

// The signal that ends the server. Until then SIGHUP reads its secrets anew.
int WaitForTheEnd(sigset_t signals, Server& server) {
  sigaddset(&signals, SIGHUP);
  for (;;) {
    int signal = 0;
    sigwait(&signals, &signal);
    if (signal != SIGHUP) return signal;
    server.ReloadSecrets();
  }
}

int Serve(const ServerOptions& options, const std::shared_ptr<spdlog::logger>& log) {
  const sigset_t signals = BlockEndSignals();
  auto server = Server::Start(options, log);
  if (!server.ok()) {
    log->error("{}", std::string(server.status().message()));
    return 1;
  }
  std::printf("listening on %s\n", (*server)->address().c_str());
  if (!options.http.empty()) std::printf("http on %s\n", (*server)->http_address().c_str());
  std::fflush(stdout);
  NotifyServiceManager("READY=1");
  const int signal = WaitForTheEnd(signals, **server);
  NotifyServiceManager("STOPPING=1");
  log->info("signal {}: draining for at most {} ms", signal, options.drain_timeout_ms.count());
  ExitAtTheNext(signals);
  (*server)->Drain(options.drain_timeout_ms);
  log->info("stopped");
  return 0;
}

}  // namespace
}  // namespace linetree

int main(int argc, char** argv) {
  CLI::App app{"Serves radiance from shared caches of scenes."};
  linetree::ServerOptions options;
  options.data_folder = linetree::DefaultDataFolder();
  linetree::Flags flags;
  linetree::AddFlags(app, options, flags);
  CLI11_PARSE(app, argc, argv);

  const auto log = std::make_shared<spdlog::logger>(
      "linetreed", std::make_shared<linetree::LogSink>(STDERR_FILENO));
  log->set_formatter(linetree::MakeLogFormatter(
      flags.log_format == "json" ? linetree::LogFormat::kJson : linetree::LogFormat::kText));
  log->set_level(spdlog::level::from_str(flags.log_level));
  linetree::CaptureLibraryLogs(log);
  if (auto status = linetree::Finish(flags, options); !status.ok()) {
    log->error("{}", std::string(status.message()));
    return 2;
  }
  return linetree::Serve(options, log);
}
