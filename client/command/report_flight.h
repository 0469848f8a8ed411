// Flights of report sections: a scene, and a camera path through it.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/command/report_section.h"
#include "client/command/session.h"

namespace linetree {

// Names of files, below the folder of scenes and without what all have in common.
struct ReportFlight {
  const char* scene;
  const char* path;
};

struct LoadedFlight {
  SceneFile file;
  std::vector<Camera> cameras;
};

// `frames` cameras along the path; 0: as many as it says.
absl::StatusOr<LoadedFlight> LoadFlight(const std::string& scene_file, const std::string& path_file,
                                        int frames = 0);

// Puts hashes of all flights' files into the section's parameters.
void AddFlightFiles(const std::string& folder, std::span<const ReportFlight> flights,
                    ReportSection& section);

// What `fly` says of each flight; its results are "flights" of the whole. Each is given its
// "scene" and "path", too.
using FlyOne = std::function<absl::StatusOr<nlohmann::json>(const LoadedFlight&, const Progress&)>;
absl::StatusOr<nlohmann::json> FlyAll(const std::string& folder,
                                      std::span<const ReportFlight> flights,
                                      const Progress& progress, const FlyOne& fly);

}  // namespace linetree
