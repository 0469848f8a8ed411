#include "client/library/channel.h"

#include <grpc/support/time.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>
#include <grpcpp/support/channel_arguments.h>

#include <algorithm>
#include <limits>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "client/library/status.h"

namespace linetree {
namespace {

using Clock = std::chrono::system_clock;

// While a call is open; the server allows this often.
constexpr int kKeepaliveTime_ms = 30'000;
constexpr int kKeepaliveTimeout_ms = 10'000;

std::shared_ptr<grpc::ChannelCredentials> MakeCredentials(const ClientOptions& options) {
  if (options.tls_ca_pem.empty()) return grpc::InsecureChannelCredentials();
  grpc::SslCredentialsOptions tls;
  tls.pem_root_certs = options.tls_ca_pem;
  tls.pem_cert_chain = options.tls_cert_pem;
  tls.pem_private_key = options.tls_key_pem;
  return grpc::SslCredentials(tls);
}

}  // namespace

std::shared_ptr<grpc::Channel> MakeChannel(const std::string& address,
                                           const ClientOptions& options) {
  grpc::ChannelArguments arguments;
  // Attempts are counted here, in one place.
  arguments.SetInt(GRPC_ARG_ENABLE_RETRIES, 0);
  arguments.SetMaxReceiveMessageSize(std::numeric_limits<int>::max());
  // Each client its own connection, as clients on different machines would have.
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  // Whoever waits for a server that is being restarted wants to know soon.
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, 100);
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, 2000);
  // A server whose machine is gone says nothing.
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIME_MS, kKeepaliveTime_ms);
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, kKeepaliveTimeout_ms);
  return grpc::CreateCustomChannel(address, MakeCredentials(options), arguments);
}

Caller::Deadline Caller::DeadlineOf(size_t count) const {
  return Clock::now() + options_.call_timeout_ms * static_cast<int64_t>(std::max<size_t>(count, 1));
}

void Caller::Prepare(grpc::ClientContext& context, Deadline deadline) const {
  context.set_deadline(deadline);
  if (!options_.token.empty()) {
    context.AddMetadata("authorization", absl::StrCat("Bearer ", options_.token));
  }
}

absl::Status Caller::StatusOf(const grpc::Status& status, const grpc::ClientContext& context) {
  absl::Status result = FromGrpc(status);
  if (result.ok()) return result;
  // Nobody here cancels but over what the server has sent. A server that shuts down does.
  if (absl::IsCancelled(result)) result = absl::UnavailableError(result.message());
  const auto& trailers = context.GetServerTrailingMetadata();
  const auto hint = trailers.find(kRetryPushbackKey);
  if (hint == trailers.end()) return result;
  int64_t delay_ms = 0;
  // What is no number means "never" (gRFC A6).
  if (!absl::SimpleAtoi(std::string(hint->second.data(), hint->second.size()), &delay_ms)) {
    delay_ms = -1;
  }
  return WithRetryAfter(std::move(result), std::chrono::milliseconds(delay_ms));
}

bool Caller::WaitToRetry(Retries& retries, const absl::Status& status, Deadline deadline) const {
  const auto delay_ms = retries.After(status);
  if (!delay_ms) return false;
  const Deadline next = Clock::now() + *delay_ms;
  if (next >= deadline) return false;
  gpr_sleep_until(grpc::TimePoint<Deadline>(next).raw_time());
  // A server that is gone may come back: an attempt before that would be wasted.
  if (absl::IsUnavailable(status)) {
    channel_->WaitForConnected(std::min(deadline, Clock::now() + options_.connect_timeout_ms));
  }
  return true;
}

}  // namespace linetree
