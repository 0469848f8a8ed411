#include "server/call_info.h"

#include <algorithm>
#include <random>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "server/schedule.h"

namespace linetree {
namespace {

// Empty: there is none that could be used.
std::string FromMetadata(const grpc::CallbackServerContext& context, const char* key) {
  const auto found = context.client_metadata().find(key);
  if (found == context.client_metadata().end()) return {};
  const std::string value(found->second.data(), found->second.size());
  return IsId(value) ? value : std::string();
}

JobInfo::Clock::time_point DeadlineOf(const grpc::CallbackServerContext& context) {
  using std::chrono::system_clock;
  const system_clock::time_point deadline = context.deadline();
  const auto left = deadline - system_clock::now();
  // gRPC says "none" by the end of time, which has no place on another clock.
  constexpr auto kLongest = std::chrono::hours(24 * 365);
  if (deadline == system_clock::time_point::max() || left > kLongest) return JobInfo::kNever;
  return JobInfo::Clock::now() + std::chrono::duration_cast<JobInfo::Clock::duration>(left);
}

}  // namespace

bool IsId(absl::string_view text) {
  return !text.empty() && text.size() <= kMaxIdBytes &&
         std::all_of(text.begin(), text.end(),
                     [](char c) { return absl::ascii_isgraph(static_cast<unsigned char>(c)); });
}

std::string RandomId() {
  std::random_device random;
  std::string id;
  for (int i = 0; i < 4; ++i) absl::StrAppend(&id, absl::Hex(random(), absl::kZeroPad8));
  return id;
}

CallInfo ReadCallInfo(grpc::CallbackServerContext* context) {
  CallInfo info{FromMetadata(*context, kRequestIdKey), FromMetadata(*context, kSessionKey),
                DeadlineOf(*context)};
  if (info.request_id.empty()) info.request_id = RandomId();
  // Names given by clients and addresses do not meet.
  info.session = info.session.empty() ? absl::StrCat("peer ", context->peer())
                                      : absl::StrCat("session ", info.session);
  return info;
}

void SendIdBack(const CallInfo& info, grpc::CallbackServerContext* context) {
  context->AddInitialMetadata(kRequestIdKey, info.request_id);
}

}  // namespace linetree
