#include "core/io/stats_json.h"

#include <cmath>

namespace linetree {

nlohmann::json StatsJson(const FrameStats& stats, int width, int height) {
  RayCounts total = stats.base;
  total += stats.ip;
  nlohmann::json verdicts = nlohmann::json::object();
  for (size_t i = 0; i < stats.verdicts.size(); ++i) {
    verdicts[std::string(kVerdictNames[i])] = stats.verdicts[i];
  }
  return {{"width", width},
          {"height", height},
          {"pixels", stats.pixels},
          {"eye_rays", total.eye},
          {"reflected_rays", total.reflected},
          {"refracted_rays", total.refracted},
          {"shadow_rays", total.shadow},
          {"listed_shadow_rays", total.listed},
          {"listed_branch_rays", total.listed_branches},
          {"intersect", total.intersect},
          {"shade", total.shade},
          {"base_intersect", stats.base.intersect},
          {"base_shade", stats.base.shade},
          {"ip_intersect", stats.ip.intersect},
          {"ip_shade", stats.ip.shade},
          {"interpolated", stats.interpolated},
          {"traced", stats.traced},
          {"replayed", stats.replayed},
          {"residual", stats.residual},
          {"background", stats.background},
          {"verdicts", std::move(verdicts)},
          {"cells_tried", stats.cells_tried},
          {"cells_accepted", stats.cells_accepted},
          {"cells_evicted", stats.cells_evicted},
          {"cache_bytes", stats.cache_bytes},
          {"wall_ms", JsonNumber(stats.wall_ms)},
          {"cpu_ms", JsonNumber(stats.cpu_ms)}};
}

double ListedShare(const FrameStats& stats) {
  RayCounts all = stats.base;
  all += stats.ip;
  const uint64_t rays = all.shadow + all.reflected + all.refracted;
  const uint64_t listed = all.listed + all.listed_branches;
  return rays == 0 ? 0 : static_cast<double>(listed) / static_cast<double>(rays);
}

double HitRate(const FrameStats& stats) {
  const uint64_t covered = stats.interpolated + stats.traced;
  const uint64_t hits = stats.interpolated + stats.replayed;
  return covered == 0 ? 0 : static_cast<double>(hits) / static_cast<double>(covered);
}

nlohmann::json JsonNumber(double value) {
  if (!std::isfinite(value)) return nullptr;
  return value;
}

}  // namespace linetree
