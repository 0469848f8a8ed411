#include "server/resume_token.h"

#include <algorithm>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "core/io/wire.h"

namespace linetree {
namespace {

constexpr size_t kSessionDigits = 32;

}  // namespace

std::string ToText(const ResumeToken& token) {
  return absl::StrCat(token.session, "-", token.frames);
}

absl::StatusOr<ResumeToken> ParseResumeToken(absl::string_view text, absl::string_view path) {
  ResumeToken token{std::string(text.substr(0, kSessionDigits))};
  const bool is_session = std::all_of(token.session.begin(), token.session.end(), [](char c) {
    return absl::ascii_isxdigit(static_cast<unsigned char>(c));
  });
  if (is_session && text.size() > kSessionDigits && text[kSessionDigits] == '-' &&
      absl::SimpleAtoi(text.substr(kSessionDigits + 1), &token.frames) && ToText(token) == text) {
    return token;
  }
  return absl::InvalidArgumentError(
      absl::StrCat(path, ": expected the token of a Farewell, got ", Quoted(text)));
}

}  // namespace linetree
