// What --explain prints after the frames.
#pragma once

#include <string>

#include "client/command/flags.h"
#include "client/library/client.h"
#include "core/render/scene_host.h"

namespace linetree {

// Features that the scene has or lacks, and every object with what the planner does about it.
std::string ExplanationText(const Scene& scene, const SceneHost::Explanation& explanation);

// --explain, which needs --local and frames by packets; see ValidateExplain.
void AddExplainFlag(CLI::App& app, bool& explain);
// INVALID_ARGUMENT when nothing would be planned that could be explained.
absl::Status ValidateExplain(bool explain, const RenderOptions& options);

// Prints the explanation of a scene of a LocalClient.
absl::Status PrintExplanation(Client& client, const std::string& scene,
                              const RenderOptions& options);

}  // namespace linetree
