#include "server/secrets.h"

#include <utility>

#include "absl/strings/str_cat.h"

namespace linetree {

absl::StatusOr<std::unique_ptr<Secrets>> Secrets::Read(const TlsFiles& tls_files,
                                                       const std::string& token_file) {
  std::unique_ptr<Secrets> secrets(new Secrets(tls_files, token_file));
  const auto [tls, tokens] = secrets->Reload();
  if (!tls.ok()) return tls;
  if (!tokens.ok()) return tokens;
  return secrets;
}

std::shared_ptr<const TlsPems> Secrets::tls() const {
  const std::lock_guard lock(mutex_);
  return tls_;
}

std::shared_ptr<const Tokens> Secrets::tokens() const {
  const std::lock_guard lock(mutex_);
  return tokens_;
}

Secrets::Reloaded Secrets::Reload() { return {ReloadTls(), ReloadTokens()}; }

absl::Status Secrets::ReloadTls() {
  if (tls_files_.cert.empty()) return absl::OkStatus();
  auto pems = ReadTls(tls_files_);
  if (!pems.ok()) return pems.status();
  auto fresh = std::make_shared<const TlsPems>(*std::move(pems));
  const std::lock_guard lock(mutex_);
  tls_ = std::move(fresh);
  return absl::OkStatus();
}

absl::Status Secrets::ReloadTokens() {
  if (token_file_.empty()) return absl::OkStatus();
  auto tokens = Tokens::Read(token_file_);
  if (!tokens.ok()) {
    return absl::InvalidArgumentError(absl::StrCat("--token-file: ", tokens.status().message()));
  }
  auto fresh = std::make_shared<const Tokens>(*std::move(tokens));
  const std::lock_guard lock(mutex_);
  tokens_ = std::move(fresh);
  return absl::OkStatus();
}

}  // namespace linetree
