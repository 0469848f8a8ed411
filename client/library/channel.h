// Connections to a server, and what goes with every call on one.
#pragma once

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>

#include <chrono>
#include <memory>
#include <string>

#include "absl/status/status.h"
#include "client/library/client.h"

namespace linetree {

// Does not connect yet.
std::shared_ptr<grpc::Channel> MakeChannel(const std::string& address,
                                           const ClientOptions& options);

// The calls of a client: deadline and token of each, and its attempts.
class Caller {
 public:
  using Deadline = std::chrono::system_clock::time_point;

  Caller(std::shared_ptr<grpc::Channel> channel, const ClientOptions& options)
      : channel_(std::move(channel)), options_(options) {}

  // The deadline of `count` calls that begin now.
  Deadline DeadlineOf(size_t count = 1) const;
  void Prepare(grpc::ClientContext& context, Deadline deadline) const;

  // The status of a call that has ended, with the server's hint when to try again.
  static absl::Status StatusOf(const grpc::Status& status, const grpc::ClientContext& context);

  // Waits as `retries` says, and for a connection. False when `status` is the call's last word.
  bool WaitToRetry(Retries& retries, const absl::Status& status, Deadline deadline) const;

  // Runs attempt(context) -> grpc::Status until it succeeds or has no more attempts.
  // Of calls that are not to be made twice only attempts that were refused for want of room, which
  // have not begun, are repeated.
  enum class Repeat { kAlways, kIfRefused };
  template <class Attempt>
  absl::Status Call(const Attempt& attempt, Repeat repeat = Repeat::kAlways) const {
    const Deadline deadline = DeadlineOf();
    Retries retries(options_.retry);
    for (;;) {
      grpc::ClientContext context;
      Prepare(context, deadline);
      const absl::Status status = StatusOf(attempt(context), context);
      if (repeat == Repeat::kIfRefused && !absl::IsResourceExhausted(status)) return status;
      if (status.ok() || !WaitToRetry(retries, status, deadline)) return status;
    }
  }

  const ClientOptions& options() const { return options_; }

 private:
  const std::shared_ptr<grpc::Channel> channel_;
  const ClientOptions options_;
};

}  // namespace linetree
