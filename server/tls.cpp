#include "server/tls.h"

#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/ssl.h>
#include <openssl/x509.h>

#include <memory>

#include "absl/strings/str_cat.h"
#include "core/io/read_file.h"

namespace linetree {
namespace {

constexpr uint64_t kMaxFileBytes = uint64_t{1} << 20;

struct Free {
  void operator()(BIO* bio) const { BIO_free(bio); }
  void operator()(X509* cert) const { X509_free(cert); }
  void operator()(EVP_PKEY* key) const { EVP_PKEY_free(key); }
};
template <class T>
using Owned = std::unique_ptr<T, Free>;

Owned<BIO> Reader(const std::string& pem) {
  return Owned<BIO>(BIO_new_mem_buf(pem.data(), static_cast<int>(pem.size())));
}

// OpenSSL would ask on the terminal.
int NoPassword(char*, int, int, void*) { return 0; }

Owned<X509> FirstCertificate(const std::string& pem) {
  return Owned<X509>(PEM_read_bio_X509(Reader(pem).get(), nullptr, NoPassword, nullptr));
}

absl::Status Bad(absl::string_view flag, absl::string_view file, absl::string_view expected) {
  ERR_clear_error();
  return absl::InvalidArgumentError(absl::StrCat(flag, ": ", file, ": expected ", expected));
}

absl::StatusOr<std::string> Read(absl::string_view flag, const std::string& path) {
  auto text = ReadFileAtMost(path, kMaxFileBytes);
  if (text.ok()) return text;
  return absl::InvalidArgumentError(absl::StrCat(flag, ": ", text.status().message()));
}

absl::StatusOr<std::string> ReadCertificates(absl::string_view flag, const std::string& path) {
  auto pem = Read(flag, path);
  if (pem.ok() && FirstCertificate(*pem) == nullptr) return Bad(flag, path, "a certificate in PEM");
  return pem;
}

}  // namespace

absl::StatusOr<TlsPems> ReadTls(const TlsFiles& files) {
  TlsPems pems;
  auto cert = ReadCertificates("--tls-cert", files.cert);
  if (!cert.ok()) return cert.status();
  auto key = Read("--tls-key", files.key);
  if (!key.ok()) return key.status();
  const Owned<EVP_PKEY> parsed(
      PEM_read_bio_PrivateKey(Reader(*key).get(), nullptr, NoPassword, nullptr));
  if (parsed == nullptr) return Bad("--tls-key", files.key, "a key in PEM, without a password");
  if (X509_check_private_key(FirstCertificate(*cert).get(), parsed.get()) != 1) {
    return Bad("--tls-key", files.key, absl::StrCat("the key of ", files.cert));
  }
  pems.cert = *std::move(cert);
  pems.key = *std::move(key);
  if (files.client_ca.empty()) return pems;
  auto client_ca = ReadCertificates("--tls-client-ca", files.client_ca);
  if (!client_ca.ok()) return client_ca.status();
  pems.client_ca = *std::move(client_ca);
  return pems;
}

bool ShowCertificate(const TlsPems& pems, ssl_st* connection) {
  const Owned<BIO> reader = Reader(pems.cert);
  const auto next = [&] {
    return Owned<X509>(PEM_read_bio_X509(reader.get(), nullptr, NoPassword, nullptr));
  };
  const Owned<X509> own = next();
  const Owned<EVP_PKEY> key(
      PEM_read_bio_PrivateKey(Reader(pems.key).get(), nullptr, NoPassword, nullptr));
  if (SSL_use_certificate(connection, own.get()) != 1 ||
      SSL_use_PrivateKey(connection, key.get()) != 1) {
    return false;
  }
  SSL_clear_chain_certs(connection);
  while (const Owned<X509> issuer = next()) {
    if (SSL_add1_chain_cert(connection, issuer.get()) != 1) return false;
  }
  ERR_clear_error();  // the end of the text is one
  return true;
}

}  // namespace linetree
