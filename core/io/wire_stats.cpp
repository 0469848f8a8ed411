// Counters of frames and batches; the rest of wire.h is in wire.cpp.
#include "core/io/wire.h"

namespace linetree {
namespace {

RayCounts Sum(RayCounts a, const RayCounts& b) { return a += b; }

using Counts = std::array<uint64_t, kVerdictCount>;

// Only those that are not 0.
void CountsToWire(const Counts& counts, google::protobuf::Map<std::string, uint64_t>* map) {
  for (size_t v = 0; v < kVerdictCount; ++v) {
    if (counts[v] > 0) (*map)[std::string(kVerdictNames[v])] = counts[v];
  }
}

}  // namespace

v1::FrameStats FrameStatsToWire(const FrameStats& stats, int width, int height) {
  v1::FrameStats message;
  message.set_width(static_cast<uint32_t>(width));
  message.set_height(static_cast<uint32_t>(height));
  message.set_pixels(stats.pixels);
  const RayCounts all = Sum(stats.base, stats.ip);
  message.set_eye_rays(all.eye);
  message.set_reflected_rays(all.reflected);
  message.set_refracted_rays(all.refracted);
  message.set_shadow_rays(all.shadow);
  message.set_ip_eye_rays(stats.ip.eye);
  message.set_ip_reflected_rays(stats.ip.reflected);
  message.set_ip_refracted_rays(stats.ip.refracted);
  message.set_ip_shadow_rays(stats.ip.shadow);
  message.set_listed_shadow_rays(all.listed);
  message.set_ip_listed_shadow_rays(stats.ip.listed);
  message.set_listed_branch_rays(all.listed_branches);
  message.set_ip_listed_branch_rays(stats.ip.listed_branches);
  message.set_summed_surfaces(all.summed);
  message.set_ip_summed_surfaces(stats.ip.summed);
  message.set_intersect(all.intersect);
  message.set_shade(all.shade);
  message.set_base_intersect(stats.base.intersect);
  message.set_base_shade(stats.base.shade);
  message.set_ip_intersect(stats.ip.intersect);
  message.set_ip_shade(stats.ip.shade);
  message.set_interpolated(stats.interpolated);
  message.set_traced(stats.traced);
  message.set_replayed(stats.replayed);
  message.set_residual(stats.residual);
  message.set_background(stats.background);
  CountsToWire(stats.verdicts, message.mutable_verdicts());
  message.set_cells_tried(stats.cells_tried);
  message.set_cells_accepted(stats.cells_accepted);
  message.set_cells_evicted(stats.cells_evicted);
  message.set_cache_bytes(stats.cache_bytes);
  message.set_wall_ms(stats.wall_ms);
  message.set_cpu_ms(stats.cpu_ms);
  return message;
}

FrameStats FrameStatsFromWire(const v1::FrameStats& message) {
  FrameStats stats;
  stats.pixels = message.pixels();
  stats.interpolated = message.interpolated();
  stats.traced = message.traced();
  stats.replayed = message.replayed();
  stats.residual = message.residual();
  stats.background = message.background();
  stats.ip = {.eye = message.ip_eye_rays(),
              .reflected = message.ip_reflected_rays(),
              .refracted = message.ip_refracted_rays(),
              .shadow = message.ip_shadow_rays(),
              .listed = message.ip_listed_shadow_rays(),
              .listed_branches = message.ip_listed_branch_rays(),
              .summed = message.ip_summed_surfaces(),
              .intersect = message.ip_intersect(),
              .shade = message.ip_shade()};
  stats.base = {.eye = message.eye_rays() - stats.ip.eye,
                .reflected = message.reflected_rays() - stats.ip.reflected,
                .refracted = message.refracted_rays() - stats.ip.refracted,
                .shadow = message.shadow_rays() - stats.ip.shadow,
                .listed = message.listed_shadow_rays() - stats.ip.listed,
                .listed_branches = message.listed_branch_rays() - stats.ip.listed_branches,
                .summed = message.summed_surfaces() - stats.ip.summed,
                .intersect = message.base_intersect(),
                .shade = message.base_shade()};
  for (size_t v = 0; v < kVerdictCount; ++v) {
    const auto found = message.verdicts().find(std::string(kVerdictNames[v]));
    if (found != message.verdicts().end()) stats.verdicts[v] = found->second;
  }
  stats.cells_tried = message.cells_tried();
  stats.cells_accepted = message.cells_accepted();
  stats.cells_evicted = message.cells_evicted();
  stats.cache_bytes = message.cache_bytes();
  stats.wall_ms = message.wall_ms();
  stats.cpu_ms = message.cpu_ms();
  return stats;
}

v1::GetStatsReply::SceneStats SceneSumsToWire(const std::string& name, SceneHost& host) {
  const HostTotals totals = host.totals();
  v1::GetStatsReply::SceneStats stats;
  stats.set_scene(name);
  stats.set_scene_version(host.scene().version);
  stats.set_frames(totals.frames);
  stats.set_ray_batches(totals.ray_batches);
  *stats.mutable_totals() = FrameStatsToWire(totals.stats, 0, 0);
  stats.set_cache_bytes(host.CacheBytes());
  stats.set_cells(host.cache().CellCount() + host.paths().CellCount());
  stats.set_surface_cells(host.surfaces().CellCount());
  stats.set_eviction_policy(host.policy());
  const Evicted evicted = host.evicted();
  stats.set_cells_evicted(evicted.cells);
  stats.set_bytes_evicted(evicted.bytes);
  for (const MemoryPart& part : host.Memory()) {
    v1::GetStatsReply::MemoryPart* out = stats.add_memory();
    out->set_name(std::string(part.name));
    out->set_bytes(part.bytes);
    if (part.has_cells) out->set_cells(part.cells);
  }
  const AheadTotals ahead = host.ahead();
  stats.mutable_ahead()->set_frames(ahead.frames);
  stats.mutable_ahead()->set_cells_built(ahead.cells.built);
  stats.mutable_ahead()->set_cells_used(ahead.cells.used);
  return stats;
}

void CellVerdictsToWire(SceneHost& host, v1::GetStatsReply::SceneStats* stats) {
  std::vector<Counts> cells = host.cache().CellVerdicts();
  const std::vector<Counts> certified = host.paths().CellVerdicts();
  for (size_t object = 0; object < cells.size(); ++object) {
    for (size_t v = 0; v < kVerdictCount; ++v) cells[object][v] += certified[object][v];
    if (cells[object] == Counts{}) continue;
    v1::GetStatsReply::ObjectStats* out = stats->add_objects();
    out->set_object(static_cast<uint32_t>(object));
    out->set_name(host.scene().objects[object].name);
    CountsToWire(cells[object], out->mutable_cells());
  }
}

v1::GetStatsReply::SceneStats SceneStatsToWire(const std::string& name, SceneHost& host) {
  v1::GetStatsReply::SceneStats stats = SceneSumsToWire(name, host);
  CellVerdictsToWire(host, &stats);
  return stats;
}

v1::GetStatsReply::AuditStats AuditStatsToWire(const AuditCounts::Values& counts) {
  v1::GetStatsReply::AuditStats stats;
  stats.set_checked(counts.checked);
  stats.set_violations(counts.violations);
  stats.set_dropped(counts.dropped);
  stats.set_max_error_over_allowed(counts.max_error_over_allowed);
  return stats;
}

v1::GetStatsReply::StoreStats StoreStatsToWire(const StoreCounts& counts) {
  v1::GetStatsReply::StoreStats stats;
  stats.set_cells_restored(counts.cells_restored);
  stats.set_cells_left(counts.cells_left);
  stats.set_cells_written(counts.cells_written);
  stats.set_cells_lost(counts.cells_lost);
  stats.set_pages_odd(counts.pages_odd);
  stats.set_waiting_bytes(counts.waiting_bytes);
  stats.set_restore_ms(counts.restore_ms);
  stats.set_index_bytes(counts.index_bytes);
  return stats;
}

}  // namespace linetree
