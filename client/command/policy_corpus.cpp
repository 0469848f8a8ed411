#include "client/command/policy_corpus.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "client/command/session.h"

namespace linetree {

std::vector<FlightPattern> AllFlightPatterns() {
  std::vector<FlightPattern> patterns;
  for (size_t i = 0; i < kFlightPatternNames.size(); ++i) {
    patterns.push_back(static_cast<FlightPattern>(i));
  }
  return patterns;
}

absl::StatusOr<std::vector<NamedTrace>> RecordCorpus(const PolicyCorpus& corpus,
                                                     const std::function<void(double)>& progress) {
  WorkerPool pool(corpus.threads);
  std::vector<NamedTrace> all;
  const auto count = static_cast<double>(corpus.scenes.size() * corpus.patterns.size());
  for (const std::string& path : corpus.scenes) {
    const absl::StatusOr<SceneFile> file = ReadSceneFileChecked(path);
    if (!file.ok()) return file.status();
    const Camera* camera = file->scene->FindCamera("");
    if (camera == nullptr) {
      return absl::InvalidArgumentError(absl::StrCat(path, ": expected a scene with a camera"));
    }
    for (const FlightPattern pattern : corpus.patterns) {
      FlightTraceOptions options{corpus.size.width, corpus.size.height, {}};
      options.options.max_relative_error = corpus.epsilon;
      const auto views = FlightViews(*file->scene, *camera, pattern, corpus.frames, corpus.seed);
      auto trace = RecordFlight(file->scene, views, options, pool, [&](double share) {
        progress((static_cast<double>(all.size()) + share) / count);
      });
      if (!trace.ok()) return trace.status();
      const std::string name = absl::StrCat(
          file->name, " ", std::string(kFlightPatternNames[static_cast<size_t>(pattern)]));
      all.push_back({name, *std::move(trace)});
    }
  }
  return all;
}

}  // namespace linetree
