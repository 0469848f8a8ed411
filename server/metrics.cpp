#include "server/metrics.h"

#include <google/protobuf/descriptor.h>
#include <prometheus/text_serializer.h>

#include <sstream>

#include "absl/status/status.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"

namespace linetree {
namespace {

// From what a light call takes to what a large picture may.
const prometheus::Histogram::BucketBoundaries kSecondsBounds = {
    0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1, 2.5, 5, 10, 30, 60, 300};

constexpr std::string_view kOther = "other";

}  // namespace

CallMetrics::CallMetrics()
    : calls_(prometheus::BuildCounter()
                 .Name("linetree_calls_total")
                 .Help("Calls that have ended, by RPC and status code.")
                 .Register(registry_)),
      seconds_(prometheus::BuildHistogram()
                   .Name("linetree_call_seconds")
                   .Help("From the arrival of a call to its end.")
                   .Register(registry_)),
      open_(prometheus::BuildGauge()
                .Name("linetree_calls_open")
                .Help("Calls that have arrived and not ended.")
                .Register(registry_)
                .Add({})) {}

void CallMetrics::Begin(std::string_view method) {
  if (ShortMethod(method) != kOther) open_.Increment();
}

void CallMetrics::End(std::string_view method) {
  if (ShortMethod(method) != kOther) open_.Decrement();
}

void CallMetrics::Count(std::string_view method, grpc::StatusCode code,
                        std::chrono::duration<double> took) {
  const std::string rpc = ShortMethod(method);
  calls_.Add({{"rpc", rpc}, {"code", CodeName(code)}}).Increment();
  seconds_.Add({{"rpc", rpc}}, kSecondsBounds).Observe(took.count());
}

std::string MetricsText(const std::vector<prometheus::MetricFamily>& families) {
  std::ostringstream text;
  prometheus::TextSerializer().Serialize(text, families);
  return text.str();
}

std::string ShortMethod(std::string_view method) {
  const auto* service =
      v1::GetLimitsReply::descriptor()->file()->FindServiceByName("RadianceCache");
  absl::string_view name(method.data(), method.size());
  if (!absl::ConsumePrefix(&name, absl::StrCat("/", service->full_name(), "/")))
    return std::string(kOther);
  const std::string own(name);
  return service->FindMethodByName(own) == nullptr ? std::string(kOther) : own;
}

std::string CodeName(grpc::StatusCode code) {
  return absl::StatusCodeToString(static_cast<absl::StatusCode>(code));
}

}  // namespace linetree
