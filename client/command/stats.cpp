// linetree stats: what a server holds and has done.
#include <algorithm>
#include <iostream>
#include <map>
#include <memory>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/command/command.h"
#include "client/command/flags.h"
#include "client/command/session.h"
#include "client/command/table.h"
#include "core/io/layer_colors.h"
#include "core/io/stats_json.h"
#include "core/io/wire.h"

namespace linetree {
namespace {

struct StatsFlags {
  ConnectionFlags connection;
  SceneFlags scene;
  bool json = false;
  bool objects = false;
  bool limits = false;
};

using SceneStats = v1::GetStatsReply::SceneStats;

nlohmann::json AnswersJson(const v1::GetStatsReply::AnswerCounts& answers) {
  return {{"answers", answers.answers()},
          {"sources",
           std::map<std::string, uint64_t>(answers.sources().begin(), answers.sources().end())},
          {"verdicts",
           std::map<std::string, uint64_t>(answers.verdicts().begin(), answers.verdicts().end())}};
}

// Null where the server keeps nothing on its disk.
nlohmann::json StoreJson(const SceneStats& scene) {
  if (!scene.has_store()) return nullptr;
  const auto& store = scene.store();
  return {{"cells_restored", store.cells_restored()}, {"cells_left", store.cells_left()},
          {"cells_written", store.cells_written()},   {"cells_lost", store.cells_lost()},
          {"pages_odd", store.pages_odd()},           {"waiting_bytes", store.waiting_bytes()},
          {"restore_ms", store.restore_ms()},         {"index_bytes", store.index_bytes()}};
}

nlohmann::json SceneStatsJson(const SceneStats& scene) {
  nlohmann::json objects = nlohmann::json::array();
  for (const auto& object : scene.objects()) {
    nlohmann::json cells = nlohmann::json::object();
    for (const auto& [verdict, count] : object.cells()) cells[verdict] = count;
    objects.push_back({{"object", object.object()},
                       {"name", object.name()},
                       {"cells", std::move(cells)},
                       {"answers", AnswersJson(object.answers())}});
  }
  nlohmann::json memory = nlohmann::json::array();
  for (const auto& part : scene.memory()) {
    memory.push_back({{"name", part.name()}, {"bytes", part.bytes()}});
    if (part.has_cells()) memory.back()["cells"] = part.cells();
  }
  return {{"scene", scene.scene()},
          {"scene_version", scene.scene_version()},
          {"frames", scene.frames()},
          {"ray_batches", scene.ray_batches()},
          {"totals", StatsJson(FrameStatsFromWire(scene.totals()), 0, 0)},
          {"cache_bytes", scene.cache_bytes()},
          {"cells", scene.cells()},
          {"eviction_policy", scene.eviction_policy()},
          {"cells_evicted", scene.cells_evicted()},
          {"bytes_evicted", scene.bytes_evicted()},
          {"memory", std::move(memory)},
          {"objects", std::move(objects)},
          {"answers", AnswersJson(scene.answers())},
          {"audit",
           {{"checked", scene.audit().checked()},
            {"violations", scene.audit().violations()},
            {"dropped", scene.audit().dropped()},
            {"max_error_over_allowed", JsonNumber(scene.audit().max_error_over_allowed())}}},
          {"store", StoreJson(scene)},
          {"ahead",
           {{"frames", scene.ahead().frames()},
            {"cells_built", scene.ahead().cells_built()},
            {"cells_used", scene.ahead().cells_used()}}}};
}

nlohmann::json ReplyJson(const v1::GetStatsReply& reply) {
  nlohmann::json scenes = nlohmann::json::array();
  for (const SceneStats& scene : reply.scenes()) scenes.push_back(SceneStatsJson(scene));
  return {{"scenes", std::move(scenes)},
          {"memory_budget_bytes", reply.memory_budget_bytes()},
          {"uptime_s", reply.uptime_s()},
          {"server_version", reply.server_version()},
          {"audit_share", reply.audit_share()}};
}

std::string SceneTable(const v1::GetStatsReply& reply) {
  Table table({{"scene"},
               {"frames", Align::kRight},
               {"batches", Align::kRight},
               {"pixels", Align::kRight},
               {"hit rate", Align::kRight},
               {"intersect", Align::kRight},
               {"shade", Align::kRight},
               {"cells", Align::kRight},
               {"evicted", Align::kRight},
               {"cache", Align::kRight}});
  for (const SceneStats& scene : reply.scenes()) {
    const FrameStats totals = FrameStatsFromWire(scene.totals());
    table.AddRow({scene.scene(), Grouped(scene.frames()), Grouped(scene.ray_batches()),
                  Grouped(totals.pixels), Percent(HitRate(totals)),
                  Grouped(totals.base.intersect + totals.ip.intersect),
                  Grouped(totals.base.shade + totals.ip.shade), Grouped(scene.cells()),
                  Grouped(totals.cells_evicted + scene.cells_evicted()),
                  Bytes(scene.cache_bytes())});
  }
  return table.ToString();
}

// What is kept for the scenes, a row for every part that there is.
std::string MemoryTable(const v1::GetStatsReply& reply) {
  Table table({{"scene"},
               {"kept"},
               {"bytes", Align::kRight},
               {"cells", Align::kRight},
               {"bytes/cell", Align::kRight}});
  for (const SceneStats& scene : reply.scenes()) {
    uint64_t all = 0;
    for (const auto& part : scene.memory()) {
      all += part.bytes();
      if (part.bytes() == 0) continue;
      const bool counted = part.cells() > 0;
      table.AddRow({scene.scene(), part.name(), Grouped(part.bytes()),
                    part.has_cells() ? Grouped(part.cells()) : "",
                    counted ? Grouped(part.bytes() / part.cells()) : ""});
    }
    table.AddRow({scene.scene(), "in all", Grouped(all), "", ""});
  }
  return table.ToString();
}

// What the server's audit found, a row for every scene.
std::string AuditTable(const v1::GetStatsReply& reply) {
  Table table({{"scene"},
               {"checked", Align::kRight},
               {"violations", Align::kRight},
               {"largest error/allowed", Align::kRight},
               {"dropped", Align::kRight}});
  for (const SceneStats& scene : reply.scenes()) {
    const auto& audit = scene.audit();
    table.AddRow({scene.scene(), Grouped(audit.checked()), Grouped(audit.violations()),
                  absl::StrFormat("%.3g", audit.max_error_over_allowed()),
                  Grouped(audit.dropped())});
  }
  return table.ToString();
}

// What is kept on the server's disk, a row for every scene.
std::string StoreTable(const v1::GetStatsReply& reply) {
  Table table({{"scene"},
               {"cells restored", Align::kRight},
               {"no room for", Align::kRight},
               {"restored in", Align::kRight},
               {"cells written", Align::kRight},
               {"lost", Align::kRight},
               {"odd pages", Align::kRight}});
  for (const SceneStats& scene : reply.scenes()) {
    const auto& store = scene.store();
    table.AddRow({scene.scene(), Grouped(store.cells_restored()), Grouped(store.cells_left()),
                  absl::StrFormat("%.1f ms", store.restore_ms()), Grouped(store.cells_written()),
                  Grouped(store.cells_lost()), Grouped(store.pages_odd())});
  }
  return table.ToString();
}

// Answers by source, a row for every object that was seen.
std::string AnswerTable(const SceneStats& scene) {
  std::vector<TableColumn> columns = {{"object"}};
  for (const auto& source : SourceLegend()) {
    columns.push_back({std::string(source.label), Align::kRight});
  }
  Table table(std::move(columns));
  const auto add = [&table](std::string name, const v1::GetStatsReply::AnswerCounts& answers) {
    std::vector<std::string> row = {std::move(name)};
    for (const auto& source : SourceLegend()) {
      const auto found = answers.sources().find(std::string(source.label));
      row.push_back(found == answers.sources().end() ? "" : Grouped(found->second));
    }
    table.AddRow(std::move(row));
  };
  for (const auto& object : scene.objects()) {
    if (object.answers().answers() == 0) continue;
    add(absl::StrCat(object.object(), " ", object.name()), object.answers());
  }
  add("all", scene.answers());
  return table.ToString();
}

// Cells by verdict, a row for every object that has any.
std::string ObjectTable(const SceneStats& scene) {
  std::vector<TableColumn> columns = {{"object"}};
  for (const auto& name : kVerdictNames) columns.push_back({std::string(name), Align::kRight});
  Table table(std::move(columns));
  for (const auto& object : scene.objects()) {
    if (object.cells().empty()) continue;
    std::vector<std::string> row = {absl::StrCat(object.object(), " ", object.name())};
    for (const auto& name : kVerdictNames) {
      const auto found = object.cells().find(std::string(name));
      row.push_back(found == object.cells().end() ? "" : Grouped(found->second));
    }
    table.AddRow(std::move(row));
  }
  return table.ToString();
}

absl::StatusOr<v1::GetStatsReply> GetReply(const StatsFlags& flags) {
  if (flags.scene.scene.empty()) {
    absl::StatusOr<std::unique_ptr<Client>> client = Connect(flags.connection);
    if (!client.ok()) return client.status();
    return (*client)->GetStats("");
  }
  absl::StatusOr<Session> session = OpenSession(flags.connection, flags.scene);
  if (!session.ok()) return session.status();
  return session->client->GetStats(session->scene.name());
}

absl::StatusOr<int> Limits(const StatsFlags& flags) {
  absl::StatusOr<std::unique_ptr<Client>> client = Connect(flags.connection);
  if (!client.ok()) return client.status();
  const absl::StatusOr<v1::GetLimitsReply> reply = (*client)->GetLimits();
  if (!reply.ok()) return reply.status();
  nlohmann::json json = nlohmann::json::array();
  Table table({{"limit"}, {"value", Align::kRight}, {"of what"}});
  for (const auto& limit : reply->limits()) {
    json.push_back({{"name", limit.name()}, {"value", limit.value()}, {"bounds", limit.bounds()}});
    table.AddRow({limit.name(), Grouped(limit.value()), limit.bounds()});
  }
  std::cout << (flags.json ? json.dump(2) + "\n" : table.ToString());
  return kExitOk;
}

absl::StatusOr<int> Stats(const StatsFlags& flags) {
  if (flags.limits) return Limits(flags);
  const absl::StatusOr<v1::GetStatsReply> reply = GetReply(flags);
  if (!reply.ok()) return reply.status();
  if (flags.json) {
    std::cout << ReplyJson(*reply).dump(2) << '\n';
    return kExitOk;
  }
  std::cout << absl::StrFormat("linetreed %s, up %.0f s, memory budget %s\n\n",
                               reply->server_version(), reply->uptime_s(),
                               Bytes(reply->memory_budget_bytes()))
            << SceneTable(*reply) << "\nMemory; kinds of trees share the budget\n"
            << MemoryTable(*reply);
  if (reply->audit_share() > 0) {
    std::cout << absl::StrFormat("\nAudit of a share of %g of the answers from caches\n",
                                 reply->audit_share())
              << AuditTable(*reply);
  }
  const bool is_kept = std::any_of(reply->scenes().begin(), reply->scenes().end(),
                                   [](const SceneStats& scene) { return scene.has_store(); });
  if (is_kept) std::cout << "\nCells on the server's disk\n" << StoreTable(*reply);
  if (!flags.objects) return kExitOk;
  for (const SceneStats& scene : reply->scenes()) {
    std::cout << "\nCells of " << scene.scene() << " by verdict\n"
              << ObjectTable(scene) << "\nAnswers of " << scene.scene() << " by source\n"
              << AnswerTable(scene);
  }
  return kExitOk;
}

}  // namespace

void AddStats(CLI::App& parent, Commands& commands) {
  auto flags = std::make_shared<StatsFlags>();
  CLI::App* app = parent.add_subcommand("stats", "What a server holds and has done");
  AddConnectionFlags(*app, flags->connection);
  AddSceneFlags(*app, flags->scene, /*required=*/false);
  app->add_flag("--objects", flags->objects,
                "Also the cells of every object by verdict, and its answers by source")
      ->group("Output");
  app->add_flag("--limits", flags->limits, "The server's limits instead")->group("Output");
  app->add_flag("--json", flags->json, "Everything as JSON")->group("Output");
  app->footer(
      "Examples:\n"
      "  linetree stats\n"
      "  linetree stats --server 10.0.0.7:50051 --scene room --objects\n"
      "  linetree stats --limits\n"
      "  linetree stats --json");
  commands.push_back({app, [flags] { return Stats(*flags); }});
}

}  // namespace linetree
