// Credentials for gRPC that take certificate and key from Secrets for each new connection, so that
// they may change while the server runs; connections that are open go on. gRPC's C++ interface has
// none such but experimental ones that look at files by themselves; its C core has.
#pragma once

#include <grpc/grpc_security.h>
#include <grpcpp/security/server_credentials.h>

#include <memory>
#include <string>

#include "server/secrets.h"

namespace linetree {

// Both that are given must outlive the server that listens with these, and so must these.
class TlsCredentials final : public grpc::ServerCredentials {
 public:
  // `secrets` has TLS. Clients must show a certificate where it has roots for theirs.
  explicit TlsCredentials(const Secrets& secrets);
  ~TlsCredentials() override;
  TlsCredentials(const TlsCredentials&) = delete;
  TlsCredentials& operator=(const TlsCredentials&) = delete;

  // The processor must not block.
  void SetAuthMetadataProcessor(
      const std::shared_ptr<grpc::AuthMetadataProcessor>& processor) override;

 private:
  int AddPortToServer(const std::string& address, grpc_server* server) override;
  // gRPC asks at every handshake, one at a time.
  static grpc_ssl_certificate_config_reload_status Fetch(
      void* self, grpc_ssl_server_certificate_config** config);

  const Secrets& secrets_;
  std::shared_ptr<const TlsPems> fetched_;  // what gRPC has
  grpc_server_credentials* core_;
};

}  // namespace linetree
