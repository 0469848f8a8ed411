// How a server is run: what the flags of linetreed say.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/render/options.h"
#include "server/limits.h"

namespace linetree {

struct SceneFile {
  std::string name;
  std::string path;
};

struct ServerOptions {
  std::vector<SceneFile> scenes;
  // host:port; port 0 takes a free one. Loopback unless told otherwise: there is no authentication.
  std::string listen = "127.0.0.1:50051";
  // Rendering threads; 0 takes the number of hardware threads.
  int threads = 0;
  // Frames and batches that are worked on at a time; they share the threads.
  int render_slots = 2;
  // For the caches of all scenes together.
  uint64_t memory_bytes = uint64_t{1} << 30;
  // What requests get that do not say otherwise.
  RenderOptions defaults;
  // Share of the answers from caches that are traced again, to count those that break their
  // promise.
  double audit_share = 0;
  // How long open calls may go on after the signal to stop.
  std::chrono::milliseconds drain_timeout_ms{10'000};
  ServerLimits limits;
};

// OK, or INVALID_ARGUMENT naming the flag and what was expected.
absl::Status ValidateServerOptions(const ServerOptions& options);

// "NAME=FILE", or INVALID_ARGUMENT.
absl::StatusOr<SceneFile> ParseSceneFlag(const std::string& flag);

// Whether only this machine can reach the address.
bool IsLoopback(const std::string& listen);

}  // namespace linetree
