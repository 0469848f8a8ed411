#include "server/server.h"

#include <grpc/grpc.h>
#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/health_check_service_interface.h>
#include <grpcpp/server_builder.h>

#include <algorithm>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"

namespace linetree {
namespace {

// Peers that died without a word are noticed within these two together.
constexpr int kKeepaliveTime_ms = 30'000;
constexpr int kKeepaliveTimeout_ms = 10'000;

// gRPC takes itself down with the last of its objects, and may then wait ten seconds for a poll of
// its own; so it stays up until the process ends.
void KeepGrpcUp() {
  static const int once = (grpc_init(), 0);
  static_cast<void>(once);
}

// Closing a connection on which something has come that gRPC has not read yet, as clients that read
// send all the time, takes back what they have not read yet. So much time they get for it.
constexpr std::chrono::milliseconds kLastReplies_ms{100};

std::string WithPort(const std::string& listen, int port) {
  if (absl::StartsWith(listen, "unix:")) return listen;
  return absl::StrCat(listen.substr(0, listen.rfind(':')), ":", port);
}

}  // namespace

absl::StatusOr<std::unique_ptr<Server>> Server::Start(const ServerOptions& options,
                                                      std::shared_ptr<spdlog::logger> log) {
  if (auto status = ValidateServerOptions(options); !status.ok()) return status;
  KeepGrpcUp();
  std::unique_ptr<Server> server(new Server(options, log));
  if (auto status = server->backend_.LoadSceneFiles(); !status.ok()) return status;
  if (auto status = server->Listen(options); !status.ok()) return status;
  server->SetReady(false);
  auto status = server->backend_.WarmUp([server = server.get()] { server->SetReady(true); });
  if (!status.ok()) return status;
  if (!IsLoopback(options.listen)) {
    log->warn("{} can be reached from other machines, and nothing asks who calls",
              server->address_);
  }
  return server;
}

absl::Status Server::Listen(const ServerOptions& options) {
  grpc::EnableDefaultHealthCheckService(true);
  grpc::reflection::InitProtoReflectionServerBuilderPlugin();
  grpc::ServerBuilder builder;
  int port = 0;
  builder.AddListeningPort(options.listen, grpc::InsecureServerCredentials(), &port);
  builder.RegisterService(&service_);
  builder.SetMaxReceiveMessageSize(options.limits.max_message_bytes);
  builder.AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS,
                             options.limits.max_streams_per_connection);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, kKeepaliveTime_ms);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, kKeepaliveTimeout_ms);
  // Otherwise a second server on the same port would silently get half of the calls.
  builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
  grpc_ = builder.BuildAndStart();
  if (grpc_ == nullptr) {
    return absl::UnavailableError(absl::StrCat("--listen: cannot listen on ", options.listen));
  }
  address_ = WithPort(options.listen, port);
  return absl::OkStatus();
}

void Server::SetReady(bool is_ready) {
  is_ready_ = is_ready;
  auto* health = grpc_->GetHealthCheckService();
  if (health == nullptr) return;
  health->SetServingStatus("", is_ready);
  health->SetServingStatus(v1::RadianceCache::service_full_name(), is_ready);
}

void Server::Drain(std::chrono::milliseconds timeout_ms) {
  if (grpc_ == nullptr) return;
  backend_.StopWarmUps();
  SetReady(false);
  service_.Drain();
  using std::chrono::steady_clock;
  const auto deadline = steady_clock::now() + timeout_ms;
  backend_.open_calls().Close(deadline, kLastReplies_ms);
  const auto left = std::max(deadline - steady_clock::now(), steady_clock::duration::zero());
  grpc_->Shutdown(std::chrono::system_clock::now() + left);
  grpc_.reset();
}

Server::~Server() { Drain(std::chrono::milliseconds(0)); }

}  // namespace linetree
