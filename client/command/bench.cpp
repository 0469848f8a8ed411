// linetree bench: measurements, one sub-command each.
#include "client/command/command.h"

namespace linetree {

void AddBench(CLI::App& parent, Commands& commands) {
  CLI::App* app = parent.add_subcommand("bench", "Measurements of accuracy and speed");
  app->require_subcommand(1);
  AddBenchAccuracy(*app, commands);
  AddBenchAudit(*app, commands);
  AddBenchBudget(*app, commands);
  AddBenchCertify(*app, commands);
  AddBenchEdit(*app, commands);
  AddBenchError(*app, commands);
  AddBenchLookups(*app, commands);
  AddBenchPaper(*app, commands);
  AddBenchPeers(*app, commands);
  AddBenchPolicies(*app, commands);
  AddBenchRays(*app, commands);
  AddBenchReport(*app, commands);
  AddBenchSpeed(*app, commands);
}

}  // namespace linetree
