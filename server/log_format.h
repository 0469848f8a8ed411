// Lines of the log: one a message, for people ("text") or for programs ("json").
//
//   2026-11-22T10:11:12.345Z info  call rpc=GetStats code=OK ms=0.31
//   {"time":"2026-11-22T10:11:12.345Z","level":"info","message":"call","rpc":"GetStats", ...}
#pragma once

#include <spdlog/formatter.h>

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace linetree {

enum class LogFormat { kText, kJson };

// While it lives, what this thread logs carries these fields. One inside another hides it.
class LogFields {
 public:
  using Fields = std::vector<std::pair<std::string_view, std::string>>;

  explicit LogFields(Fields fields) : fields_(std::move(fields)), outer_(innermost) {
    innermost = this;
  }
  ~LogFields() { innermost = outer_; }
  LogFields(const LogFields&) = delete;
  LogFields& operator=(const LogFields&) = delete;

  // Of this thread; empty when there are none.
  static const Fields& Current();

 private:
  static thread_local const LogFields* innermost;

  const Fields fields_;
  const LogFields* const outer_;
};

// No message, whatever it holds, makes more than one line, or a line of JSON that is none.
std::unique_ptr<spdlog::formatter> MakeLogFormatter(LogFormat format);

}  // namespace linetree
