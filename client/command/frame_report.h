// The counters of a sequence of frames, as a table and as JSON: what render, fly and their --stats
// show.
#pragma once

#include <iosfwd>
#include <nlohmann/json.hpp>
#include <string>

#include "client/command/flags.h"
#include "client/command/table.h"
#include "core/render/frame.h"

namespace linetree {

class FrameReport {
 public:
  // Rows go to `out` as frames come; no table when it is null.
  FrameReport(std::string scene, const RenderOptions& options, std::ostream* out);

  void Add(const Frame& frame);
  size_t frames() const { return frames_.size(); }

  // scene, scene_version, mode, epsilon and "frames" with a StatsJson each; of a single frame, its
  // keys also at the top level. Requires that there is a frame.
  nlohmann::json ToJson() const;

 private:
  const std::string scene_;
  const RenderOptions options_;
  std::ostream* const out_;
  const Table table_;
  std::string scene_version_;
  Sampling sampling_;  // of the last frame
  nlohmann::json frames_ = nlohmann::json::array();
};

}  // namespace linetree
