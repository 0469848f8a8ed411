// From a file or message to a Scene: the one door through which scenes come in.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "core/scene/scene.h"
#include "linetree/v1/scene.pb.h"

namespace linetree {

// A parsed scene that has not been validated, with where its fields stood in the text. `Where` maps
// a field path such as "objects[3].sphere.radius" to "file:line:column", or to "file" (or "" for a
// message from the wire) when the position is not known.
class SceneSource {
 public:
  virtual ~SceneSource() = default;
  virtual const v1::Scene& message() const = 0;
  virtual std::string Where(std::string_view field_path) const = 0;
};

// Reads .nff as NFF and everything else as Protobuf text. Errors: NOT_FOUND, INVALID_ARGUMENT
// ("file:line:column: field path: what was expected, what was found"), RESOURCE_EXHAUSTED (limits).
absl::StatusOr<std::unique_ptr<SceneSource>> ReadSceneFile(const std::string& path,
                                                           const SceneLimits& limits = {});
absl::StatusOr<std::unique_ptr<SceneSource>> ParseSceneText(std::string_view text,
                                                            const std::string& file_name,
                                                            const SceneLimits& limits = {});
absl::StatusOr<std::unique_ptr<SceneSource>> ParseNff(std::string_view text,
                                                      const std::string& file_name,
                                                      const SceneLimits& limits = {});
std::unique_ptr<SceneSource> SceneFromMessage(v1::Scene message);

// Validates (DESIGN: scene and shading) and builds. The first error is returned, with its place.
absl::StatusOr<std::shared_ptr<const Scene>> BuildScene(const SceneSource& source,
                                                        const SceneLimits& limits = {});

// ReadSceneFile, then BuildScene.
absl::StatusOr<std::shared_ptr<const Scene>> LoadSceneFile(const std::string& path,
                                                           const SceneLimits& limits = {});

// Protobuf text that ParseSceneText reads back to an equal message.
std::string WriteSceneText(const v1::Scene& message);

}  // namespace linetree
