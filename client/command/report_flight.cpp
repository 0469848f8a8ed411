#include "client/command/report_flight.h"

#include <array>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/command/scene_files.h"
#include "core/io/camera_path.h"

namespace linetree {
namespace {

// Of its scene and its path.
std::array<std::string, 2> FilesOf(const std::string& folder, const ReportFlight& flight) {
  return {absl::StrCat(folder, "/", flight.scene),
          absl::StrCat(folder, "/paths/", flight.path, ".textproto")};
}

}  // namespace

absl::StatusOr<LoadedFlight> LoadFlight(const std::string& scene_file, const std::string& path_file,
                                        int frames) {
  auto file = ReadSceneFileChecked(scene_file);
  if (!file.ok()) return file.status();
  const auto path = LoadCameraPath(path_file);
  if (!path.ok()) return path.status();
  auto cameras = SampleCameraPath(*path, frames > 0 ? frames : path->frames);
  if (!cameras.ok()) return cameras.status();
  return LoadedFlight{*std::move(file), *std::move(cameras)};
}

void AddFlightFiles(const std::string& folder, std::span<const ReportFlight> flights,
                    ReportSection& section) {
  for (const ReportFlight& flight : flights) {
    for (const std::string& file : FilesOf(folder, flight)) {
      section.parameters["files"][file] = HashOfFile(file);
    }
  }
}

absl::StatusOr<nlohmann::json> FlyAll(const std::string& folder,
                                      std::span<const ReportFlight> flights,
                                      const Progress& progress, const FlyOne& fly) {
  nlohmann::json all = nlohmann::json::array();
  for (const ReportFlight& flight : flights) {
    const auto [scene, path] = FilesOf(folder, flight);
    const auto loaded = LoadFlight(scene, path);
    if (!loaded.ok()) return loaded.status();
    const auto part = [&](double share) {
      progress((static_cast<double>(all.size()) + share) / static_cast<double>(flights.size()));
    };
    auto json = fly(*loaded, part);
    if (!json.ok()) return json.status();
    json->update({{"scene", loaded->file.name}, {"path", flight.path}});
    all.push_back(*std::move(json));
  }
  return nlohmann::json{{"flights", std::move(all)}};
}

}  // namespace linetree
