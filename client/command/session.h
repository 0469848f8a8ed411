// A client and the scene that a command works on.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "client/command/flags.h"
#include "client/library/client.h"
#include "core/io/load_scene.h"

namespace linetree {

struct Session {
  std::unique_ptr<Client> client;
  v1::SceneInfo scene;  // scene.name() is what calls take
};

// What the flags name, read. Errors name the flag and the file.
absl::StatusOr<ClientOptions> ReadClientOptions(const ConnectionFlags& flags);

// --server or --local.
absl::StatusOr<std::unique_ptr<Client>> Connect(const ConnectionFlags& flags);

// Whether --scene means a file: it exists, has a folder in it or a scene file's extension.
bool IsSceneFile(const std::string& scene);

// A scene file that has been read and checked.
struct SceneFile {
  std::string name;  // the file's, without folders and extension
  std::unique_ptr<SceneSource> source;
  std::shared_ptr<const Scene> scene;
};
absl::StatusOr<SceneFile> ReadSceneFileChecked(const std::string& path);

// Gives a scene to a server or to this process under `name`.
absl::StatusOr<v1::SceneInfo> SendScene(Client& client, const SceneFile& file,
                                        const std::string& name, bool replace);

// Connects and makes sure that the scene is there; files are checked here first, so that errors say
// where in the file.
absl::StatusOr<Session> OpenSession(const ConnectionFlags& connection, const SceneFlags& scene);

}  // namespace linetree
