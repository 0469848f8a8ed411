// Sees every call from its arrival to its end: gives it a request id, counts it, and logs one line.
#pragma once

#include <grpcpp/server_context.h>
#include <grpcpp/support/server_interceptor.h>
#include <spdlog/logger.h>

#include <memory>
#include <string>
#include <string_view>

#include "server/metrics.h"

namespace linetree {

// Metadata that names a call, of the caller's choice; it comes back with the initial metadata.
inline constexpr char kRequestIdKey[] = "x-request-id";

// 1 to 128 of [A-Za-z0-9_.:-].
bool IsRequestId(std::string_view text);
// 16 hexadecimal digits, at random.
std::string MakeRequestId();
// That of a call that is being answered.
std::string RequestIdOf(const grpc::ServerContextBase& context);

// Calls may end after the server does: what they need is shared.
class CallObserverFactory final : public grpc::experimental::ServerInterceptorFactoryInterface {
 public:
  CallObserverFactory(std::shared_ptr<CallMetrics> metrics, std::shared_ptr<spdlog::logger> log)
      : metrics_(std::move(metrics)), log_(std::move(log)) {}

  grpc::experimental::Interceptor* CreateServerInterceptor(
      grpc::experimental::ServerRpcInfo* info) override;

 private:
  const std::shared_ptr<CallMetrics> metrics_;
  const std::shared_ptr<spdlog::logger> log_;
};

}  // namespace linetree
