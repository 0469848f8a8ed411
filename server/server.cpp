#include "server/server.h"

#include <grpc/grpc.h>
#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/health_check_service_interface.h>
#include <grpcpp/server_builder.h>

#include <algorithm>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "server/call_observer.h"
#include "server/log_sink.h"
#include "server/tls_credentials.h"
#include "server/token_processor.h"

namespace linetree {
namespace {

// Peers that died without a word are noticed within these two together.
constexpr int kKeepaliveTime_ms = 30'000;
constexpr int kKeepaliveTimeout_ms = 10'000;
constexpr int kMinPingInterval_ms = 10'000;

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
  auto secrets = Secrets::Read(options.tls, options.token_file);
  if (!secrets.ok()) return secrets.status();
  std::unique_ptr<Server> server(new Server(options, *std::move(secrets), log));
  server->MakeCredentials();
  if (auto status = server->StartHttp(options); !status.ok()) return status;
  if (auto status = server->backend_.LoadSceneFiles(); !status.ok()) return status;
  if (auto status = server->Listen(options); !status.ok()) return status;
  server->SetReady(false);
  auto status = server->backend_.WarmUp([server = server.get()] { server->SetReady(true); });
  if (!status.ok()) return status;
  if (options.insecure && !IsLoopback(options.listen)) {
    log->warn("{} can be reached from other machines, and --insecure lets them", server->address_);
  }
  return server;
}

absl::Status Server::StartHttp(const ServerOptions& options) {
  if (options.http.empty()) return absl::OkStatus();
  auto http = HttpEndpoint::Start(
      options.http, *secrets_,
      {.is_ready = [this] { return is_ready_.load(); },
       .metrics = [this] { return MetricsText(); },
       .may_see_metrics = [this](const std::string& header) { return MaySeeMetrics(header); }});
  if (!http.ok()) return http.status();
  http_ = *std::move(http);
  return absl::OkStatus();
}

void Server::MakeCredentials() {
  if (secrets_->tls() == nullptr) {
    credentials_ = grpc::InsecureServerCredentials();
    return;
  }
  credentials_ = std::make_shared<TlsCredentials>(*secrets_);
  if (secrets_->tokens() == nullptr) return;
  credentials_->SetAuthMetadataProcessor(
      std::make_shared<TokenProcessor>(*secrets_, metrics_, log_));
}

void Server::ReloadSecrets() {
  const auto [tls, tokens] = secrets_->Reload();
  for (const absl::Status& status : {tls, tokens}) {
    if (!status.ok()) log_->error("{}; the old ones stay", std::string(status.message()));
  }
  if (secrets_->tls() != nullptr && tls.ok()) log_->info("certificate and key are read anew");
  if (secrets_->tokens() != nullptr && tokens.ok()) log_->info("tokens are read anew");
}

absl::Status Server::Listen(const ServerOptions& options) {
  grpc::EnableDefaultHealthCheckService(true);
  grpc::reflection::InitProtoReflectionServerBuilderPlugin();
  grpc::ServerBuilder builder;
  int port = 0;
  builder.AddListeningPort(options.listen, credentials_, &port);
  builder.RegisterService(&gate_);
  std::vector<std::unique_ptr<grpc::experimental::ServerInterceptorFactoryInterface>> observers;
  observers.push_back(std::make_unique<CallObserverFactory>(metrics_, log_));
  builder.experimental().SetInterceptorCreators(std::move(observers));
  builder.SetMaxReceiveMessageSize(options.limits.max_message_bytes);
  builder.AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS,
                             options.limits.max_streams_per_connection);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, kKeepaliveTime_ms);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, kKeepaliveTimeout_ms);
  // Clients may find out as often whether we are still there.
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS,
                             kMinPingInterval_ms);
  // Otherwise a second server on the same port would silently get half of the calls.
  builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
  grpc_ = builder.BuildAndStart();
  if (grpc_ == nullptr) {
    return absl::UnavailableError(absl::StrCat("--listen: cannot listen on ", options.listen));
  }
  address_ = WithPort(options.listen, port);
  TellHealthOfScenes();
  return absl::OkStatus();
}

void Server::SetReady(bool is_ready) {
  is_ready_ = is_ready;
  auto* health = grpc_->GetHealthCheckService();
  if (health == nullptr) return;
  health->SetServingStatus("", is_ready);
  health->SetServingStatus(v1::RadianceCache::service_full_name(), is_ready);
}

void Server::TellHealthOfScenes() {
  auto* health = grpc_->GetHealthCheckService();
  if (health == nullptr) return;
  backend_.scenes().Observe([health](const std::string& name, bool there) {
    health->SetServingStatus(absl::StrCat(kSceneHealthPrefix, name), there);
  });
}

std::string Server::MetricsText() {
  std::vector<prometheus::MetricFamily> families = metrics_->Collect();
  Load load = backend_.CurrentLoad();
  for (const auto& sink : log_->sinks()) {
    if (const auto* lossy = dynamic_cast<const LogSink*>(sink.get())) {
      load.log_lines_lost += lossy->lines_lost();
    }
  }
  for (auto& family : CollectServer(backend_.GetSums(), load)) {
    families.push_back(std::move(family));
  }
  return linetree::MetricsText(families);
}

bool Server::MaySeeMetrics(const std::string& authorization) const {
  const auto tokens = secrets_->tokens();
  return !tokens || CheckCaller(*tokens, {authorization}, Role::kViewer, "metrics").ok();
}

void Server::Drain(std::chrono::milliseconds timeout_ms) {
  if (grpc_ == nullptr) return;
  backend_.StopBackground();
  SetReady(false);
  backend_.scenes().Observe(nullptr);
  // Whatever else is told from now on is not heard.
  if (auto* health = grpc_->GetHealthCheckService()) health->Shutdown();
  using std::chrono::steady_clock;
  const auto deadline = steady_clock::now() + timeout_ms;
  // Once gRPC shuts down, calls that arrive are cancelled without a word: better they hear it from
  // the gate, until the others are done.
  gate_.Close();
  service_.Drain();
  backend_.open_calls().Close(deadline, kLastReplies_ms);
  // What is still open now is watched health and reflection, which never end by themselves.
  const auto left = std::max(deadline - steady_clock::now(), steady_clock::duration::zero());
  grpc_->Shutdown(std::chrono::system_clock::now() +
                  std::min<steady_clock::duration>(left, kLastReplies_ms));
  grpc_.reset();
  backend_.open_calls().AwaitNone();
  backend_.SaveTrace();
}

Server::~Server() {
  Drain(std::chrono::milliseconds(0));
  // Before what it asks.
  http_.reset();
}

}  // namespace linetree
