#include "client/command/policy_flags.h"

#include <map>
#include <string>

namespace linetree {
namespace {

void AddPatterns(CLI::App& app, PolicyCorpus& corpus) {
  std::map<std::string, FlightPattern> names;
  for (size_t i = 0; i < kFlightPatternNames.size(); ++i) {
    const auto pattern = static_cast<FlightPattern>(i);
    names.emplace(kFlightPatternNames[i], pattern);
  }
  app.add_option("--flight", corpus.patterns, "What clients do; may be given again; all by default")
      ->type_name("PATTERN")
      ->transform(CLI::CheckedTransformer(names, CLI::ignore_case))
      ->default_str("");
}

}  // namespace

void AddCorpusFlags(CLI::App& app, PolicyCorpus& corpus) {
  app.add_option("--scene", corpus.scenes, "Scene file; may be given again")
      ->type_name("FILE")
      ->capture_default_str();
  AddPatterns(app, corpus);
  app.add_option("--frames", corpus.frames, "Of each flight, all clients together")
      ->type_name("N")
      ->check(CLI::Range(1, 100'000))
      ->capture_default_str();
  AddSizeFlags(app, corpus.size);
  app.add_option("--epsilon", corpus.epsilon, "What cached answers promise")
      ->type_name("E")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  app.add_option("--seed", corpus.seed, "Of where flights lead")
      ->type_name("N")
      ->capture_default_str();
  AddThreadsFlag(app, corpus.threads);
}

}  // namespace linetree
