// What a call brings beside its request: metadata and deadline (service.proto says what clients may
// send).
#pragma once

#include <grpcpp/server_context.h>

#include <chrono>
#include <string>

#include "absl/strings/string_view.h"

namespace linetree {

inline constexpr char kRequestIdKey[] = "x-request-id";
inline constexpr char kSessionKey[] = "x-session-id";
// Of either. What is longer, empty or not printable is taken for none.
inline constexpr size_t kMaxIdBytes = 128;

bool IsId(absl::string_view text);

struct CallInfo {
  std::string request_id;
  std::string session;
  std::chrono::steady_clock::time_point deadline;  // JobInfo::kNever: none
};

CallInfo ReadCallInfo(grpc::CallbackServerContext* context);

// Sends the request id back in the initial metadata: call it once, before anything is sent. Not for
// refusals: gRPC does not repeat a call that has got initial metadata.
void SendIdBack(const CallInfo& info, grpc::CallbackServerContext* context);

// 32 hexadecimal digits that nobody can guess from others.
std::string RandomId();

}  // namespace linetree
