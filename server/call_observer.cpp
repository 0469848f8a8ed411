#include "server/call_observer.h"

#include <grpcpp/server_context.h>

#include <algorithm>
#include <chrono>
#include <random>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "server/log_format.h"

namespace linetree {
namespace {

using grpc::experimental::InterceptionHookPoints;
using Clock = std::chrono::steady_clock;

constexpr size_t kMaxRequestIdBytes = 128;

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
    if (methods->QueryInterceptionHookPoint(InterceptionHookPoints::PRE_SEND_INITIAL_METADATA)) {
      methods->GetSendInitialMetadata()->emplace(kRequestIdKey, request_id_);
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
      const std::string_view id(found->second.data(), found->second.size());
      if (IsRequestId(id)) request_id_ = id;
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
  std::string request_id_ = MakeRequestId();
  std::string peer_;
  // Of a call whose client went before it had an end.
  grpc::Status status_ = grpc::Status::CANCELLED;
};

}  // namespace

bool IsRequestId(std::string_view text) {
  return !text.empty() && text.size() <= kMaxRequestIdBytes &&
         std::all_of(text.begin(), text.end(), [](char c) {
           return absl::ascii_isalnum(static_cast<unsigned char>(c)) ||
                  std::string_view("_.:-").find(c) != std::string_view::npos;
         });
}

std::string RequestIdOf(const grpc::ServerContextBase& context) {
  const auto found = context.client_metadata().find(kRequestIdKey);
  if (found == context.client_metadata().end()) return "";
  return {found->second.data(), found->second.size()};
}

std::string MakeRequestId() {
  thread_local std::mt19937_64 random{std::random_device{}()};
  return absl::StrCat(absl::Hex(random(), absl::kZeroPad16));
}

grpc::experimental::Interceptor* CallObserverFactory::CreateServerInterceptor(
    grpc::experimental::ServerRpcInfo* info) {
  return new CallObserver(info, metrics_, log_);
}

}  // namespace linetree
