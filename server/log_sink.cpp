#include "server/log_sink.h"

#include <limits.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <string>

namespace linetree {

// A pipe that is ready takes so many bytes without making the writer wait (POSIX).
constexpr size_t kPieceBytes = PIPE_BUF;

void LogSink::sink_it_(const spdlog::details::log_msg& msg) {
  const auto line_of = [this](const spdlog::details::log_msg& message) {
    spdlog::memory_buf_t buffer;
    formatter_->format(message, buffer);
    return std::string(buffer.data(), buffer.size());
  };
  if (lost_ > reported_) {
    const std::string text = "lines of this log lost: " + std::to_string(lost_ - reported_);
    if (Write(line_of({msg.logger_name, spdlog::level::warn, text}))) reported_ = lost_;
  }
  if (!Write(line_of(msg))) ++lost_;
}

bool LogSink::Write(std::string line) {
  if (in_a_line_) line.insert(0, 1, '\n');
  for (size_t begin = 0; begin < line.size();) {
    pollfd ready{descriptor_, POLLOUT, 0};
    if (poll(&ready, 1, /*timeout_ms=*/0) != 1 || (ready.revents & POLLOUT) == 0) return false;
    const ssize_t written =
        write(descriptor_, line.data() + begin, std::min(kPieceBytes, line.size() - begin));
    if (written <= 0) return false;
    begin += static_cast<size_t>(written);
    in_a_line_ = line[begin - 1] != '\n';
  }
  return true;
}

}  // namespace linetree
