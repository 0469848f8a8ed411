#include "client/command/flags.h"

#include <algorithm>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/command/parse_values.h"
#include "client/command/table.h"
#include "core/io/wire.h"
#include "core/io/wire_frame.h"
#include "core/policy/policies.h"

namespace linetree {
namespace {

CLI::Option* AddVec3(CLI::App& app, const std::string& name, std::optional<Vec3d>& value,
                     const std::string& description) {
  return app
      .add_option_function<std::string>(
          name,
          [name, &value](const std::string& text) {
            const absl::StatusOr<Vec3d> parsed = ParseVec3(text);
            if (!parsed.ok())
              throw CLI::ValidationError(name, std::string(parsed.status().message()));
            value = *parsed;
          },
          description)
      ->type_name("X,Y,Z");
}

std::string CameraNames(const v1::SceneInfo& scene) {
  if (scene.cameras().empty()) return "it has none";
  return absl::StrCat("it has ",
                      absl::StrJoin(scene.cameras(), ", ", [](std::string* out, const auto& c) {
                        absl::StrAppend(out, "'", c.name(), "'");
                      }));
}

absl::StatusOr<Camera> FindCamera(const v1::SceneInfo& scene, const std::string& name) {
  for (const v1::Camera& camera : scene.cameras()) {
    if (name.empty() || camera.name() == name) return CameraFromWire(camera);
  }
  return absl::NotFoundError(
      absl::StrCat("no camera '", name, "' in scene '", scene.name(), "': ", CameraNames(scene)));
}

void AddTlsFlags(CLI::App& app, ConnectionFlags& flags, CLI::Option* local) {
  constexpr const char* kGroup = "Where";
  auto* ca = app.add_option("--tls-ca", flags.tls_ca,
                            "Connect by TLS; the server's certificate must lead to one of these")
                 ->type_name("FILE")
                 ->excludes(local)
                 ->group(kGroup);
  auto* cert = app.add_option("--tls-cert", flags.tls_cert,
                              "Certificate to show to a server that wants to see one")
                   ->type_name("FILE")
                   ->needs(ca)
                   ->group(kGroup);
  auto* key = app.add_option("--tls-key", flags.tls_key, "Its key")
                  ->type_name("FILE")
                  ->needs(cert)
                  ->group(kGroup);
  cert->needs(key);
  app.add_option("--token-file", flags.token_file,
                 "File that holds the token to show; without, LINETREE_TOKEN in the environment "
                 "may hold it")
      ->type_name("FILE")
      ->excludes(local)
      ->group(kGroup);
}

}  // namespace

CLI::Validator IsPolicy() {
  return CLI::Validator(
      [](std::string& name) {
        const auto made = MakePolicy(name, 0);
        return made.ok() ? std::string() : std::string(made.status().message());
      },
      "");
}

void AddConnectionFlags(CLI::App& app, ConnectionFlags& flags) {
  constexpr const char* kGroup = "Where";
  auto* server = app.add_option("--server", flags.server, "Address of a linetreed")
                     ->type_name("HOST:PORT")
                     ->capture_default_str()
                     ->group(kGroup);
  app.add_option("--connect-timeout", flags.connect_timeout_s, "Wait so long for the server")
      ->type_name("SECONDS")
      ->check(CLI::Range(0.0, 3600.0))
      ->capture_default_str()
      ->group(kGroup);
  auto* local = app.add_flag("--local", flags.local, "Render in this process, without a server")
                    ->excludes(server)
                    ->group(kGroup);
  AddTlsFlags(app, flags, local);
  app.add_option("--threads", flags.threads, "Threads that render; 0: as many as the machine has")
      ->type_name("N")
      ->check(CLI::Range(0, 1024))
      ->needs(local)
      ->group(kGroup);
  app.add_option("--memory", flags.memory_bytes, "Bytes that the cache may hold; 64m, 2g, … too")
      ->type_name("BYTES")
      ->transform(CLI::AsSizeValue(false))
      ->needs(local)
      ->group(kGroup);
  app.add_option("--policy", flags.policy, "What makes room in a full cache; see cache sim --help")
      ->type_name("NAME")
      ->check(IsPolicy())
      ->needs(local)
      ->group(kGroup);
}

void AddSceneFlags(CLI::App& app, SceneFlags& flags, bool required) {
  app.add_option("--scene", flags.scene,
                 "Scene file (.textproto or .nff), sent to the server under its name without "
                 "extension; or the name of a scene that the server has")
      ->type_name("FILE|NAME")
      ->required(required)
      ->group("Scene");
  app.add_flag("--replace", flags.replace, "Replace another scene that has the file's name")
      ->group("Scene");
}

void AddSizeFlags(CLI::App& app, SizeFlags& flags) {
  app.add_option("--width", flags.width, "Columns of the picture")
      ->type_name("PIXELS")
      ->check(CLI::PositiveNumber)
      ->capture_default_str()
      ->group("View");
  app.add_option("--height", flags.height, "Rows of the picture")
      ->type_name("PIXELS")
      ->check(CLI::PositiveNumber)
      ->capture_default_str()
      ->group("View");
}

void AddViewFlags(CLI::App& app, ViewFlags& flags) {
  app.add_option("--camera", flags.camera, "One of the scene's cameras; the first when left out")
      ->type_name("NAME")
      ->group("View");
  AddVec3(app, "--eye", flags.eye, "Replaces the camera's position")->group("View");
  AddVec3(app, "--look-at", flags.look_at, "Replaces the point in the picture's centre")
      ->group("View");
  AddVec3(app, "--up", flags.up, "Replaces the direction that is up in the picture")->group("View");
  app.add_option("--fov", flags.fov_deg, "Replaces the horizontal angle of view")
      ->type_name("DEGREES")
      ->group("View");
}

absl::StatusOr<Camera> ResolveCamera(const v1::SceneInfo& scene, const ViewFlags& flags) {
  Camera camera;
  if (!scene.cameras().empty() || !flags.camera.empty()) {
    const absl::StatusOr<Camera> found = FindCamera(scene, flags.camera);
    if (!found.ok()) return found.status();
    camera = *found;
  } else if (!flags.eye || !flags.look_at) {
    return absl::InvalidArgumentError(
        absl::StrCat("scene '", scene.name(), "' has no camera: give --eye and --look-at"));
  }
  if (flags.eye || flags.look_at || flags.up || flags.fov_deg) camera.name.clear();
  if (flags.eye) camera.eye = *flags.eye;
  if (flags.look_at) camera.look_at = *flags.look_at;
  if (flags.up) camera.up = *flags.up;
  if (flags.fov_deg) camera.fov_deg = *flags.fov_deg;
  if (absl::Status status = ValidateCamera(camera); !status.ok()) return status;
  return camera;
}

void AddJudgeFlag(CLI::App& app, JudgeKind& judge) {
  const std::map<std::string, JudgeKind> judges = {{"paper", JudgeKind::kPaper},
                                                   {"certified", JudgeKind::kCertified}};
  app.add_option("--judge", judge,
                 "certified: every answer is proved to be within epsilon, at 0 bit for bit;\n"
                 "paper: within epsilon as far as the paper's tests see")
      ->transform(CLI::CheckedTransformer(judges))
      ->type_name("JUDGE")
      ->default_str("certified")
      ->group("Rendering");
}

const std::map<std::string, Lanes>& LanesByName() {
  static const auto* const all =
      new std::map<std::string, Lanes>{{"simd", Lanes::kSimd}, {"scalar", Lanes::kScalar}};
  return *all;
}

std::string LanesName(Lanes lanes) {
  const auto& all = LanesByName();
  return std::find_if(all.begin(), all.end(),
                      [&](const auto& named) { return named.second == lanes; })
      ->first;
}

void AddLanesFlag(CLI::App& app, Lanes& lanes) {
  app.add_option("--lanes", lanes,
                 "How rays are traced. scalar: one by one, in double;\n"
                 "simd: sixteen rays at a time, radiance in float, many times as fast")
      ->transform(CLI::CheckedTransformer(LanesByName()))
      ->type_name("LANES")
      ->default_str("scalar")
      ->group("Rendering");
}

void AddLimitsFlags(CLI::App& app, PathLimits& limits) {
  app.add_option("--max-depth", limits.max_depth, "Rays on a path, the eye ray counted")
      ->type_name("N")
      ->check(CLI::Range(1, kMaxPathDepth))
      ->capture_default_str()
      ->group("Rendering");
  app.add_option("--min-weight", limits.min_weight,
                 "Branches that weigh less than this in the pixel are not followed")
      ->type_name("W")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str()
      ->group("Rendering");
}

void AddOptionsFlags(CLI::App& app, RenderOptions& options) {
  const std::map<std::string, Mode> modes = {{"cached", Mode::kCached},
                                             {"classical", Mode::kClassical}};
  app.add_option("--mode", options.mode, "cached, or classical: trace every ray")
      ->transform(CLI::CheckedTransformer(modes))
      ->type_name("MODE")
      ->default_str("cached")
      ->group("Rendering");
  AddJudgeFlag(app, options.judge);
  app.add_option("--epsilon", options.max_relative_error,
                 "Promised relative error against the classical tracer, per channel")
      ->type_name("E")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str()
      ->group("Rendering");
  AddLimitsFlags(app, options.limits);
  AddLanesFlag(app, options.lanes);
}

void AddSamplingFlags(CLI::App& app, Sampling& sampling) {
  const std::map<std::string, SamplePattern> patterns = {{"regular", SamplePattern::kRegular},
                                                         {"jittered", SamplePattern::kJittered}};
  app.add_option(
         "--samples", sampling.samples,
         "Eye rays of each pixel, which shows their mean; squares (4, 9, 16, …) are fastest")
      ->type_name("N")
      ->check(CLI::Range(1, kMaxPixelSamples))
      ->capture_default_str()
      ->group("Rendering");
  app.add_option("--sampling", sampling.pattern,
                 "regular: through the centres of equal squares, or on a lattice;\n"
                 "jittered: anywhere in each sample's part of the pixel")
      ->transform(CLI::CheckedTransformer(patterns))
      ->type_name("PATTERN")
      ->default_str("regular")
      ->group("Rendering");
  app.add_option("--sample-seed", sampling.seed, "Of jittered samples")
      ->type_name("SEED")
      ->capture_default_str()
      ->group("Rendering");
}

void AddPriorityFlag(CLI::App& app, ConnectionFlags& flags) {
  const std::map<std::string, v1::Priority> classes = {{"interactive", v1::PRIORITY_INTERACTIVE},
                                                       {"batch", v1::PRIORITY_BATCH},
                                                       {"background", v1::PRIORITY_BACKGROUND}};
  app.add_option(
         "--priority", flags.priority,
         "In which class the server queues the work: interactive, batch or background, which "
         "get\n64, 8 and 1 parts of what it does; left out: frames interactive, rays batch")
      ->transform(CLI::CheckedTransformer(classes))
      ->type_name("CLASS")
      ->excludes(app.get_option("--local"))
      ->group("Where");
}

void AddFormatFlags(CLI::App& app, FrameFormat& format) {
  const std::map<std::string, FrameCodec> codecs = {{"float", FrameCodec::kFloat},
                                                    {"half", FrameCodec::kHalf},
                                                    {"exr", FrameCodec::kExr},
                                                    {"png", FrameCodec::kPng},
                                                    {"jpeg", FrameCodec::kJpeg}};
  auto* codec =
      app.add_option("--codec", format.codec,
                     "How the server sends frames. float: as they are; exr: the same, packed;\n"
                     "half: rounded to 11 bits; png, jpeg: as pictures, for -o files that end so")
          ->transform(CLI::CheckedTransformer(codecs))
          ->type_name("CODEC")
          ->default_str("float")
          ->excludes(app.get_option("--local"))
          ->group("Output");
  app.add_option("--jpeg-quality", format.jpeg_quality, "Of --codec jpeg")
      ->type_name("PERCENT")
      ->check(CLI::Range(1, kMaxJpegQuality))
      ->capture_default_str()
      ->needs(codec)
      ->group("Output");
}

CLI::Option* AddNewestFlag(CLI::App& app, std::optional<double>& rate) {
  return app
      .add_option("--newest", rate,
                  "Send so many viewpoints a second, whether or not frames have come: the server\n"
                  "keeps the newest one only, and those that it overtakes get no frame")
      ->type_name("VIEWS_PER_S")
      ->check(CLI::Range(1e-3, 1e5))
      ->excludes(app.get_option("--local"))
      ->group("View");
}

void AddStatsFlag(CLI::App& app, std::string& stats) {
  app.add_option("--stats", stats, "Write the counters as JSON")
      ->type_name("FILE")
      ->group("Output");
}

void AddQuietFlag(CLI::App& app, bool& quiet) {
  app.add_flag("--quiet,-q", quiet, "No progress and no table")->group("Output");
}

void AddJsonFlag(CLI::App& app, std::string& file, const std::string& what) {
  app.add_option("--json", file, absl::StrCat("Also write ", what, " as JSON"))
      ->type_name("FILE")
      ->group("Output");
}

void AddThreadsFlag(CLI::App& app, int& threads) {
  app.add_option("--threads", threads, "0: all hardware threads")
      ->type_name("N")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
}

void AddOutputFlags(CLI::App& app, OutputFlags& flags) {
  std::map<std::string, Layer> layers;
  for (size_t i = 0; i < kLayerNames.size(); ++i) {
    layers[std::string(kLayerNames[i])] = static_cast<Layer>(i);
  }
  app.add_option("-o,--output", flags.pictures,
                 "Picture: .exr (float, all layers), .png or .jpg (8-bit sRGB); may be given again")
      ->type_name("FILE")
      ->allow_extra_args(false)
      ->check(HasExtension({".exr", ".png", ".jpg", ".jpeg"}))
      ->group("Output");
  app.add_option("--layer", flags.layer,
                 "What a .png or .jpg shows: beauty, verdict, source, object or depth")
      ->transform(CLI::CheckedTransformer(layers))
      ->type_name("LAYER")
      ->default_str("beauty")
      ->group("Output");
  AddStatsFlag(app, flags.stats);
  AddQuietFlag(app, flags.quiet);
}

std::string LegendText() {
  Table table({{"layer"}, {"meaning"}, {"colour"}, {"sRGB"}});
  const auto add = [&table](absl::string_view layer, const LegendEntry& entry) {
    table.AddRow({std::string(layer), std::string(entry.label), std::string(entry.color_name),
                  absl::StrJoin(entry.color, " ", [](std::string* out, uint8_t code) {
                    absl::StrAppend(out, static_cast<int>(code));
                  })});
  };
  for (const LegendEntry& entry : VerdictLegend()) add("verdict", entry);
  for (const LegendEntry& entry : SourceLegend()) add("source", entry);
  return absl::StrCat("Colours of --layer verdict (Color Plate 1 of the paper) and source:\n",
                      table.ToString());
}

CLI::Validator HasExtension(std::vector<std::string> extensions) {
  return CLI::Validator(
      [extensions](std::string& name) -> std::string {
        for (const std::string& extension : extensions) {
          if (absl::EndsWithIgnoreCase(name, extension)) return {};
        }
        return absl::StrCat("expected a name that ends with ", absl::StrJoin(extensions, " or "),
                            ", found '", name, "'");
      },
      "");
}

}  // namespace linetree
