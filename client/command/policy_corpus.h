// The corpus that policies are compared on: flights through scenes, recorded in this process.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/command/flags.h"
#include "client/command/session.h"
#include "core/audit/flight_corpus.h"

namespace linetree {

struct PolicyCorpus {
  std::vector<std::string> scenes;  // files
  std::vector<FlightPattern> patterns;
  int frames = 160;  // of each flight, all clients together
  SizeFlags size{192, 192};
  double epsilon = 0.1;
  uint64_t seed = 1;
  int threads = 0;
};

struct NamedTrace {
  std::string name;  // scene and pattern
  Trace trace;
};

std::vector<FlightPattern> AllFlightPatterns();

// The files of the scenes that policies and budgets are compared on, in the folder of all scenes.
std::vector<std::string> CorpusScenes(const std::string& folder);

// The corpus' scenes, each of which has a camera: INVALID_ARGUMENT for one that has none.
absl::StatusOr<std::vector<SceneFile>> ReadCorpusScenes(const PolicyCorpus& corpus);

// `progress` gets shares in [0, 1].
absl::StatusOr<std::vector<NamedTrace>> RecordCorpus(const PolicyCorpus& corpus,
                                                     const std::function<void(double)>& progress);

}  // namespace linetree
