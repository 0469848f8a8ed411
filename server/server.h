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
#include "server/gate.h"
#include "server/http_endpoint.h"
#include "server/metrics.h"
#include "server/options.h"
#include "server/secrets.h"
#include "server/service.h"

namespace linetree {

// gRPC's health service knows a scene by this and its name.
inline constexpr char kSceneHealthPrefix[] = "scene/";

class Server {
 public:
  // Answers by HTTP if it is wanted, loads the scenes, listens, and begins to warm scenes up.
  // INVALID_ARGUMENT for bad options, certificates, tokens, scenes or camera paths, UNAVAILABLE
  // when an address cannot be listened on.
  static absl::StatusOr<std::unique_ptr<Server>> Start(const ServerOptions& options,
                                                       std::shared_ptr<spdlog::logger> log);
  // Drains without waiting.
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  // Where it listens, with the real port.
  const std::string& address() const { return address_; }
  // Likewise for HTTP; empty without.
  std::string http_address() const { return http_ ? http_->address() : ""; }
  Backend& backend() { return backend_; }
  // Whether scenes that were to be warmed up are warm; the health service says the same.
  bool is_ready() const { return is_ready_; }

  // Reads certificates, key and tokens anew, for calls and connections that come; those that are
  // open go on. What is bad is a line of the log, and the old ones stay.
  void ReloadSecrets();

  // Is not ready from now on, takes no more calls, lets open ones go on for at most `timeout_ms`,
  // then cancels them. Returns when all are done. A second call does nothing.
  void Drain(std::chrono::milliseconds timeout_ms);

 private:
  Server(const ServerOptions& options, std::unique_ptr<Secrets> secrets,
         const std::shared_ptr<spdlog::logger>& log)
      : secrets_(std::move(secrets)),
        log_(log),
        backend_(options, log),
        service_(backend_),
        gate_(service_, *secrets_) {}
  absl::Status StartHttp(const ServerOptions& options);
  absl::Status Listen(const ServerOptions& options);
  // In the clear, or by TLS and with a look at tokens before requests are read.
  void MakeCredentials();
  void SetReady(bool is_ready);
  // As they come and go.
  void TellHealthOfScenes();
  std::string MetricsText();
  bool MaySeeMetrics(const std::string& authorization) const;

  const std::unique_ptr<Secrets> secrets_;
  const std::shared_ptr<spdlog::logger> log_;
  const std::shared_ptr<CallMetrics> metrics_ = std::make_shared<CallMetrics>();
  std::string address_;
  Backend backend_;
  Service service_;
  Gate gate_;
  std::atomic<bool> is_ready_ = false;
  std::shared_ptr<grpc::ServerCredentials> credentials_;
  std::unique_ptr<grpc::Server> grpc_;
  std::unique_ptr<HttpEndpoint> http_;
};

}  // namespace linetree
