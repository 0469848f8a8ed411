// The flags that sub-commands share, one group each; the same everywhere.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/io/frame_codec.h"
#include "core/io/layer_colors.h"
#include "core/render/scene_host.h"
#include "linetree/v1/service.pb.h"

namespace linetree {

// Where answers come from: a server, or a cache in this process.
struct ConnectionFlags {
  std::string server = "127.0.0.1:50051";
  double connect_timeout_s = 5;
  // Files in PEM; tls_ca is what makes it TLS.
  std::string tls_ca{};
  std::string tls_cert{};
  std::string tls_key{};
  std::string token_file{};  // empty: what LINETREE_TOKEN holds, if anything
  bool local = false;
  int threads = 0;                                      // --local only; 0: all hardware threads
  uint64_t memory_bytes = CacheOptions{}.memory_bytes;  // --local only
  std::string policy = kDefaultPolicy;                  // --local only
  v1::Priority priority = v1::PRIORITY_UNSPECIFIED;     // of a server's work
};
void AddConnectionFlags(CLI::App& app, ConnectionFlags& flags);
// --priority. After AddConnectionFlags.
void AddPriorityFlag(CLI::App& app, ConnectionFlags& flags);

struct SceneFlags {
  std::string scene;  // FILE or NAME
  bool replace = false;
};
void AddSceneFlags(CLI::App& app, SceneFlags& flags, bool required = true);

struct SizeFlags {
  int width = 512;
  int height = 512;
};
void AddSizeFlags(CLI::App& app, SizeFlags& flags);

struct ViewFlags {
  std::string camera;
  std::optional<Vec3d> eye, look_at, up;
  std::optional<double> fov_deg;
};
void AddViewFlags(CLI::App& app, ViewFlags& flags);

// The named camera (the first one without a name) with the given parts replaced. A scene without
// cameras needs --eye and --look-at.
absl::StatusOr<Camera> ResolveCamera(const v1::SceneInfo& scene, const ViewFlags& flags);

// --mode, --judge, --epsilon, --lanes and the path's limits, straight into the options.
void AddOptionsFlags(CLI::App& app, RenderOptions& options);
void AddJudgeFlag(CLI::App& app, JudgeKind& judge);
void AddLanesFlag(CLI::App& app, Lanes& lanes);
// What --lanes calls them.
const std::map<std::string, Lanes>& LanesByName();
std::string LanesName(Lanes lanes);
void AddLimitsFlags(CLI::App& app, PathLimits& limits);

// --samples, --sampling and --sample-seed.
void AddSamplingFlags(CLI::App& app, Sampling& sampling);

// --codec and --jpeg-quality: how a server sends frames. After AddConnectionFlags.
void AddFormatFlags(CLI::App& app, FrameFormat& format);

// --newest: viewpoints a second. After AddConnectionFlags.
CLI::Option* AddNewestFlag(CLI::App& app, std::optional<double>& rate);

// -o, --layer and --stats.
struct OutputFlags {
  std::vector<std::string> pictures;  // .exr, .png or .jpg
  Layer layer = Layer::kBeauty;       // of .png and .jpg
  std::string stats{};                // JSON
  bool quiet = false;
};
void AddOutputFlags(CLI::App& app, OutputFlags& flags);
void AddStatsFlag(CLI::App& app, std::string& stats);
void AddQuietFlag(CLI::App& app, bool& quiet);
// --json FILE: "Also write WHAT as JSON".
void AddJsonFlag(CLI::App& app, std::string& file, const std::string& what);
// --threads of a command that works in this process.
void AddThreadsFlag(CLI::App& app, int& threads);

// The meaning of the colours of --layer verdict and --layer source, for --help.
std::string LegendText();

// Accepts names of policies.
CLI::Validator IsPolicy();

// Accepts names that end with one of the extensions, each written like ".png".
CLI::Validator HasExtension(std::vector<std::string> extensions);

}  // namespace linetree
