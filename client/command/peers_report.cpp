#include "client/command/peers_report.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/command/table.h"

namespace linetree {
namespace {

std::string Whole(double value) { return absl::StrFormat("%.0f", value); }

// Shares of a few pixels count: more digits than usual.
std::string Share(double share) { return absl::StrFormat("%.2f %%", 100 * share); }

// The note is the same for all thread counts: told for the first.
bool IsFirstOfItsPeer(const ScenePeers& scene, size_t index) {
  return index == 0 || scene.rows[index - 1].peer != scene.rows[index].peer;
}

}  // namespace

std::string PeersTable(const ScenePeers& scene) {
  Table table({{"peer", Align::kLeft},
               {"version", Align::kLeft},
               {"threads", Align::kRight},
               {"ns/pixel", Align::kRight},
               {"fastest", Align::kRight},
               {"slowest", Align::kRight},
               {"to first row", Align::kRight},
               {"rms", Align::kRight},
               {"off by > 1/255", Align::kRight},
               {"> 5 %", Align::kRight},
               {"timed", Align::kLeft}});
  double reference_ns = 0;
  for (const PeerRow& row : scene.rows) {
    if (!row.status.ok()) continue;
    const PixelTime time = PixelTimeOf(row.seconds, scene.width, scene.height);
    if (reference_ns == 0) reference_ns = time.median_ns;
    table.AddRow({row.peer, row.version, absl::StrCat(row.threads), Whole(time.median_ns),
                  Whole(time.min_ns), Whole(time.max_ns),
                  absl::StrFormat("%.2f", time.median_ns / reference_ns),
                  absl::StrFormat("%.5f", row.difference.rms),
                  Share(row.difference.share_beyond_code),
                  Share(row.difference.share_beyond_5_percent), row.timed});
  }
  return table.ToString();
}

std::string PeersNotes(const ScenePeers& scene) {
  std::string text;
  for (size_t i = 0; i < scene.rows.size(); ++i) {
    const PeerRow& row = scene.rows[i];
    if (!IsFirstOfItsPeer(scene, i)) continue;
    if (!row.status.ok()) absl::StrAppend(&text, row.peer, ": ", row.status.message(), "\n");
    for (const std::string& difference : row.differences) {
      absl::StrAppend(&text, row.peer, " differs: ", difference, "\n");
    }
  }
  return text;
}

nlohmann::json PeersJson(const std::vector<ScenePeers>& scenes, int repeats) {
  nlohmann::json json = {{"repeats", repeats}, {"scenes", nlohmann::json::array()}};
  for (const ScenePeers& scene : scenes) {
    nlohmann::json rows = nlohmann::json::array();
    for (const PeerRow& row : scene.rows) {
      nlohmann::json entry = {{"peer", row.peer}, {"threads", row.threads}};
      if (!row.status.ok()) {
        entry["error"] = std::string(row.status.message());
        rows.push_back(entry);
        continue;
      }
      const PixelTime time = PixelTimeOf(row.seconds, scene.width, scene.height);
      entry["version"] = row.version;
      entry["timed"] = row.timed;
      entry["seconds"] = row.seconds;
      entry["ns_per_pixel"] = {
          {"median", time.median_ns}, {"min", time.min_ns}, {"max", time.max_ns}};
      entry["difference"] = {{"rms", row.difference.rms},
                             {"largest", row.difference.largest},
                             {"share_beyond_1_255", row.difference.share_beyond_code},
                             {"share_beyond_5_percent", row.difference.share_beyond_5_percent},
                             {"on_purpose", row.differences}};
      rows.push_back(entry);
    }
    json["scenes"].push_back({{"scene", scene.scene},
                              {"width", scene.width},
                              {"height", scene.height},
                              {"peers", rows}});
  }
  return json;
}

}  // namespace linetree
