// What the server knows of itself, as families of metrics.
#include <unistd.h>

#include <fstream>

#include "server/metrics.h"

namespace linetree {
namespace {

using prometheus::ClientMetric;
using prometheus::MetricFamily;
using prometheus::MetricType;
using Labels = std::vector<ClientMetric::Label>;
using SceneStats = v1::GetStatsReply::SceneStats;

// Families in the making.
class Families {
 public:
  // A family that Add adds to from now on.
  void Begin(const char* name, MetricType type, const char* help) {
    families_.push_back({name, help, type, {}});
  }
  template <class Number>
  void Add(Number value, Labels labels = {}) {
    ClientMetric metric;
    metric.label = std::move(labels);
    MetricFamily& family = families_.back();
    auto& field = family.type == MetricType::Counter ? metric.counter.value : metric.gauge.value;
    field = static_cast<double>(value);
    family.metric.push_back(std::move(metric));
  }
  std::vector<MetricFamily> Take() { return std::move(families_); }

 private:
  std::vector<MetricFamily> families_;
};

void AddServer(const v1::GetStatsReply& stats, const Load& load, Families& out) {
  out.Begin("linetree_build_info", MetricType::Gauge, "1, with the version of the server.");
  out.Add(1, {{"version", stats.server_version()}});
  out.Begin("linetree_uptime_seconds", MetricType::Gauge, "Since the server was started.");
  out.Add(stats.uptime_s());
  out.Begin("linetree_memory_budget_bytes", MetricType::Gauge, "For the caches of all scenes.");
  out.Add(stats.memory_budget_bytes());
  out.Begin("linetree_queue_length", MetricType::Gauge, "Jobs that wait to be worked on.");
  size_t renders = 0;
  for (const size_t waiting : load.waiting_renders) renders += waiting;
  out.Add(renders, {{"queue", "renders"}});
  out.Add(load.waiting_loads, {{"queue", "loads"}});
  out.Begin("linetree_waiting_renders", MetricType::Gauge,
            "Of the queue of renders, by class of priority.");
  const char* const classes[] = {"interactive", "batch", "background"};
  static_assert(std::size(classes) == kPriorities);
  for (size_t i = 0; i < std::size(classes); ++i) {
    out.Add(load.waiting_renders[i], {{"class", classes[i]}});
  }
  out.Begin("linetree_flights", MetricType::Gauge, "Flights that are open.");
  out.Add(load.open_flights);
  out.Begin("linetree_log_lines_lost_total", MetricType::Counter,
            "Lines that the log did not take.");
  out.Add(load.log_lines_lost);
}

// Adds what `value` says of every scene.
template <class Value>
void AddOfScenes(const v1::GetStatsReply& stats, Families& out, const Value& value) {
  for (const SceneStats& scene : stats.scenes()) out.Add(value(scene), {{"scene", scene.scene()}});
}

void AddWork(const v1::GetStatsReply& stats, Families& out) {
  out.Begin("linetree_frames_total", MetricType::Counter, "Frames that were rendered.");
  AddOfScenes(stats, out, [](const SceneStats& s) { return s.frames(); });
  out.Begin("linetree_ray_batches_total", MetricType::Counter, "Batches of rays answered.");
  AddOfScenes(stats, out, [](const SceneStats& s) { return s.ray_batches(); });
  out.Begin("linetree_rays_total", MetricType::Counter,
            "Rays that were traced, those to build cells counted, by kind.");
  for (const SceneStats& scene : stats.scenes()) {
    const auto& totals = scene.totals();
    out.Add(totals.eye_rays(), {{"scene", scene.scene()}, {"kind", "eye"}});
    out.Add(totals.reflected_rays(), {{"scene", scene.scene()}, {"kind", "reflected"}});
    out.Add(totals.refracted_rays(), {{"scene", scene.scene()}, {"kind", "refracted"}});
    out.Add(totals.shadow_rays(), {{"scene", scene.scene()}, {"kind", "shadow"}});
  }
}

void AddAnswers(const v1::GetStatsReply& stats, Families& out) {
  out.Begin("linetree_answers_total", MetricType::Counter,
            "Answers, one a pixel or ray, by where they came from.");
  for (const SceneStats& scene : stats.scenes()) {
    for (const auto& [source, count] : scene.answers().sources()) {
      out.Add(count, {{"scene", scene.scene()}, {"source", source}});
    }
  }
  out.Begin("linetree_verdicts_total", MetricType::Counter,
            "Answers, by what became of the last cell on the way to them.");
  for (const SceneStats& scene : stats.scenes()) {
    for (const auto& [verdict, count] : scene.answers().verdicts()) {
      out.Add(count, {{"scene", scene.scene()}, {"verdict", verdict}});
    }
  }
}

void AddHoldings(const v1::GetStatsReply& stats, Families& out) {
  out.Begin("linetree_cells", MetricType::Gauge, "Cells that are held, by kind of tree.");
  for (const SceneStats& scene : stats.scenes()) {
    out.Add(scene.cells(), {{"scene", scene.scene()}, {"tree", "linetree"}});
    out.Add(scene.surface_cells(), {{"scene", scene.scene()}, {"tree", "surface"}});
  }
  out.Begin("linetree_cells_evicted_total", MetricType::Counter,
            "Cells that made room for others.");
  AddOfScenes(stats, out, [](const SceneStats& s) {
    return s.totals().cells_evicted() + s.cells_evicted();  // of the paper's judge, and the others
  });
  out.Begin("linetree_cache_bytes", MetricType::Gauge, "Of the budget, used.");
  AddOfScenes(stats, out, [](const SceneStats& s) { return s.cache_bytes(); });
  out.Begin("linetree_scene_memory_bytes", MetricType::Gauge, "All that is kept for a scene.");
  for (const SceneStats& scene : stats.scenes()) {
    for (const auto& part : scene.memory()) {
      out.Add(part.bytes(), {{"scene", scene.scene()}, {"part", part.name()}});
    }
  }
}

// Scenes that are not kept have no values.
void AddStore(const v1::GetStatsReply& stats, Families& out) {
  out.Begin("linetree_store_cells_total", MetricType::Counter,
            "Cells that were kept on the disk, by what became of them.");
  for (const SceneStats& scene : stats.scenes()) {
    if (!scene.has_store()) continue;
    const auto& store = scene.store();
    out.Add(store.cells_restored(), {{"scene", scene.scene()}, {"cells", "restored"}});
    out.Add(store.cells_left(), {{"scene", scene.scene()}, {"cells", "left"}});
    out.Add(store.cells_written(), {{"scene", scene.scene()}, {"cells", "written"}});
    out.Add(store.cells_lost(), {{"scene", scene.scene()}, {"cells", "lost"}});
  }
  out.Begin("linetree_store_odd_pages_total", MetricType::Counter,
            "Pages that were not as they had been written.");
  for (const SceneStats& scene : stats.scenes()) {
    if (scene.has_store()) out.Add(scene.store().pages_odd(), {{"scene", scene.scene()}});
  }
}

void AddAhead(const v1::GetStatsReply& stats, Families& out) {
  out.Begin("linetree_ahead_cells_total", MetricType::Counter,
            "Cells built before anybody asked for them, and those of them used since.");
  for (const SceneStats& scene : stats.scenes()) {
    out.Add(scene.ahead().cells_built(), {{"scene", scene.scene()}, {"cells", "built"}});
    out.Add(scene.ahead().cells_used(), {{"scene", scene.scene()}, {"cells", "used"}});
  }
}

void AddAudit(const v1::GetStatsReply& stats, Families& out) {
  out.Begin("linetree_audit_checked_total", MetricType::Counter, "Answers that were traced again.");
  AddOfScenes(stats, out, [](const SceneStats& s) { return s.audit().checked(); });
  out.Begin("linetree_audit_violations_total", MetricType::Counter,
            "Of these, those that broke their promise.");
  AddOfScenes(stats, out, [](const SceneStats& s) { return s.audit().violations(); });
  out.Begin("linetree_audit_max_error_over_allowed", MetricType::Gauge,
            "Largest error of the checked, by what was allowed: above 1 a violation.");
  AddOfScenes(stats, out, [](const SceneStats& s) { return s.audit().max_error_over_allowed(); });
  out.Begin("linetree_audit_dropped_total", MetricType::Counter, "Picked, but not checked.");
  AddOfScenes(stats, out, [](const SceneStats& s) { return s.audit().dropped(); });
}

// Pages, from proc(5); 0 where there is no such file.
uint64_t ResidentBytes() {
  uint64_t size = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> size >> resident;
  return resident * static_cast<uint64_t>(sysconf(_SC_PAGESIZE));
}

}  // namespace

std::vector<MetricFamily> CollectServer(const v1::GetStatsReply& stats, const Load& load) {
  Families families;
  AddServer(stats, load, families);
  AddWork(stats, families);
  AddAnswers(stats, families);
  AddHoldings(stats, families);
  AddAhead(stats, families);
  AddAudit(stats, families);
  AddStore(stats, families);
  families.Begin("process_resident_memory_bytes", MetricType::Gauge, "Of this process.");
  families.Add(ResidentBytes());
  return families.Take();
}

}  // namespace linetree
