#include "server/metrics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace linetree {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(MetricsTest, CallsAreCountedByRpcAndCode) {
  CallMetrics metrics;
  const auto count = [&](const std::string& method, grpc::StatusCode code) {
    metrics.Count(method, code, std::chrono::milliseconds(3));
  };
  count("/linetree.v1.RadianceCache/Fly", grpc::StatusCode::OK);
  count("/linetree.v1.RadianceCache/Fly", grpc::StatusCode::OK);
  count("/linetree.v1.RadianceCache/Fly", grpc::StatusCode::NOT_FOUND);
  // Whatever callers think of makes no series of its own.
  for (const char* other : {"/grpc.health.v1.Health/Check", "/linetree.v1.RadianceCache/Made up",
                            "/linetree.v1.RadianceCache/", "", "/linetree.v1.RadianceCacheFly"}) {
    count(other, grpc::StatusCode::OK);
  }
  const std::string text = MetricsText(metrics.Collect());
  EXPECT_THAT(text, HasSubstr("# TYPE linetree_calls_total counter\n"));
  EXPECT_THAT(text, HasSubstr("linetree_calls_total{code=\"OK\",rpc=\"Fly\"} 2\n"));
  EXPECT_THAT(text, HasSubstr("linetree_calls_total{code=\"NOT_FOUND\",rpc=\"Fly\"} 1\n"));
  EXPECT_THAT(text, HasSubstr("linetree_calls_total{code=\"OK\",rpc=\"other\"} 5\n"));
  EXPECT_THAT(text, HasSubstr("linetree_call_seconds_bucket{rpc=\"Fly\",le=\"0.0025\"} 0\n"));
  EXPECT_THAT(text, HasSubstr("linetree_call_seconds_bucket{rpc=\"Fly\",le=\"0.005\"} 3\n"));
  EXPECT_THAT(text, HasSubstr("linetree_call_seconds_count{rpc=\"Fly\"} 3\n"));
}

TEST(MetricsTest, ScenesAreShownAsStatsHasThem) {
  v1::GetStatsReply stats;
  stats.set_memory_budget_bytes(1 << 20);
  stats.set_server_version("1.2");
  auto* scene = stats.add_scenes();
  scene->set_scene("od\"d\\ly\nnamed");
  scene->set_frames(7);
  scene->set_cells(12);
  scene->mutable_totals()->set_shadow_rays(99);
  scene->mutable_totals()->set_cells_evicted(3);
  scene->set_cells_evicted(4);
  (*scene->mutable_answers()->mutable_sources())["replayed"] = 5;
  (*scene->mutable_answers()->mutable_verdicts())["gap"] = 6;
  scene->mutable_audit()->set_checked(4);
  const std::string text = MetricsText(
      CollectServer(stats, {.waiting_renders = {3, 4, 5}, .open_flights = 2, .log_lines_lost = 8}));
  const std::string name = "{scene=\"od\\\"d\\\\ly\\nnamed\"";
  for (const std::string& line : {
           "linetree_frames_total" + name + "} 7\n",
           "linetree_rays_total" + name + ",kind=\"shadow\"} 99\n",
           "linetree_answers_total" + name + ",source=\"replayed\"} 5\n",
           "linetree_verdicts_total" + name + ",verdict=\"gap\"} 6\n",
           "linetree_cells" + name + ",tree=\"linetree\"} 12\n",
           "linetree_cells_evicted_total" + name + "} 7\n",
           "linetree_audit_checked_total" + name + "} 4\n",
           std::string("linetree_memory_budget_bytes 1048576\n"),
           std::string("linetree_build_info{version=\"1.2\"} 1\n"),
           std::string("linetree_queue_length{queue=\"renders\"} 12\n"),
           std::string("linetree_waiting_renders{class=\"interactive\"} 3\n"),
           std::string("linetree_waiting_renders{class=\"batch\"} 4\n"),
           std::string("linetree_waiting_renders{class=\"background\"} 5\n"),
           std::string("linetree_flights 2\n"),
           std::string("linetree_log_lines_lost_total 8\n"),
       }) {
    EXPECT_THAT(text, HasSubstr(line));
  }
  EXPECT_THAT(text, Not(HasSubstr("process_resident_memory_bytes 0\n")));
}

}  // namespace
}  // namespace linetree
