// linetree fly: the frames of a camera path, over one stream.
#include <chrono>
#include <functional>
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
  FrameFormat format;
  bool explain = false;
  std::string path;
  std::optional<double> newest;  // viewpoints a second; none: every viewpoint gets its frame
  int frames = 0;                // 0: as many as the path says
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

// Each viewpoint at its time; those that are overtaken have no frame.
absl::Status FlyNewest(Client& client, const std::string& scene, const FrameFormat& format,
                       const std::vector<FrameRequest>& requests, double views_per_s,
                       const std::function<void(size_t index, Frame frame)>& on_frame) {
  const auto flight = client.Steer(scene, {.format = format}, [&](LiveFrame live) {
    on_frame(live.view, std::move(live.frame));
  });
  using Clock = std::chrono::system_clock;
  const auto began = Clock::now();
  for (size_t i = 0; i < requests.size(); ++i) {
    const std::chrono::duration<double> at(static_cast<double>(i) / views_per_s);
    if (flight->HasEndedBy(began + std::chrono::duration_cast<Clock::duration>(at))) break;
    if (auto looked = flight->Look(requests[i]); !looked.ok()) return looked.status();
  }
  return flight->Land();
}

absl::Status FlyAll(const FlyFlags& flags, Session& session,
                    const std::vector<FrameRequest>& requests, FrameReport& report) {
  absl::Status written;  // the first failure; frames that arrive after it are not written
  const auto on_frame = [&](size_t index, Frame frame) {
    report.Add(frame);
    if (written.ok()) written = WriteFrame(frame, flags.output, static_cast<int>(index) + 1);
  };
  FrameFormat format = flags.format;
  format.all_layers = NeedsLayers(flags.output);
  const std::string& scene = session.scene.name();
  absl::Status flown =
      flags.newest ? FlyNewest(*session.client, scene, format, requests, *flags.newest, on_frame)
                   : session.client->Fly(scene, requests, format, on_frame);
  return flown.ok() ? written : flown;
}

absl::StatusOr<int> Fly(const FlyFlags& flags) {
  if (auto s = ValidateExplain(flags.explain, flags.options); !s.ok()) return s;
  if (auto s = CheckFormat(flags.output, flags.format); !s.ok()) return s;
  const absl::StatusOr<std::vector<FrameRequest>> requests = RequestsOf(flags);
  if (!requests.ok()) return requests.status();
  if (absl::Status s = CheckOutputs(flags.output, requests->size()); !s.ok()) return s;
  absl::StatusOr<Session> session = OpenSession(flags.connection, flags.scene);
  if (!session.ok()) return session.status();

  const bool quiet = flags.output.quiet;
  FrameReport report(session->scene.name(), flags.options, quiet ? nullptr : &std::cout);
  if (auto s = FlyAll(flags, *session, *requests, report); !s.ok()) return s;
  if (flags.newest && !quiet) {
    std::cout << requests->size() << " viewpoints, " << report.frames() << " frames\n";
  }
  if (!flags.output.stats.empty()) {
    nlohmann::json json = report.ToJson();
    json["viewpoints"] = requests->size();
    absl::Status status = WriteJson(json, flags.output.stats);
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
  AddPriorityFlag(*app, flags->connection);
  AddSceneFlags(*app, flags->scene);
  app->add_option("--path", flags->path, "Camera path: keyframes as Protobuf text")
      ->type_name("FILE")
      ->required()
      ->group("View");
  app->add_option("--frames", flags->frames, "Frames along the path; left out: what the path says")
      ->type_name("N")
      ->check(CLI::Range(1, kMaxPathFrames))
      ->group("View");
  AddNewestFlag(*app, flags->newest);
  AddSizeFlags(*app, flags->size);
  AddOptionsFlags(*app, flags->options);
  AddSamplingFlags(*app, flags->sampling);
  AddOutputFlags(*app, flags->output);
  AddFormatFlags(*app, flags->format);
  AddExplainFlag(*app, flags->explain);
  app->footer(
      "Names of pictures take the number of the viewpoint, from 1, where they have a %d.\n\n"
      "Examples:\n"
      "  linetree fly --scene room --path scenes/paths/room_walk.textproto -o room_%04d.png\n"
      "  linetree fly --scene room --path scenes/paths/room_walk.textproto --newest 30 --codec "
      "jpeg "
      "-o walk_%d.jpg\n"
      "  linetree fly --local --scene scenes/face.textproto --path "
      "scenes/paths/face_walk.textproto --frames 60 --stats walk.json");
  commands.push_back({app, [flags] { return Fly(*flags); }});
}

}  // namespace linetree
