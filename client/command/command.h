// What the sub-commands of `linetree` have in common: how they are registered, and how they end.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace linetree {

// Exit statuses. A command that judges (compare, scene check) also exits with 1 for "no".
inline constexpr int kExitOk = 0;
inline constexpr int kExitFailure = 1;
inline constexpr int kExitUsage = 2;
// What was measured is not what was wanted (load --objective, bench report).
inline constexpr int kExitMissed = 3;

// Does the work once the command line has been parsed; returns the exit status, or an error that
// main() reports.
using Run = std::function<absl::StatusOr<int>()>;

// A sub-command that has no sub-commands of its own.
struct Command {
  CLI::App* app;
  Run run;
};
using Commands = std::vector<Command>;

// Each adds one sub-command (or, for groups, several) to `parent` and to `commands`. Defined in the
// file of the command's name.
void AddRender(CLI::App& parent, Commands& commands);
void AddFly(CLI::App& parent, Commands& commands);
void AddRays(CLI::App& parent, Commands& commands);
void AddStats(CLI::App& parent, Commands& commands);
void AddScene(CLI::App& parent, Commands& commands);
void AddSceneEdit(CLI::App& scene, Commands& commands);
void AddCompare(CLI::App& parent, Commands& commands);
void AddLoad(CLI::App& parent, Commands& commands);
void AddStore(CLI::App& parent, Commands& commands);
void AddCache(CLI::App& parent, Commands& commands);
void AddCachePolicy(CLI::App& cache, Commands& commands);
void AddCacheSim(CLI::App& cache, Commands& commands);
// `bench`: one command for each measurement.
void AddBench(CLI::App& parent, Commands& commands);
void AddBenchAccuracy(CLI::App& bench, Commands& commands);
void AddBenchAudit(CLI::App& bench, Commands& commands);
void AddBenchBudget(CLI::App& bench, Commands& commands);
void AddBenchCertify(CLI::App& bench, Commands& commands);
void AddBenchEdit(CLI::App& bench, Commands& commands);
void AddBenchError(CLI::App& bench, Commands& commands);
void AddBenchLookups(CLI::App& bench, Commands& commands);
void AddBenchPaper(CLI::App& bench, Commands& commands);
void AddBenchPeers(CLI::App& bench, Commands& commands);
void AddBenchPolicies(CLI::App& bench, Commands& commands);
void AddBenchRays(CLI::App& bench, Commands& commands);
void AddBenchReport(CLI::App& bench, Commands& commands);
void AddBenchSpeed(CLI::App& bench, Commands& commands);

// Writes "linetree: message" as one line to standard error and returns `exit_status`.
int Report(const absl::Status& status, int exit_status = kExitFailure);

// The whole program: parses, runs, reports; returns the exit status.
int RunCommandLine(int argc, const char* const* argv);

}  // namespace linetree
