// linetree scene check|convert|edit: scene files.
#include <iostream>
#include <map>
#include <memory>
#include <optional>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "client/command/command.h"
#include "client/command/flags.h"
#include "client/command/output.h"
#include "client/command/session.h"
#include "core/io/atomic_file.h"
#include "core/io/load_scene.h"
#include "core/io/pov.h"
#include "core/io/wire.h"

namespace linetree {
namespace {

std::string Point(const Vec3d& p) { return absl::StrFormat("(%.6g, %.6g, %.6g)", p.x, p.y, p.z); }

std::string Summary(const std::string& file, const Scene& scene) {
  const Box3 bounds = scene.WorldBounds();
  const std::string cameras = absl::StrJoin(
      scene.cameras, ", ",
      [](std::string* out, const Camera& c) { absl::StrAppend(out, "'", c.name, "'"); });
  return absl::StrCat(
      file, ": OK\n  objects    ", scene.objects.size(), "\n  materials  ", scene.materials.size(),
      "\n  lights     ", scene.lights.size(), "\n  cameras    ", scene.cameras.size(),
      cameras.empty() ? "" : ": ", cameras, "\n  bounds     ",
      bounds.IsEmpty() ? "none" : absl::StrCat(Point(bounds.min), " to ", Point(bounds.max)),
      "\n  version    ", scene.version, "\n");
}

int CheckScenes(const std::vector<std::string>& files) {
  int exit_status = kExitOk;
  for (const std::string& file : files) {
    const absl::StatusOr<std::shared_ptr<const Scene>> scene = LoadSceneFile(file);
    if (scene.ok()) {
      std::cout << Summary(file, **scene);
    } else {
      exit_status = Report(scene.status());
    }
  }
  return exit_status;
}

void AddCheck(CLI::App& scene, Commands& commands) {
  auto files = std::make_shared<std::vector<std::string>>();
  CLI::App* app = scene.add_subcommand("check", "Read scene files and say whether they are good");
  app->add_option("FILE", *files, "Scene files, .textproto or .nff")->required();
  app->footer(
      "An error says file:line:column, the field and what was expected.\n\n"
      "Example:\n"
      "  linetree scene check scenes/*.textproto scenes/spd/balls_3.nff");
  commands.push_back({app, [files] { return CheckScenes(*files); }});
}

enum class Format { kTextproto, kPov };

struct ConvertFlags {
  std::string input;
  std::string output;
  std::optional<Format> to;
  ViewFlags view;
  SizeFlags size;
  PathLimits limits;
};

absl::StatusOr<Format> OutputFormat(const ConvertFlags& flags) {
  if (flags.to) return *flags.to;
  if (absl::EndsWithIgnoreCase(flags.output, ".textproto")) return Format::kTextproto;
  if (absl::EndsWithIgnoreCase(flags.output, ".pov")) return Format::kPov;
  return absl::InvalidArgumentError(absl::StrCat(
      "expected an output that ends with .textproto or .pov, or --to, found '", flags.output, "'"));
}

absl::StatusOr<std::string> Converted(const ConvertFlags& flags, Format format) {
  const absl::StatusOr<SceneFile> file = ReadSceneFileChecked(flags.input);
  if (!file.ok()) return file.status();
  if (format == Format::kTextproto) return WriteSceneText(file->source->message());
  const absl::StatusOr<Camera> camera =
      ResolveCamera(SceneInfoToWire(file->name, *file->scene, 0), flags.view);
  if (!camera.ok()) return camera.status();
  return WritePov(*file->scene, *camera, flags.size.width, flags.size.height, flags.limits);
}

absl::StatusOr<int> ConvertScene(const ConvertFlags& flags) {
  const absl::StatusOr<Format> format = OutputFormat(flags);
  if (!format.ok()) return Report(format.status(), kExitUsage);
  if (absl::Status s = CheckFolders({flags.output}); !s.ok()) return s;
  const absl::StatusOr<std::string> text = Converted(flags, *format);
  if (!text.ok()) return text.status();
  if (flags.output == "-") {
    std::cout << *text;
    return kExitOk;
  }
  if (absl::Status s = WriteFileAtomically(flags.output, *text); !s.ok()) return s;
  return kExitOk;
}

void AddConvert(CLI::App& scene, Commands& commands) {
  auto flags = std::make_shared<ConvertFlags>();
  CLI::App* app = scene.add_subcommand("convert", "Write a scene in another format");
  app->add_option("IN", flags->input, "Scene file, .textproto or .nff")->required();
  app->add_option("-o,--output", flags->output, "File to write; - is standard output")
      ->type_name("OUT")
      ->required();
  const std::map<std::string, Format> formats = {{"textproto", Format::kTextproto},
                                                 {"pov", Format::kPov}};
  app->add_option_function<Format>(
         "--to", [flags](const Format& format) { flags->to = format; },
         "textproto or pov; left out: by OUT's extension")
      ->transform(CLI::CheckedTransformer(formats))
      ->type_name("FORMAT");
  AddViewFlags(*app, flags->view);
  AddSizeFlags(*app, flags->size);
  AddLimitsFlags(*app, flags->limits);
  app->footer(
      "View, size and limits go into POV-Ray's file only; it names the command that renders it.\n\n"
      "Examples:\n"
      "  linetree scene convert scenes/spd/balls_3.nff -o balls_3.textproto\n"
      "  linetree scene convert scenes/room.textproto -o room.pov --width 320 --height 240");
  commands.push_back({app, [flags] { return ConvertScene(*flags); }});
}

}  // namespace

void AddScene(CLI::App& parent, Commands& commands) {
  CLI::App* app =
      parent.add_subcommand("scene", "Check and convert scene files, edit a server's scenes");
  app->require_subcommand(1);
  AddCheck(*app, commands);
  AddConvert(*app, commands);
  AddSceneEdit(*app, commands);
}

}  // namespace linetree
