#include "client/command/session.h"

#include <chrono>
#include <cmath>
#include <filesystem>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "client/command/local_client.h"

namespace linetree {

absl::StatusOr<std::unique_ptr<Client>> Connect(const ConnectionFlags& flags) {
  if (flags.local) return std::make_unique<LocalClient>(flags.threads, flags.memory_bytes);
  ClientOptions options;
  options.connect_timeout_ms =
      std::chrono::milliseconds(std::lround(1000 * flags.connect_timeout_s));
  return Client::Connect(flags.server, options);
}

bool IsSceneFile(const std::string& scene) {
  std::error_code error;
  return absl::StrContains(scene, '/') || absl::EndsWithIgnoreCase(scene, ".textproto") ||
         absl::EndsWithIgnoreCase(scene, ".nff") || std::filesystem::is_regular_file(scene, error);
}

absl::StatusOr<SceneFile> ReadSceneFileChecked(const std::string& path) {
  absl::StatusOr<std::unique_ptr<SceneSource>> source = ReadSceneFile(path);
  if (!source.ok()) return source.status();
  absl::StatusOr<std::shared_ptr<const Scene>> scene = BuildScene(**source);
  if (!scene.ok()) return scene.status();
  return SceneFile{std::filesystem::path(path).stem().string(), *std::move(source),
                   *std::move(scene)};
}

absl::StatusOr<v1::SceneInfo> SendScene(Client& client, const SceneFile& file,
                                        const std::string& name, bool replace) {
  // In this process the scene need not be built again.
  if (auto* local = dynamic_cast<LocalClient*>(&client)) {
    return local->AddScene(name, file.scene, replace);
  }
  absl::StatusOr<v1::SceneInfo> info = client.LoadScene(name, file.source->message(), replace);
  if (absl::IsAlreadyExists(info.status())) {
    return absl::AlreadyExistsError(
        absl::StrCat(info.status().message(), "; --replace puts this one in its place"));
  }
  return info;
}

absl::StatusOr<Session> OpenSession(const ConnectionFlags& connection, const SceneFlags& scene) {
  SceneFile file;
  const bool is_file = IsSceneFile(scene.scene);
  if (is_file) {
    absl::StatusOr<SceneFile> read = ReadSceneFileChecked(scene.scene);
    if (!read.ok()) return read.status();
    file = *std::move(read);
  }
  absl::StatusOr<std::unique_ptr<Client>> client = Connect(connection);
  if (!client.ok()) return client.status();
  absl::StatusOr<v1::SceneInfo> info = is_file ? SendScene(**client, file, file.name, scene.replace)
                                               : (*client)->DescribeScene(scene.scene);
  if (!info.ok()) return info.status();
  return Session{*std::move(client), *std::move(info)};
}

}  // namespace linetree
