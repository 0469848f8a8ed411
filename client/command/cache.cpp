// linetree cache: what is kept and what is dropped.
#include "client/command/command.h"

namespace linetree {

void AddCache(CLI::App& parent, Commands& commands) {
  CLI::App* app = parent.add_subcommand("cache", "Eviction policies");
  app->require_subcommand(1);
  AddCachePolicy(*app, commands);
  AddCacheSim(*app, commands);
}

}  // namespace linetree
