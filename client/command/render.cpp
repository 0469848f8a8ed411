// linetree render: one view, once or several times over.
#include <iostream>
#include <memory>

#include "absl/strings/str_cat.h"
#include "client/command/command.h"
#include "client/command/explain_report.h"
#include "client/command/flags.h"
#include "client/command/frame_report.h"
#include "client/command/output.h"
#include "client/command/progress_bar.h"
#include "client/command/session.h"

namespace linetree {
namespace {

struct RenderFlags {
  ConnectionFlags connection;
  SceneFlags scene;
  ViewFlags view;
  SizeFlags size;
  RenderOptions options;
  Sampling sampling;
  OutputFlags output;
  FrameFormat format;
  bool explain = false;
  int frames = 1;
};

absl::StatusOr<Frame> RenderOnce(Client& client, const std::string& scene,
                                 const FrameRequest& request, const RenderFlags& flags,
                                 const std::string& label) {
  ProgressBar bar(!flags.output.quiet && IsTerminal(), label);
  FrameFormat format = flags.format;
  format.all_layers = NeedsLayers(flags.output);
  return client.RenderFrame(scene, request, "", format, [&bar](double share) { bar.Show(share); });
}

absl::StatusOr<int> Render(const RenderFlags& flags) {
  if (auto s = ValidateExplain(flags.explain, flags.options); !s.ok()) return s;
  std::vector<std::string> files = flags.output.pictures;
  if (!flags.output.stats.empty()) files.push_back(flags.output.stats);
  if (absl::Status status = CheckFolders(files); !status.ok()) return status;
  if (auto status = CheckFormat(flags.output, flags.format); !status.ok()) return status;

  absl::StatusOr<Session> session = OpenSession(flags.connection, flags.scene);
  if (!session.ok()) return session.status();
  const absl::StatusOr<Camera> camera = ResolveCamera(session->scene, flags.view);
  if (!camera.ok()) return camera.status();
  const FrameRequest request{*camera, flags.size.width, flags.size.height, flags.options,
                             flags.sampling};

  FrameReport report(session->scene.name(), flags.options,
                     flags.output.quiet ? nullptr : &std::cout);
  Frame last;
  for (int i = 1; i <= flags.frames; ++i) {
    absl::StatusOr<Frame> frame = RenderOnce(*session->client, session->scene.name(), request,
                                             flags, absl::StrCat("frame ", i, "/", flags.frames));
    if (!frame.ok()) return frame.status();
    report.Add(*frame);
    last = *std::move(frame);
  }
  for (const std::string& picture : flags.output.pictures) {
    absl::Status status = WritePicture(last, flags.output.layer, picture);
    if (!status.ok()) return status;
  }
  if (!flags.output.stats.empty()) {
    absl::Status status = WriteJson(report.ToJson(), flags.output.stats);
    if (!status.ok()) return status;
  }
  if (flags.explain) {
    auto status = PrintExplanation(*session->client, session->scene.name(), flags.options);
    if (!status.ok()) return status;
  }
  return kExitOk;
}

}  // namespace

void AddRender(CLI::App& parent, Commands& commands) {
  auto flags = std::make_shared<RenderFlags>();
  CLI::App* app = parent.add_subcommand("render", "Render a view of a scene");
  AddConnectionFlags(*app, flags->connection);
  AddPriorityFlag(*app, flags->connection);
  AddSceneFlags(*app, flags->scene);
  AddViewFlags(*app, flags->view);
  AddSizeFlags(*app, flags->size);
  AddOptionsFlags(*app, flags->options);
  AddSamplingFlags(*app, flags->sampling);
  app->add_option("--frames", flags->frames,
                  "Render the view so many times; the last frame is written, all are counted")
      ->type_name("N")
      ->check(CLI::PositiveNumber)
      ->capture_default_str()
      ->group("Rendering");
  AddOutputFlags(*app, flags->output);
  AddFormatFlags(*app, flags->format);
  AddExplainFlag(*app, flags->explain);
  app->footer(absl::StrCat(
      "Examples:\n"
      "  linetree render --local --scene scenes/room.textproto -o room.exr -o room.png\n"
      "  linetree render --scene room --epsilon 0.05 --frames 2 --stats room.json\n"
      "  linetree render --scene room --layer verdict -o why.png\n"
      "  linetree render --local --scene scenes/room.textproto --lanes simd --frames 3 --explain\n"
      "  linetree render --scene room --lanes simd --explain\n"
      "  linetree render --local --scene scenes/room.textproto --lanes simd --samples 16 -o "
      "fine.png\n"
      "  linetree render --scene room --eye 0,1,6 --look-at 0,1,0 --fov 60 -o view.png\n\n",
      LegendText()));
  commands.push_back({app, [flags] { return Render(*flags); }});
}

}  // namespace linetree
