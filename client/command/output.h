// Where commands leave their results.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "client/command/flags.h"
#include "core/render/frame.h"

namespace linetree {

// Whether the pictures asked for need more than the beauty layer.
bool NeedsLayers(const OutputFlags& flags);

// OK when the folders of all these files exist: better known before the rendering than after it.
absl::Status CheckFolders(const std::vector<std::string>& files);

// Whether what comes in the format can be written as the flags say: INVALID_ARGUMENT for pictures
// that are to be files of another kind or to show more than the beauty layer.
absl::Status CheckFormat(const OutputFlags& flags, const FrameFormat& format);

// By extension: .exr with everything that the frame has, .png and .jpg showing `layer`; a frame
// that came as a picture as it is.
absl::Status WritePicture(const Frame& frame, Layer layer, const std::string& path);

absl::Status WriteJson(const nlohmann::json& json, const std::string& path);

}  // namespace linetree
