// linetree fly: the frames of a camera path, over one stream.
#include <iostream>
#include <memory>

#include "absl/strings/str_cat.h"
#include "client/command/command.h"
#include "client/command/explain_report.h"
#include "client/command/flags.h"
#include "client/command/frame_report.h"
#include "client/command/output.h"
#include "client/command/parse_values.h"
#include "client/command/session.h"
#include "core/io/camera_path.h"

namespace linetree {
namespace {

struct FlyFlags {
  ConnectionFlags connection;
  SceneFlags scene;
  SizeFlags size;
  RenderOptions options;
  Sampling sampling;
  OutputFlags output;
  bool explain = false;
  std::string path;
  int frames = 0;  // 0: as many as the path says
};

absl::StatusOr<std::vector<FrameRequest>> RequestsOf(const FlyFlags& flags) {
  const absl::StatusOr<CameraPath> path = LoadCameraPath(flags.path);
  if (!path.ok()) return path.status();
  const absl::StatusOr<std::vector<Camera>> cameras =
      SampleCameraPath(*path, flags.frames > 0 ? flags.frames : path->frames);
  if (!cameras.ok()) return cameras.status();
  std::vector<FrameRequest> requests;
  for (const Camera& camera : *cameras) {
    requests.push_back(
        {camera, flags.size.width, flags.size.height, flags.options, flags.sampling});
  }
  return requests;
}

// A name without a number would be overwritten by every frame.
absl::Status CheckOutputs(const OutputFlags& output, size_t frames) {
  for (const std::string& picture : output.pictures) {
    const absl::StatusOr<std::string> name = NumberedName(picture, 1);
    if (frames > 1 && !name.ok()) return name.status();
  }
  std::vector<std::string> files = output.pictures;
  if (!output.stats.empty()) files.push_back(output.stats);
  return CheckFolders(files);
}

absl::Status WriteFrame(const Frame& frame, const OutputFlags& output, int number) {
  for (const std::string& picture : output.pictures) {
    const absl::StatusOr<std::string> name = NumberedName(picture, number);
    absl::Status status = WritePicture(frame, output.layer, name.ok() ? *name : picture);
    if (!status.ok()) return status;
  }
  return absl::OkStatus();
}

absl::StatusOr<int> Fly(const FlyFlags& flags) {
  if (auto s = ValidateExplain(flags.explain, flags.options); !s.ok()) return s;
  const absl::StatusOr<std::vector<FrameRequest>> requests = RequestsOf(flags);
  if (!requests.ok()) return requests.status();
  if (absl::Status s = CheckOutputs(flags.output, requests->size()); !s.ok()) return s;
  absl::StatusOr<Session> session = OpenSession(flags.connection, flags.scene);
  if (!session.ok()) return session.status();

  const bool quiet = flags.output.quiet;
  FrameReport report(session->scene.name(), flags.options, quiet ? nullptr : &std::cout);
  absl::Status written;  // the first failure; frames that arrive after it are not written
  absl::Status flown = session->client->Fly(
      session->scene.name(), *requests, NeedsLayers(flags.output), [&](size_t index, Frame frame) {
        report.Add(frame);
        if (written.ok()) written = WriteFrame(frame, flags.output, static_cast<int>(index) + 1);
      });
  if (!flown.ok()) return flown;
  if (!written.ok()) return written;
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

void AddFly(CLI::App& parent, Commands& commands) {
  auto flags = std::make_shared<FlyFlags>();
  CLI::App* app = parent.add_subcommand("fly", "Render the frames of a camera path");
  AddConnectionFlags(*app, flags->connection);
  AddSceneFlags(*app, flags->scene);
  app->add_option("--path", flags->path, "Camera path: keyframes as Protobuf text")
      ->type_name("FILE")
      ->required()
      ->group("View");
  app->add_option("--frames", flags->frames, "Frames along the path; left out: what the path says")
      ->type_name("N")
      ->check(CLI::Range(1, kMaxPathFrames))
      ->group("View");
  AddSizeFlags(*app, flags->size);
  AddOptionsFlags(*app, flags->options);
  AddSamplingFlags(*app, flags->sampling);
  AddOutputFlags(*app, flags->output);
  AddExplainFlag(*app, flags->explain);
  app->footer(
      "Names of pictures take the number of the frame, from 1, where they have a %d.\n\n"
      "Examples:\n"
      "  linetree fly --scene room --path scenes/paths/room_walk.textproto -o room_%04d.png\n"
      "  linetree fly --local --scene scenes/face.textproto --path "
      "scenes/paths/face_walk.textproto --frames 60 --stats walk.json");
  commands.push_back({app, [flags] { return Fly(*flags); }});
}

}  // namespace linetree
