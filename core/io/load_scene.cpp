#include "core/io/load_scene.h"

#include "absl/strings/match.h"
#include "core/io/read_file.h"

namespace linetree {

absl::StatusOr<std::unique_ptr<SceneSource>> ReadSceneFile(const std::string& path,
                                                           const SceneLimits& limits) {
  auto text = ReadFileAtMost(path, limits.max_file_bytes);
  if (!text.ok()) return text.status();
  if (absl::EndsWithIgnoreCase(path, ".nff")) return ParseNff(*text, path, limits);
  return ParseSceneText(*text, path, limits);
}

absl::StatusOr<std::shared_ptr<const Scene>> LoadSceneFile(const std::string& path,
                                                           const SceneLimits& limits) {
  auto source = ReadSceneFile(path, limits);
  if (!source.ok()) return source.status();
  return BuildScene(**source, limits);
}

}  // namespace linetree
