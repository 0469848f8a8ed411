// What the server tells of itself.
#include "core/io/wire.h"
#include "server/backend.h"
#include "server/limit_list.h"

namespace linetree {

v1::GetStatsReply::SceneStats Backend::StatsOf(const NamedHost& scene) {
  v1::GetStatsReply::SceneStats stats = SumsOf(scene);
  CellVerdictsToWire(*scene.host, &stats);
  // The sum again, so that it is that of the objects.
  AnswerCountsToWire(scene.answers->values(), scene.host->scene(), &stats);
  return stats;
}

v1::GetStatsReply::SceneStats Backend::SumsOf(const NamedHost& scene) {
  v1::GetStatsReply::SceneStats stats = SceneSumsToWire(scene.name, *scene.host);
  *stats.mutable_audit() = AuditStatsToWire(scene.audit->values());
  AnswerSumToWire(scene.answers->sum(), &stats);
  if (scene.pages) *stats.mutable_store() = StoreStatsToWire(scene.pages->counts());
  return stats;
}

void Backend::AddServer(v1::GetStatsReply& reply) const {
  reply.set_memory_budget_bytes(options_.memory_bytes);
  const std::chrono::duration<double> up = std::chrono::steady_clock::now() - started_;
  reply.set_uptime_s(up.count());
  reply.set_server_version(LINETREE_VERSION);
  reply.set_audit_share(options_.audit_share);
}

v1::GetStatsReply Backend::GetSums() const {
  v1::GetStatsReply reply;
  for (const NamedHost& scene : scenes_.All()) *reply.add_scenes() = SumsOf(scene);
  AddServer(reply);
  return reply;
}

v1::GetLimitsReply Backend::GetLimits() const {
  v1::GetLimitsReply reply;
  for (const NamedLimit& limit : ListLimits(options_.limits)) {
    v1::GetLimitsReply::Limit* out = reply.add_limits();
    out->set_name(std::string(limit.name));
    out->set_value(limit.value);
    out->set_bounds(std::string(limit.bounds));
  }
  return reply;
}

absl::StatusOr<v1::GetStatsReply> Backend::GetStats(const v1::GetStatsRequest& request) const {
  v1::GetStatsReply reply;
  if (request.scene().empty()) {
    for (const NamedHost& scene : scenes_.All()) {
      *reply.add_scenes() = StatsOf(scene);
    }
  } else {
    auto scene = scenes_.Find(request.scene(), "scene");
    if (!scene.ok()) return scene.status();
    *reply.add_scenes() = StatsOf(*scene);
  }
  AddServer(reply);
  return reply;
}

}  // namespace linetree
