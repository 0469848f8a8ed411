// How a server is run: what the flags of linetreed say.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/cache/cache_options.h"
#include "core/render/options.h"
#include "server/limits.h"
#include "server/tls.h"

namespace linetree {

struct SceneFile {
  std::string name;
  std::string path;
};

struct SceneWeight {
  std::string name;
  double weight = 1;
};

struct ServerOptions {
  std::vector<SceneFile> scenes;
  // Of some of them: weights for their parts of the memory, and camera paths along which frames are
  // rendered before the server calls itself ready.
  std::vector<SceneWeight> scene_weights;
  std::vector<SceneFile> warm_ups;
  // The folder that clients may load scenes from; empty: none.
  std::string scene_root;
  // host:port; port 0 takes a free one. What other machines can reach needs TLS and tokens, or
  // `insecure`.
  std::string listen = "127.0.0.1:50051";
  // host:port for /livez, /readyz and /metrics by HTTP, by HTTPS where there is a certificate;
  // empty: none. The same rule holds.
  std::string http;
  TlsFiles tls;            // cert empty: no TLS
  std::string token_file;  // see tokens.h; empty: everybody may do everything
  bool insecure = false;
  // Rendering threads; 0 takes the number of hardware threads.
  int threads = 0;
  // Frames and batches that are worked on at a time; they share the threads.
  int render_slots = 2;
  // For the caches of all scenes together.
  uint64_t memory_bytes = uint64_t{1} << 30;
  // By which caches evict, of AllPolicies (core/policy).
  std::string policy = kDefaultPolicy;
  // Where to write, at the end, what sessions have used; empty: nowhere.
  std::string record_trace;
  // Where cells are kept from one process to the next, and how large that file may become; empty:
  // they are not.
  std::string data_folder;
  uint64_t store_bytes = uint64_t{1} << 30;
  // Whether frames that flights are likely to ask for are rendered while nobody asks for anything.
  bool prefetch = true;
  // What requests get that do not say otherwise.
  RenderOptions defaults;
  // Share of the answers from caches that are traced again, to count those that break their
  // promise.
  double audit_share = 0;
  // How long a flight may last before it has to be resumed in a new stream; 0: for ever.
  std::chrono::seconds max_flight_s{0};
  // How long a client may take nothing of what it has asked for before its call is cancelled; 0:
  // for ever.
  std::chrono::seconds max_stall_s{60};
  // How long open calls may go on after the signal to stop.
  std::chrono::milliseconds drain_timeout_ms{10'000};
  ServerLimits limits;
};

// OK, or INVALID_ARGUMENT naming the flag and what was expected.
absl::Status ValidateServerOptions(const ServerOptions& options);

// "NAME=FILE", or INVALID_ARGUMENT. `flag` is the name of the flag, such as "--scene".
absl::StatusOr<SceneFile> ParseSceneFlag(const std::string& value,
                                         absl::string_view flag = "--scene");
// "NAME=WEIGHT" of --scene-weight, or INVALID_ARGUMENT.
absl::StatusOr<SceneWeight> ParseWeightFlag(const std::string& value);

struct HostPort {
  std::string host;
  int port = 0;
};
// "HOST:PORT" with a port in [0, 65535]; brackets around the host stay.
std::optional<HostPort> SplitHostPort(const std::string& address);

// Whether only this machine can reach the address: 127.x.y.z, localhost, [::1], or a socket file.
bool IsLoopback(const std::string& address);

}  // namespace linetree
