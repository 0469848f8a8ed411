#include "core/io/nff_tokens.h"

#include <cmath>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "core/scene/make_shape.h"

namespace linetree {
namespace {

// Longer tokens are cut short in messages.
constexpr size_t kShownCharacters = 40;

bool IsSpace(char c) { return absl::ascii_isspace(static_cast<unsigned char>(c)); }

}  // namespace

std::optional<double> NumberIn(const NffToken& token) {
  double value = 0;
  if (absl::SimpleAtod(token.text, &value)) return value;
  return std::nullopt;
}

NffTokens::NffTokens(absl::string_view text, std::string file_name)
    : text_(text), file_name_(std::move(file_name)) {
  Scan();
}

void NffTokens::Step() {
  if (text_[offset_] == '\n') {
    ++position_.line;
    position_.column = 1;
  } else {
    ++position_.column;
  }
  ++offset_;
}

void NffTokens::Scan() {
  while (offset_ < text_.size() && (IsSpace(text_[offset_]) || text_[offset_] == '#')) {
    if (text_[offset_] != '#') {
      Step();
      continue;
    }
    while (offset_ < text_.size() && text_[offset_] != '\n') Step();
  }
  token_.position = position_;
  const size_t start = offset_;
  while (offset_ < text_.size() && !IsSpace(text_[offset_]) && text_[offset_] != '#') Step();
  token_.text = text_.substr(start, offset_ - start);
}

NffToken NffTokens::Next() {
  const NffToken token = token_;
  Scan();
  return token;
}

absl::StatusOr<double> NffTokens::Number(absl::string_view what) {
  const auto value = NumberIn(token_);
  if (!value) return Expected(absl::StrCat("a number for ", what), token_);
  if (!(std::abs(*value) <= kMaxMagnitude)) {
    return Expected(absl::StrCat("a finite number of magnitude <= ", kMaxMagnitude, " for ", what),
                    token_);
  }
  Next();
  return *value;
}

absl::StatusOr<int> NffTokens::Count(absl::string_view what, uint64_t limit) {
  int count = 0;
  if (!absl::SimpleAtoi(token_.text, &count) || count < 0) {
    return Expected(absl::StrCat("a whole number for ", what), token_);
  }
  if (static_cast<uint64_t>(count) > limit) {
    return absl::ResourceExhaustedError(
        Error(token_, absl::StrCat("expected at most ", limit, " for ", what, ", got ", count))
            .message());
  }
  Next();
  return count;
}

absl::Status NffTokens::Error(const NffToken& at, absl::string_view message) const {
  return absl::InvalidArgumentError(
      absl::StrCat(file_name_, ":", at.position.line, ":", at.position.column, ": ", message));
}

absl::Status NffTokens::Expected(absl::string_view what, const NffToken& got) const {
  const std::string found =
      got.IsEnd() ? "the end of the file"
                  : absl::StrCat("'", absl::CHexEscape(got.text.substr(0, kShownCharacters)), "'");
  return Error(got, absl::StrCat("expected ", what, ", got ", found));
}

}  // namespace linetree
