#include "client/command/policy_corpus.h"

#include <utility>

#include "absl/strings/str_cat.h"

namespace linetree {

std::vector<FlightPattern> AllFlightPatterns() {
  std::vector<FlightPattern> patterns;
  for (size_t i = 0; i < kFlightPatternNames.size(); ++i) {
    patterns.push_back(static_cast<FlightPattern>(i));
  }
  return patterns;
}

std::vector<std::string> CorpusScenes(const std::string& folder) {
  std::vector<std::string> files;
  for (const char* name :
       {"room.textproto", "spd/balls_3.nff", "spd/tree_8.nff", "many_lights.textproto"}) {
    files.push_back(absl::StrCat(folder, "/", name));
  }
  return files;
}

absl::StatusOr<std::vector<SceneFile>> ReadCorpusScenes(const PolicyCorpus& corpus) {
  std::vector<SceneFile> files;
  for (const std::string& path : corpus.scenes) {
    auto file = ReadSceneFileChecked(path);
    if (!file.ok()) return file.status();
    if (file->scene->FindCamera("") == nullptr) {
      return absl::InvalidArgumentError(absl::StrCat(path, ": expected a scene with a camera"));
    }
    files.push_back(*std::move(file));
  }
  return files;
}

absl::StatusOr<std::vector<NamedTrace>> RecordCorpus(const PolicyCorpus& corpus,
                                                     const std::function<void(double)>& progress) {
  const auto files = ReadCorpusScenes(corpus);
  if (!files.ok()) return files.status();
  WorkerPool pool(corpus.threads);
  std::vector<NamedTrace> all;
  const auto count = static_cast<double>(corpus.scenes.size() * corpus.patterns.size());
  for (const SceneFile& file : *files) {
    const Camera* camera = file.scene->FindCamera("");
    for (const FlightPattern pattern : corpus.patterns) {
      FlightTraceOptions options{corpus.size.width, corpus.size.height, {}};
      options.options.max_relative_error = corpus.epsilon;
      const auto views = FlightViews(*file.scene, *camera, pattern, corpus.frames, corpus.seed);
      auto trace = RecordFlight(file.scene, views, options, pool, [&](double share) {
        progress((static_cast<double>(all.size()) + share) / count);
      });
      if (!trace.ok()) return trace.status();
      const std::string name = absl::StrCat(
          file.name, " ", std::string(kFlightPatternNames[static_cast<size_t>(pattern)]));
      all.push_back({name, *std::move(trace)});
    }
  }
  return all;
}

}  // namespace linetree
