#include "server/tokens.h"

#include <openssl/crypto.h>
#include <openssl/sha.h>

#include <algorithm>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "core/io/read_file.h"

namespace linetree {
namespace {

constexpr size_t kMinTokenBytes = 16;
constexpr size_t kMaxTokenBytes = 256;
constexpr uint64_t kMaxTokenFileBytes = uint64_t{1} << 20;

absl::Status Bad(const std::string& file_name, size_t line, absl::string_view expected) {
  return absl::InvalidArgumentError(absl::StrCat(file_name, ":", line, ": expected ", expected));
}

std::optional<Role> ParseRole(absl::string_view name) {
  for (const Role role : {Role::kViewer, Role::kAdmin}) {
    if (name == RoleName(role)) return role;
  }
  return std::nullopt;
}

bool IsToken(absl::string_view text) {
  return text.size() >= kMinTokenBytes && text.size() <= kMaxTokenBytes &&
         std::all_of(text.begin(), text.end(),
                     [](char c) { return absl::ascii_isgraph(static_cast<unsigned char>(c)); });
}

}  // namespace

absl::string_view RoleName(Role role) { return role == Role::kAdmin ? "admin" : "viewer"; }

Tokens::Digest Tokens::Hash(absl::string_view text) {
  Digest digest;
  SHA256(reinterpret_cast<const unsigned char*>(text.data()), text.size(), digest.data());
  return digest;
}

absl::StatusOr<Tokens> Tokens::Parse(absl::string_view text, const std::string& file_name) {
  Tokens tokens;
  size_t number = 0;
  for (absl::string_view line : absl::StrSplit(text, '\n')) {
    ++number;
    line = line.substr(0, line.find('#'));
    const std::vector<absl::string_view> words =
        absl::StrSplit(line, absl::ByAnyChar(" \t\r"), absl::SkipEmpty());
    if (words.empty()) continue;
    const auto role = ParseRole(words[0]);
    if (!role || words.size() != 2) {
      return Bad(file_name, number, "'viewer TOKEN' or 'admin TOKEN'");
    }
    if (!IsToken(words[1])) {
      return Bad(file_name, number,
                 absl::StrCat("a token of ", kMinTokenBytes, " to ", kMaxTokenBytes,
                              " printable characters of ASCII"));
    }
    if (tokens.RoleOf(words[1])) return Bad(file_name, number, "a token that has not come before");
    tokens.entries_.push_back({Hash(words[1]), *role});
  }
  if (tokens.entries_.empty()) return Bad(file_name, number, "at least one line 'admin TOKEN'");
  return tokens;
}

absl::StatusOr<Tokens> Tokens::Read(const std::string& path) {
  const auto text = ReadFileAtMost(path, kMaxTokenFileBytes);
  if (!text.ok()) return text.status();
  return Parse(*text, path);
}

std::optional<Role> Tokens::RoleOf(absl::string_view token) const {
  const Digest digest = Hash(token);
  std::optional<Role> found;
  for (const Entry& entry : entries_) {
    if (CRYPTO_memcmp(entry.digest.data(), digest.data(), digest.size()) == 0) found = entry.role;
  }
  return found;
}

}  // namespace linetree
