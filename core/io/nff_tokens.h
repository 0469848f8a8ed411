// NFF as a stream of tokens: white space separates, `#` starts a comment that ends with the line.
// Line ends mean nothing else, because files in use break records where they like.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace linetree {

// Both count from 1.
struct TextPosition {
  int line = 1;
  int column = 1;
};

struct NffToken {
  absl::string_view text;  // empty at the end of the file
  TextPosition position;
  bool IsEnd() const { return text.empty(); }
};

// The number that a token spells, if it does (NaN and infinity are numbers here; the rules on
// values come later).
std::optional<double> NumberIn(const NffToken& token);

class NffTokens {
 public:
  // Keeps a reference to the text.
  NffTokens(absl::string_view text, std::string file_name);

  const NffToken& Peek() const { return token_; }
  NffToken Next();

  // The next token as a finite number of magnitude at most kMaxMagnitude. Errors:
  // "file:line:column: expected WHAT, got 'TEXT'".
  absl::StatusOr<double> Number(absl::string_view what);
  // A whole number in [0, limit].
  absl::StatusOr<int> Count(absl::string_view what, uint64_t limit);

  absl::Status Error(const NffToken& at, absl::string_view message) const;
  absl::Status Expected(absl::string_view what, const NffToken& got) const;

 private:
  void Scan();
  void Step();

  absl::string_view text_;
  std::string file_name_;
  size_t offset_ = 0;
  TextPosition position_;
  NffToken token_;
};

}  // namespace linetree
