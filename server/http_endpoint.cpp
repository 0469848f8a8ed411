#include "server/http_endpoint.h"

#include <httplib.h>

#include <chrono>
#include <utility>

#include "absl/strings/str_cat.h"
#include "server/options.h"

namespace linetree {
namespace {

constexpr size_t kThreads = 4;
// Whoever is slower is in the way of others.
constexpr std::chrono::seconds kPatience{5};
// Nothing that is sent here has a body.
constexpr size_t kMaxBodyBytes = 4096;

void Answer(httplib::Response& response, int status, const std::string& text) {
  response.status = status;
  response.set_content(text, "text/plain; charset=utf-8");
}

// Each connection shows the certificate that `secrets` then has.
int ShowNewest(SSL* connection, void* secrets) {
  return ShowCertificate(*static_cast<const Secrets*>(secrets)->tls(), connection) ? 1 : 0;
}

std::unique_ptr<httplib::Server> MakeServer(const Secrets& secrets) {
  std::unique_ptr<httplib::Server> http;
  if (secrets.tls() == nullptr) {
    http = std::make_unique<httplib::Server>();
  } else {
    http = std::make_unique<httplib::SSLServer>([&](SSL_CTX& context) {
      SSL_CTX_set_min_proto_version(&context, TLS1_2_VERSION);
      SSL_CTX_set_cert_cb(&context, ShowNewest, const_cast<Secrets*>(&secrets));
      return true;
    });
  }
  http->new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
  http->set_read_timeout(kPatience);
  http->set_write_timeout(kPatience);
  http->set_payload_max_length(kMaxBodyBytes);
  // An idle connection would keep a thread.
  http->set_keep_alive_max_count(1);
  // The default would let a second server take the port, too.
  http->set_socket_options([](int s) {
    const int yes = 1;
    setsockopt(s, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
  });
  return http;
}

std::string WithoutBrackets(const std::string& host) {
  return host.starts_with('[') && host.ends_with(']') ? host.substr(1, host.size() - 2) : host;
}

}  // namespace

HttpEndpoint::HttpEndpoint(std::unique_ptr<httplib::Server> http, Callbacks callbacks)
    : callbacks_(std::move(callbacks)), http_(std::move(http)) {}

void HttpEndpoint::AddRoutes() {
  using httplib::Request;
  using httplib::Response;
  http_->Get("/livez", [](const Request&, Response& response) { Answer(response, 200, "ok\n"); });
  http_->Get("/readyz", [this](const Request&, Response& response) {
    if (callbacks_.is_ready()) return Answer(response, 200, "ok\n");
    Answer(response, 503, "not ready: starting, or stopping\n");
  });
  http_->Get("/metrics", [this](const Request& request, Response& response) {
    if (!callbacks_.may_see_metrics(request.get_header_value("Authorization"))) {
      response.set_header("WWW-Authenticate", "Bearer");
      return Answer(response, 401, "Authorization: expected 'Bearer TOKEN'\n");
    }
    response.set_content(callbacks_.metrics(), "text/plain; version=0.0.4; charset=utf-8");
  });
}

absl::StatusOr<std::unique_ptr<HttpEndpoint>> HttpEndpoint::Start(const std::string& address,
                                                                  const Secrets& secrets,
                                                                  Callbacks callbacks) {
  std::unique_ptr<HttpEndpoint> endpoint(
      new HttpEndpoint(MakeServer(secrets), std::move(callbacks)));
  const auto parts = SplitHostPort(address);
  int port = -1;
  if (parts && endpoint->http_->is_valid()) {
    const std::string host = WithoutBrackets(parts->host);
    if (parts->port == 0) {
      port = endpoint->http_->bind_to_any_port(host);
    } else if (endpoint->http_->bind_to_port(host, parts->port)) {
      port = parts->port;
    }
  }
  if (port < 0) return absl::UnavailableError(absl::StrCat("--http: cannot listen on ", address));
  endpoint->address_ = absl::StrCat(parts->host, ":", port);
  endpoint->AddRoutes();
  endpoint->thread_ = std::thread([endpoint = endpoint.get()] {
    endpoint->http_->listen_after_bind();
    endpoint->ended_ = true;
  });
  return endpoint;
}

HttpEndpoint::~HttpEndpoint() {
  if (!thread_.joinable()) return;
  // Only a loop that has begun can be stopped.
  while (!http_->is_running() && !ended_) std::this_thread::yield();
  http_->stop();
  thread_.join();
}

}  // namespace linetree
