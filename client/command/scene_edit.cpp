// linetree scene edit: changes a scene that a server holds.
#include <iostream>
#include <memory>

#include "absl/strings/str_format.h"
#include "client/command/command.h"
#include "client/command/flags.h"
#include "client/command/session.h"
#include "client/command/table.h"
#include "core/io/proto_text.h"
#include "core/io/read_file.h"

namespace linetree {
namespace {

// Far more than a person writes, far less than memory.
constexpr uint64_t kMaxEditBytes = uint64_t{64} << 20;

struct SceneEditFlags {
  ConnectionFlags connection;
  std::string scene;
  std::string file;
};

absl::StatusOr<int> EditScene(const SceneEditFlags& flags) {
  const absl::StatusOr<std::string> text = ReadFileAtMost(flags.file, kMaxEditBytes);
  if (!text.ok()) return text.status();
  v1::UpdateSceneRequest request;
  if (auto s = ParseProtoText(*text, flags.file, &request); !s.ok()) return s;
  request.set_scene(flags.scene);
  const absl::StatusOr<std::unique_ptr<Client>> client = Connect(flags.connection);
  if (!client.ok()) return client.status();
  const absl::StatusOr<v1::UpdateSceneReply> reply = (*client)->UpdateScene(request);
  if (!reply.ok()) return reply.status();
  std::cout << absl::StrFormat(
      "%s: version %s, %s objects; %s cells kept, %s dropped, found in %.1f ms\n", flags.scene,
      reply->info().scene_version(), Grouped(reply->info().objects()), Grouped(reply->cells_kept()),
      Grouped(reply->cells_dropped()), reply->find_ms());
  return kExitOk;
}

}  // namespace

void AddSceneEdit(CLI::App& scene, Commands& commands) {
  auto flags = std::make_shared<SceneEditFlags>();
  CLI::App* app = scene.add_subcommand("edit", "Change a scene that a server holds");
  AddConnectionFlags(*app, flags->connection);
  app->add_option("--scene", flags->scene, "Name of one of the server's scenes")
      ->type_name("NAME")
      ->required();
  app->add_option("FILE", flags->file, "The edits: text of an UpdateSceneRequest")->required();
  app->footer(
      "All edits are made, or none. What the server knows of everything that they do not touch "
      "goes on serving.\n\n"
      "A file of edits:\n"
      "  edits { move_object { object { name: \"ball\" } transform { translate { x: 0.5 } } } }\n"
      "  edits { set_material { object { index: 3 } material: \"gold\" } }\n"
      "  edits { remove_light { name: \"lamp\" } }\n\n"
      "Example:\n"
      "  linetree scene edit --scene room edits.textproto");
  commands.push_back({app, [flags] { return EditScene(*flags); }});
}

}  // namespace linetree
