// What /metrics shows, in the text format of Prometheus: calls as they end, and everything that the
// server knows of itself when it is asked.
#pragma once

#include <grpcpp/support/status.h>
#include <prometheus/counter.h>
#include <prometheus/family.h>
#include <prometheus/gauge.h>
#include <prometheus/histogram.h>
#include <prometheus/metric_family.h>
#include <prometheus/registry.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "linetree/v1/service.pb.h"
#include "server/schedule.h"

namespace linetree {

// Thread safety: all methods may be called from any thread.
class CallMetrics {
 public:
  CallMetrics();

  // A call begins, or ends: those between are open.
  void Begin(std::string_view method);
  void End(std::string_view method);

  // `method` is a full name as gRPC has it; methods of other services than ours count as "other".
  void Count(std::string_view method, grpc::StatusCode code, std::chrono::duration<double> took);
  std::vector<prometheus::MetricFamily> Collect() const { return registry_.Collect(); }

 private:
  prometheus::Registry registry_;
  prometheus::Family<prometheus::Counter>& calls_;
  prometheus::Family<prometheus::Histogram>& seconds_;
  prometheus::Gauge& open_;
};

// What the server holds and has to do.
struct Load {
  std::array<size_t, kPriorities> waiting_renders{};  // by Priority
  size_t waiting_loads = 0;
  uint64_t open_flights = 0;
  uint64_t log_lines_lost = 0;
};

// Frames, answers, rays, cells, bytes and audit of every scene, the budget, the load, and this
// process's memory.
std::vector<prometheus::MetricFamily> CollectServer(const v1::GetStatsReply& stats,
                                                    const Load& load);

std::string MetricsText(const std::vector<prometheus::MetricFamily>& families);

// Short name of a method of ours ("/linetree.v1.RadianceCache/Fly": "Fly"), "other" for others.
std::string ShortMethod(std::string_view method);
// "OK", "NOT_FOUND", …
std::string CodeName(grpc::StatusCode code);

}  // namespace linetree
