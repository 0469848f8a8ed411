// A running server. Everything about gRPC's set-up and end is in here.
#pragma once

#include <grpcpp/server.h>
#include <spdlog/logger.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "server/backend.h"
#include "server/options.h"
#include "server/service.h"

namespace linetree {

class Server {
 public:
  // Loads the scenes, then listens, then begins to warm scenes up. INVALID_ARGUMENT for bad
  // options, scenes or camera paths, UNAVAILABLE when the address cannot be listened on.
  static absl::StatusOr<std::unique_ptr<Server>> Start(const ServerOptions& options,
                                                       std::shared_ptr<spdlog::logger> log);
  // Drains without waiting.
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  // Where it listens, with the real port.
  const std::string& address() const { return address_; }
  Backend& backend() { return backend_; }
  // Whether scenes that were to be warmed up are warm; the health service says the same.
  bool is_ready() const { return is_ready_; }

  // Takes no more calls, lets open ones go on for at most `timeout_ms`, then cancels them. Returns
  // when all are done. A second call does nothing.
  void Drain(std::chrono::milliseconds timeout_ms);

 private:
  Server(const ServerOptions& options, const std::shared_ptr<spdlog::logger>& log)
      : backend_(options, log), service_(backend_) {}
  absl::Status Listen(const ServerOptions& options);
  void SetReady(bool is_ready);

  std::string address_;
  Backend backend_;
  Service service_;
  std::atomic<bool> is_ready_ = false;
  std::unique_ptr<grpc::Server> grpc_;
};

}  // namespace linetree
