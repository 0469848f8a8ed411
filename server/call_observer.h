// Sees every call from its arrival to its end: gives it a request id if it has none (call_info.h),
// counts it, and logs one line.
#pragma once

#include <grpcpp/support/server_interceptor.h>
#include <spdlog/logger.h>

#include <memory>

#include "server/metrics.h"

namespace linetree {

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
