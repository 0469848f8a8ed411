#include "client/command/session.h"

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "client/command/local_client.h"
#include "core/io/read_file.h"

namespace linetree {

namespace {

constexpr uint64_t kMaxSecretBytes = uint64_t{1} << 20;

// Nothing for no file.
absl::StatusOr<std::string> ReadOptional(absl::string_view flag, const std::string& path) {
  if (path.empty()) return std::string();
  auto text = ReadFileAtMost(path, kMaxSecretBytes);
  if (text.ok()) return text;
  return absl::Status(text.status().code(), absl::StrCat(flag, ": ", text.status().message()));
}

// One word, whatever stands around it.
absl::StatusOr<std::string> ReadToken(const std::string& path) {
  const char* environment = std::getenv("LINETREE_TOKEN");
  if (path.empty()) return std::string(environment == nullptr ? "" : environment);
  auto text = ReadOptional("--token-file", path);
  if (!text.ok()) return text.status();
  const absl::string_view token = absl::StripAsciiWhitespace(*text);
  if (token.empty() || token.find_first_of(" \t\r\n") != absl::string_view::npos) {
    return absl::InvalidArgumentError(
        absl::StrCat("--token-file: ", path, ": expected a token and nothing else"));
  }
  return std::string(token);
}

}  // namespace

absl::StatusOr<ClientOptions> ReadClientOptions(const ConnectionFlags& flags) {
  auto ca = ReadOptional("--tls-ca", flags.tls_ca);
  if (!ca.ok()) return ca.status();
  auto cert = ReadOptional("--tls-cert", flags.tls_cert);
  if (!cert.ok()) return cert.status();
  auto key = ReadOptional("--tls-key", flags.tls_key);
  if (!key.ok()) return key.status();
  auto token = ReadToken(flags.token_file);
  if (!token.ok()) return token.status();
  if (!flags.tls_ca.empty() && ca->empty()) {
    return absl::InvalidArgumentError(
        absl::StrCat("--tls-ca: ", flags.tls_ca, ": expected certificates in PEM"));
  }
  return ClientOptions{
      .connect_timeout_ms = std::chrono::milliseconds(std::lround(1000 * flags.connect_timeout_s)),
      .tls_ca_pem = *std::move(ca),
      .tls_cert_pem = *std::move(cert),
      .tls_key_pem = *std::move(key),
      .token = *std::move(token),
      .priority = flags.priority};
}

absl::StatusOr<std::unique_ptr<Client>> Connect(const ConnectionFlags& flags) {
  if (flags.local)
    return std::make_unique<LocalClient>(flags.threads, flags.memory_bytes, flags.policy);
  const auto options = ReadClientOptions(flags);
  if (!options.ok()) return options.status();
  return Client::Connect(flags.server, *options);
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
