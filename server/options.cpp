#include "server/options.h"

#include <arpa/inet.h>

#include <filesystem>
#include <set>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "core/io/wire.h"
#include "core/policy/policies.h"
#include "server/scene_store.h"

namespace linetree {
namespace {

constexpr int kMaxThreads = 1024;
constexpr int kMaxRenderSlots = 64;
// Less than this cannot hold the cells of a single view.
// What an empty database takes, and some pages.
constexpr uint64_t kMinStoreBytes = 1 << 20;
constexpr uint64_t kMinMemoryBytes = uint64_t{1} << 20;
constexpr std::chrono::hours kMaxDrain{1};
constexpr std::chrono::hours kMaxFlight{24 * 365};

absl::Status Expected(absl::string_view flag, absl::string_view expected, absl::string_view got) {
  return absl::InvalidArgumentError(absl::StrCat(flag, ": expected ", expected, ", got ", got));
}

absl::Status CheckRange(absl::string_view flag, int64_t value, int64_t lowest, int64_t highest) {
  if (value >= lowest && value <= highest) return absl::OkStatus();
  return Expected(flag, absl::StrCat("a number in [", lowest, ", ", highest, "]"),
                  absl::StrCat(value));
}

absl::Status CheckScenes(const ServerOptions& options) {
  std::set<std::string> names;
  for (const SceneFile& scene : options.scenes) {
    if (auto status = ValidateSceneName(scene.name, "--scene"); !status.ok()) return status;
    if (scene.path.empty()) return Expected("--scene", "NAME=FILE", scene.name + "=");
    if (!names.insert(scene.name).second) {
      return Expected("--scene", "different names", Quoted(scene.name) + " twice");
    }
  }
  const auto check_name = [&](absl::string_view flag, const std::string& name) {
    if (names.count(name) > 0) return absl::OkStatus();
    return Expected(flag, "the name of one of --scene", Quoted(name));
  };
  for (const auto& [name, weight] : options.scene_weights) {
    if (auto status = check_name("--scene-weight", name); !status.ok()) return status;
    if (!(weight >= kMinSceneWeight && weight <= kMaxSceneWeight)) {
      return Expected("--scene-weight",
                      absl::StrCat("a number in [", kMinSceneWeight, ", ", kMaxSceneWeight, "]"),
                      absl::StrCat(weight));
    }
  }
  for (const SceneFile& warm_up : options.warm_ups) {
    if (auto status = check_name("--warm-up", warm_up.name); !status.ok()) return status;
  }
  std::error_code error;
  if (!options.scene_root.empty() && !std::filesystem::is_directory(options.scene_root, error)) {
    return Expected("--scene-root", "a folder", Quoted(options.scene_root));
  }
  return absl::OkStatus();
}

// Core names the fields of a request; here they are flags.
absl::Status CheckDefaults(const RenderOptions& defaults) {
  const auto status = ValidateOptions(defaults);
  return {status.code(),
          absl::StrReplaceAll(status.message(), {{"options.max_relative_error", "--epsilon"},
                                                 {"options.max_depth", "--max-depth"},
                                                 {"options.min_weight", "--min-weight"}})};
}

absl::Status CheckTlsFiles(const TlsFiles& tls) {
  if (tls.cert.empty() != tls.key.empty()) {
    return Expected("--tls-cert", "--tls-key with it, or neither", "one of the two");
  }
  if (!tls.client_ca.empty() && tls.cert.empty()) {
    return Expected("--tls-client-ca", "--tls-cert and --tls-key with it", "neither");
  }
  return absl::OkStatus();
}

// What other machines can reach is asked for who calls, unless the user wants it otherwise.
absl::Status CheckReach(absl::string_view flag, const std::string& address,
                        const ServerOptions& options) {
  if (options.insecure || IsLoopback(address)) return absl::OkStatus();
  if (!options.tls.cert.empty() && !options.token_file.empty()) return absl::OkStatus();
  return Expected(flag,
                  "a loopback address, or --tls-cert, --tls-key and --token-file with it, or "
                  "--insecure",
                  absl::StrCat(address, ", which other machines can reach"));
}

absl::Status CheckSecurity(const ServerOptions& options) {
  if (options.listen.empty()) return Expected("--listen", "HOST:PORT", "nothing");
  if (auto status = CheckTlsFiles(options.tls); !status.ok()) return status;
  if (auto status = CheckReach("--listen", options.listen, options); !status.ok()) return status;
  if (options.http.empty()) return absl::OkStatus();
  if (auto port = SplitHostPort(options.http); !port) {
    return Expected("--http", "HOST:PORT", options.http);
  }
  return CheckReach("--http", options.http, options);
}

absl::Status CheckCache(const ServerOptions& options) {
  if (auto made = MakePolicy(options.policy, 0); !made.ok()) {
    return absl::InvalidArgumentError(absl::StrCat("--policy: ", made.status().message()));
  }
  const auto trace_folder = std::filesystem::path(options.record_trace).parent_path();
  std::error_code error;
  if (!trace_folder.empty() && !std::filesystem::is_directory(trace_folder, error)) {
    return Expected("--record-trace", "a file in a folder that exists", options.record_trace);
  }
  if (options.memory_bytes < kMinMemoryBytes) {
    return Expected("--memory", absl::StrCat("at least ", kMinMemoryBytes, " bytes"),
                    absl::StrCat(options.memory_bytes));
  }
  if (options.store_bytes < kMinStoreBytes) {
    return Expected("--store-bytes", absl::StrCat("at least ", kMinStoreBytes, " bytes"),
                    absl::StrCat(options.store_bytes));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<SceneFile> ParseSceneFlag(const std::string& value, absl::string_view flag) {
  const size_t equals = value.find('=');
  if (equals == std::string::npos) return Expected(flag, "NAME=FILE", Quoted(value));
  return SceneFile{value.substr(0, equals), value.substr(equals + 1)};
}

absl::StatusOr<SceneWeight> ParseWeightFlag(const std::string& value) {
  const size_t equals = value.find('=');
  SceneWeight weight{value.substr(0, equals)};
  if (equals == std::string::npos || !absl::SimpleAtod(value.substr(equals + 1), &weight.weight)) {
    return Expected("--scene-weight", "NAME=WEIGHT", Quoted(value));
  }
  return weight;
}

absl::Status ValidateServerOptions(const ServerOptions& options) {
  if (auto status = CheckScenes(options); !status.ok()) return status;
  auto status = CheckSecurity(options);
  if (!status.ok()) return status;
  status = CheckRange("--threads", options.threads, 0, kMaxThreads);
  if (!status.ok()) return status;
  status = CheckRange("--render-slots", options.render_slots, 1, kMaxRenderSlots);
  if (!status.ok()) return status;
  status = CheckRange("--drain-timeout-ms", options.drain_timeout_ms.count(), 0,
                      std::chrono::milliseconds(kMaxDrain).count());
  if (!status.ok()) return status;
  status = CheckRange("--max-flight-s", options.max_flight_s.count(), 0,
                      std::chrono::seconds(kMaxFlight).count());
  if (!status.ok()) return status;
  status = CheckRange("--max-stall-s", options.max_stall_s.count(), 0,
                      std::chrono::seconds(kMaxFlight).count());
  if (!status.ok()) return status;
  if (auto checked = CheckCache(options); !checked.ok()) return checked;
  if (!(options.audit_share >= 0 && options.audit_share <= 1)) {
    return Expected("--audit", "a number in [0, 1]", absl::StrCat(options.audit_share));
  }
  return CheckDefaults(options.defaults);
}

std::optional<HostPort> SplitHostPort(const std::string& address) {
  const size_t colon = address.rfind(':');
  HostPort parts;
  if (colon == std::string::npos || colon == 0) return std::nullopt;
  if (!absl::SimpleAtoi(address.substr(colon + 1), &parts.port)) return std::nullopt;
  if (parts.port < 0 || parts.port > 65535) return std::nullopt;
  parts.host = address.substr(0, colon);
  return parts;
}

bool IsLoopback(const std::string& address) {
  if (absl::StartsWith(address, "unix:")) return true;
  const auto parts = SplitHostPort(address);
  if (!parts) return false;
  if (parts->host == "localhost" || parts->host == "[::1]") return true;
  // 127.a.example is a name that may stand for any machine.
  in_addr number{};
  return absl::StartsWith(parts->host, "127.") &&
         inet_pton(AF_INET, parts->host.c_str(), &number) == 1;
}

}  // namespace linetree
