// What a flight that goes on in a new stream brings from the old one. The server keeps nothing for
// it: whoever knows the session may go on with it, and nobody guesses one.
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace linetree {

struct ResumeToken {
  std::string session;  // 32 hexadecimal digits, as RandomId
  uint64_t frames = 0;  // that the flight has had so far
};

std::string ToText(const ResumeToken& token);

// INVALID_ARGUMENT for what ToText never returns; `path` names the field.
absl::StatusOr<ResumeToken> ParseResumeToken(absl::string_view text, absl::string_view path);

}  // namespace linetree
