// What --explain prints after the frames.
#pragma once

#include <string>

#include "client/command/flags.h"
#include "client/library/client.h"
#include "core/io/wire_explain.h"

namespace linetree {

// Features that the scene has or lacks, and what the planner does about its objects.
std::string ExplanationText(const v1::ExplainReply& explanation);

// --explain, which needs frames by packets; see ValidateExplain.
void AddExplainFlag(CLI::App& app, bool& explain);
// INVALID_ARGUMENT when nothing would be planned that could be explained.
absl::Status ValidateExplain(bool explain, const RenderOptions& options);

// Prints what the client's server, or the client itself, says of a scene.
absl::Status PrintExplanation(Client& client, const std::string& scene,
                              const RenderOptions& options);

}  // namespace linetree
