// Who may call: tokens and the roles that they carry.
//
// Of a token only its SHA-256 is kept. What a caller shows is hashed and compared with all of them,
// byte for byte to the end, so that the time of an answer says nothing about them.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace linetree {

enum class Role {
  kViewer,  // sees scenes
  kAdmin,   // changes what is loaded, too
};
absl::string_view RoleName(Role role);

class Tokens {
 public:
  // Lines "viewer TOKEN" or "admin TOKEN"; empty lines and what follows # are left out. A token is
  // 16 to 256 printable characters of ASCII without spaces. INVALID_ARGUMENT "file:line: ..." for
  // anything else, for a token that comes twice, and for a file without any.
  static absl::StatusOr<Tokens> Parse(absl::string_view text, const std::string& file_name);
  // NOT_FOUND for a file that cannot be read, else as Parse.
  static absl::StatusOr<Tokens> Read(const std::string& path);

  // Nothing for an unknown token.
  std::optional<Role> RoleOf(absl::string_view token) const;

 private:
  using Digest = std::array<unsigned char, 32>;
  struct Entry {
    Digest digest;
    Role role;
  };
  static Digest Hash(absl::string_view text);

  std::vector<Entry> entries_;
};

}  // namespace linetree
