// What the server proves itself by and asks callers for: certificates, key and tokens, out of files
// that may be read anew while it runs.
//
// Thread safety: all methods may be called from any thread.
#pragma once

#include <memory>
#include <mutex>
#include <string>

#include "absl/status/statusor.h"
#include "server/tls.h"
#include "server/tokens.h"

namespace linetree {

class Secrets {
 public:
  // INVALID_ARGUMENT naming the flag, the file and what is wrong with it. Without --tls-cert there
  // is no TLS, without --token-file everybody may do everything; so it stays.
  static absl::StatusOr<std::unique_ptr<Secrets>> Read(const TlsFiles& tls_files,
                                                       const std::string& token_file);

  // Null: there is no TLS.
  std::shared_ptr<const TlsPems> tls() const;
  // Null: nobody is asked.
  std::shared_ptr<const Tokens> tokens() const;

  // Reads the files anew. Where they are bad, with the errors of Read, the old ones stay: of TLS
  // all three, as they belong together, or the tokens.
  struct Reloaded {
    absl::Status tls, tokens;
  };
  Reloaded Reload();

 private:
  Secrets(TlsFiles tls_files, std::string token_file)
      : tls_files_(std::move(tls_files)), token_file_(std::move(token_file)) {}
  absl::Status ReloadTls();
  absl::Status ReloadTokens();

  const TlsFiles tls_files_;
  const std::string token_file_;
  mutable std::mutex mutex_;
  // Guarded by mutex_.
  std::shared_ptr<const TlsPems> tls_;
  std::shared_ptr<const Tokens> tokens_;
};

}  // namespace linetree
