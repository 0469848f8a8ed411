// Certificates and keys of the server, from files.
#pragma once

#include <string>

#include "absl/status/statusor.h"

struct ssl_st;  // OpenSSL's SSL

namespace linetree {

struct TlsFiles {
  std::string cert;       // its certificate, then those that lead to its root; PEM
  std::string key;        // of that certificate; PEM, without a password
  std::string client_ca;  // roots of the clients' certificates; PEM; empty: clients need none
};

// What the files hold.
struct TlsPems {
  std::string cert;
  std::string key;
  std::string client_ca;
};

// Reads and checks them: INVALID_ARGUMENT naming flag and file for what is no certificate or key in
// PEM, for a key that is not the certificate's, and for what cannot be read.
absl::StatusOr<TlsPems> ReadTls(const TlsFiles& files);

// For one connection by OpenSSL: shows this certificate, with those that follow it. False when
// OpenSSL does not take them.
bool ShowCertificate(const TlsPems& pems, ssl_st* connection);

}  // namespace linetree
