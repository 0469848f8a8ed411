#include "server/tls_credentials.h"

#include <grpc/grpc.h>
#include <grpc/slice.h>

#include "core/math/check.h"

namespace linetree {
namespace {

using Processor = std::shared_ptr<grpc::AuthMetadataProcessor>;

grpc::string_ref Text(const grpc_slice& slice) {
  return {reinterpret_cast<const char*>(GRPC_SLICE_START_PTR(slice)), GRPC_SLICE_LENGTH(slice)};
}

// Between the C core's interface and that of a processor, of which ours neither take anything away
// from the metadata nor add to them.
void Process(void* state, grpc_auth_context*, const grpc_metadata* metadata, size_t count,
             grpc_process_auth_metadata_done_cb done, void* user_data) {
  grpc::AuthMetadataProcessor::InputMetadata input;
  for (size_t i = 0; i < count; ++i) input.emplace(Text(metadata[i].key), Text(metadata[i].value));
  grpc::AuthMetadataProcessor::OutputMetadata consumed, response;
  const grpc::Status status =
      (*static_cast<Processor*>(state))->Process(input, nullptr, &consumed, &response);
  LT_CHECK(consumed.empty() && response.empty());
  done(user_data, nullptr, 0, nullptr, 0, static_cast<grpc_status_code>(status.error_code()),
       status.error_message().c_str());
}

}  // namespace

TlsCredentials::TlsCredentials(const Secrets& secrets) : secrets_(secrets) {
  const auto tls = secrets.tls();
  LT_CHECK(tls != nullptr);
  core_ = grpc_ssl_server_credentials_create_with_options(
      grpc_ssl_server_credentials_create_options_using_config_fetcher(
          tls->client_ca.empty() ? GRPC_SSL_DONT_REQUEST_CLIENT_CERTIFICATE
                                 : GRPC_SSL_REQUEST_AND_REQUIRE_CLIENT_CERTIFICATE_AND_VERIFY,
          &Fetch, this));
}

TlsCredentials::~TlsCredentials() { grpc_server_credentials_release(core_); }

void TlsCredentials::SetAuthMetadataProcessor(const Processor& processor) {
  grpc_server_credentials_set_auth_metadata_processor(
      core_, {&Process, [](void* state) { delete static_cast<Processor*>(state); },
              new Processor(processor)});
}

int TlsCredentials::AddPortToServer(const std::string& address, grpc_server* server) {
  return grpc_server_add_http2_port(server, address.c_str(), core_);
}

grpc_ssl_certificate_config_reload_status TlsCredentials::Fetch(
    void* self, grpc_ssl_server_certificate_config** config) {
  auto& credentials = *static_cast<TlsCredentials*>(self);
  const auto tls = credentials.secrets_.tls();
  if (tls == credentials.fetched_) return GRPC_SSL_CERTIFICATE_CONFIG_RELOAD_UNCHANGED;
  const grpc_ssl_pem_key_cert_pair pair{tls->key.c_str(), tls->cert.c_str()};
  // gRPC 1.51 insists on roots even where no client is asked for a certificate: then they are not
  // used, and any will do.
  const std::string& roots = tls->client_ca.empty() ? tls->cert : tls->client_ca;
  *config = grpc_ssl_server_certificate_config_create(roots.c_str(), &pair, 1);
  credentials.fetched_ = tls;
  return GRPC_SSL_CERTIFICATE_CONFIG_RELOAD_NEW;
}

}  // namespace linetree
