#include "server/call_observer.h"

#include <grpcpp/server_context.h>

#include <chrono>

#include "absl/strings/str_format.h"
#include "server/call_info.h"
#include "server/log_format.h"

namespace linetree {
namespace {

using grpc::experimental::InterceptionHookPoints;
using Clock = std::chrono::steady_clock;

class CallObserver final : public grpc::experimental::Interceptor {
 public:
  CallObserver(grpc::experimental::ServerRpcInfo* info, std::shared_ptr<CallMetrics> metrics,
               std::shared_ptr<spdlog::logger> log)
      : info_(info), metrics_(std::move(metrics)), log_(std::move(log)) {
    metrics_->Begin(method_);
  }

  // Dies with the call.
  ~CallObserver() override {
    const std::chrono::duration<double> took = Clock::now() - began_;
    metrics_->Count(method_, status_.error_code(), took);
    metrics_->End(method_);
    if (!log_->should_log(LevelOf(status_.error_code()))) return;
    const LogFields fields({{"rpc", method_},
                            {"code", CodeName(status_.error_code())},
                            {"ms", absl::StrFormat("%.3f", 1000 * took.count())},
                            {"request_id", request_id_},
                            {"peer", peer_},
                            {"error", status_.error_message()}});
    log_->log(LevelOf(status_.error_code()), "call");
  }

  void Intercept(grpc::experimental::InterceptorBatchMethods* methods) override {
    if (methods->QueryInterceptionHookPoint(InterceptionHookPoints::POST_RECV_INITIAL_METADATA)) {
      Begin(methods->GetRecvInitialMetadata());
    }
    if (methods->QueryInterceptionHookPoint(InterceptionHookPoints::PRE_SEND_STATUS)) {
      status_ = methods->GetSendStatus();
    }
    methods->Proceed();
  }

 private:
  // The metadata carries the id from now on, whoever made it.
  void Begin(std::multimap<grpc::string_ref, grpc::string_ref>* metadata) {
    peer_ = info_->server_context()->peer();
    const auto found = metadata->find(kRequestIdKey);
    if (found != metadata->end()) {
      const absl::string_view id(found->second.data(), found->second.size());
      if (IsId(id)) request_id_ = std::string(id);
    }
    metadata->erase(kRequestIdKey);
    metadata->emplace(kRequestIdKey, request_id_);
  }

  // What the server is at fault for stands out; calls that went well are for those who ask.
  static spdlog::level::level_enum LevelOf(grpc::StatusCode code) {
    switch (code) {
      case grpc::StatusCode::OK:
        return spdlog::level::debug;
      case grpc::StatusCode::INTERNAL:
      case grpc::StatusCode::UNKNOWN:
      case grpc::StatusCode::DATA_LOSS:
        return spdlog::level::err;
      default:
        return spdlog::level::info;
    }
  }

  grpc::experimental::ServerRpcInfo* const info_;
  const std::shared_ptr<CallMetrics> metrics_;
  const std::shared_ptr<spdlog::logger> log_;
  const Clock::time_point began_ = Clock::now();
  const std::string method_ = info_->method();
  std::string request_id_ = RandomId();
  std::string peer_;
  // Of a call whose client went before it had an end.
  grpc::Status status_ = grpc::Status::CANCELLED;
};

}  // namespace

grpc::experimental::Interceptor* CallObserverFactory::CreateServerInterceptor(
    grpc::experimental::ServerRpcInfo* info) {
  return new CallObserver(info, metrics_, log_);
}

}  // namespace linetree
