// /livez, /readyz and /metrics by HTTP, for whoever watches over the server.
//
//   /livez    200 while the process answers at all
//   /readyz   200 while calls are served, else 503
//   /metrics  200 with MetricsText; 401 without the token that `may_see_metrics` wants
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <thread>

#include "absl/status/statusor.h"
#include "server/secrets.h"

namespace httplib {
class Server;
}

namespace linetree {

class HttpEndpoint {
 public:
  // Called on threads of the endpoint.
  struct Callbacks {
    std::function<bool()> is_ready;
    std::function<std::string()> metrics;
    // `authorization` is the header of this name, empty when there is none.
    std::function<bool(const std::string& authorization)> may_see_metrics;
  };

  // `address` is host:port, port 0 takes a free one. HTTPS where `secrets`, which must outlive the
  // endpoint, has a certificate; clients need none. UNAVAILABLE when the address cannot be listened
  // on.
  static absl::StatusOr<std::unique_ptr<HttpEndpoint>> Start(const std::string& address,
                                                             const Secrets& secrets,
                                                             Callbacks callbacks);
  // Ends when the requests that are being answered are done.
  ~HttpEndpoint();
  HttpEndpoint(const HttpEndpoint&) = delete;
  HttpEndpoint& operator=(const HttpEndpoint&) = delete;

  // host:port, with the real port.
  const std::string& address() const { return address_; }

 private:
  HttpEndpoint(std::unique_ptr<httplib::Server> http, Callbacks callbacks);
  void AddRoutes();

  const Callbacks callbacks_;
  std::unique_ptr<httplib::Server> http_;
  std::string address_;
  std::atomic<bool> ended_{false};
  std::thread thread_;
};

}  // namespace linetree
