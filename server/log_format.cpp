#include "server/log_format.h"

#include <chrono>
#include <nlohmann/json.hpp>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/time/time.h"

namespace linetree {

thread_local const LogFields* LogFields::innermost = nullptr;

const LogFields::Fields& LogFields::Current() {
  static const Fields none;
  return innermost == nullptr ? none : innermost->fields_;
}

namespace {

std::string TimeOf(const spdlog::details::log_msg& msg) {
  return absl::FormatTime("%Y-%m-%dT%H:%M:%E3SZ", absl::FromChrono(msg.time), absl::UTCTimeZone());
}

absl::string_view ViewOf(spdlog::string_view_t text) { return {text.data(), text.size()}; }

// As it is, or quoted where a reader could not tell where it ends.
std::string ValueText(const std::string& value) {
  const bool plain = !value.empty() && value.find_first_of(" \"=\\") == std::string::npos;
  const std::string escaped = absl::CHexEscape(value);
  return plain ? escaped : absl::StrCat("\"", escaped, "\"");
}

std::string TextLine(const spdlog::details::log_msg& msg) {
  std::string line =
      absl::StrFormat("%s %-7s %s", TimeOf(msg), ViewOf(spdlog::level::to_string_view(msg.level)),
                      absl::Utf8SafeCHexEscape(ViewOf(msg.payload)));
  for (const auto& [name, value] : LogFields::Current()) {
    absl::StrAppend(&line, " ", std::string(name), "=", ValueText(value));
  }
  return line;
}

std::string JsonLine(const spdlog::details::log_msg& msg) {
  nlohmann::ordered_json json = {
      {"time", TimeOf(msg)},
      {"level", std::string(ViewOf(spdlog::level::to_string_view(msg.level)))},
      {"message", std::string(ViewOf(msg.payload))}};
  for (const auto& [name, value] : LogFields::Current()) json[std::string(name)] = value;
  return json.dump(-1, ' ', /*ensure_ascii=*/true, nlohmann::json::error_handler_t::replace);
}

class Formatter final : public spdlog::formatter {
 public:
  explicit Formatter(LogFormat format) : format_(format) {}

  void format(const spdlog::details::log_msg& msg, spdlog::memory_buf_t& out) override {
    const std::string line = format_ == LogFormat::kJson ? JsonLine(msg) : TextLine(msg);
    out.append(line.data(), line.data() + line.size());
    out.push_back('\n');
  }

  std::unique_ptr<spdlog::formatter> clone() const override {
    return std::make_unique<Formatter>(format_);
  }

 private:
  const LogFormat format_;
};

}  // namespace

std::unique_ptr<spdlog::formatter> MakeLogFormatter(LogFormat format) {
  return std::make_unique<Formatter>(format);
}

}  // namespace linetree
