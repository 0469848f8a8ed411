#include "client/command/frame_report.h"

#include <ostream>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/io/stats_json.h"
#include "core/math/check.h"

namespace linetree {
namespace {

Table MakeTable() {
  return Table({{"frame", Align::kRight},
                {"ms", Align::kRight, 9},
                {"hit rate", Align::kRight},
                {"listed", Align::kRight},
                {"intersect", Align::kRight, 12},
                {"shade", Align::kRight, 11},
                {"cells", Align::kRight, 9},
                {"accepted", Align::kRight, 9},
                {"cache", Align::kRight, 10}});
}

}  // namespace

FrameReport::FrameReport(std::string scene, const RenderOptions& options, std::ostream* out)
    : scene_(std::move(scene)), options_(options), out_(out), table_(MakeTable()) {
  if (out_ != nullptr) *out_ << table_.TitleLine();
}

void FrameReport::Add(const Frame& frame) {
  const FrameStats& stats = frame.stats;
  scene_version_ = frame.scene_version;
  sampling_ = frame.sampling;
  frames_.push_back(StatsJson(stats, frame.width, frame.height));
  if (out_ == nullptr) return;
  *out_ << table_.RowLine({absl::StrCat(frames_.size()), absl::StrFormat("%.1f", stats.wall_ms),
                           Percent(HitRate(stats)), Percent(ListedShare(stats)),
                           Grouped(stats.base.intersect + stats.ip.intersect),
                           Grouped(stats.base.shade + stats.ip.shade), Grouped(stats.cells_tried),
                           Grouped(stats.cells_accepted), Bytes(stats.cache_bytes)})
        << std::flush;
}

nlohmann::json FrameReport::ToJson() const {
  LT_CHECK(!frames_.empty());
  nlohmann::json json = nlohmann::json::object();
  if (frames_.size() == 1) json = frames_.front();
  json["frames"] = frames_;
  json["scene"] = scene_;
  json["scene_version"] = scene_version_;
  json["mode"] = options_.mode == Mode::kCached ? "cached" : "classical";
  json["epsilon"] = options_.max_relative_error;
  json["samples"] = sampling_.samples;
  return json;
}

}  // namespace linetree
