// linetree cache policy: by which a scene's cache evicts, on a running server.
#include <iostream>
#include <memory>

#include "client/command/command.h"
#include "client/command/flags.h"
#include "client/command/output.h"
#include "client/command/session.h"
#include "client/command/table.h"

namespace linetree {
namespace {

struct CachePolicyFlags {
  ConnectionFlags connection;
  std::string scene;
  std::string policy;
  std::string json;
};

absl::StatusOr<int> CachePolicy(const CachePolicyFlags& flags) {
  v1::TuneCacheRequest request;
  request.set_scene(flags.scene);
  if (!flags.policy.empty()) request.set_policy(flags.policy);
  const absl::StatusOr<std::unique_ptr<Client>> client = Connect(flags.connection);
  if (!client.ok()) return client.status();
  const absl::StatusOr<v1::TuneCacheReply> reply = (*client)->TuneCache(request);
  if (!reply.ok()) return reply.status();
  std::cout << flags.scene << ": " << reply->policy() << ", " << Bytes(reply->memory_budget_bytes())
            << " at most\n";
  if (!flags.json.empty()) {
    const nlohmann::json json = {{"scene", flags.scene},
                                 {"policy", reply->policy()},
                                 {"memory_budget_bytes", reply->memory_budget_bytes()}};
    if (auto s = WriteJson(json, flags.json); !s.ok()) return s;
  }
  return kExitOk;
}

}  // namespace

void AddCachePolicy(CLI::App& cache, Commands& commands) {
  auto flags = std::make_shared<CachePolicyFlags>();
  CLI::App* app = cache.add_subcommand("policy", "By which policy a scene's cache makes room");
  AddConnectionFlags(*app, flags->connection);
  app->add_option("NAME", flags->policy,
                  "The policy to go by from now on; without, says which it is")
      ->check(IsPolicy());
  app->add_option("--scene", flags->scene, "Name of one of the server's scenes")
      ->type_name("NAME")
      ->required();
  AddJsonFlag(*app, flags->json, "the answer");
  app->footer(
      "Frames that are under way go on; what is cached stays. 'linetree cache sim --help' lists "
      "the "
      "policies.\n\nExamples:\n"
      "  linetree cache policy --scene room\n"
      "  linetree cache policy lru --scene room");
  commands.push_back({app, [flags] { return CachePolicy(*flags); }});
}

}  // namespace linetree
