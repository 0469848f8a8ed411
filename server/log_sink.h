// Where the log goes: a file descriptor that may be full, slow or gone. Then lines are lost and
// counted, and nobody waits; once there is room again, a line says how many were lost.
#pragma once

#include <spdlog/sinks/base_sink.h>

#include <atomic>
#include <cstdint>
#include <mutex>
#include <string>

namespace linetree {

class LogSink final : public spdlog::sinks::base_sink<std::mutex> {
 public:
  // Does not own the descriptor.
  explicit LogSink(int descriptor) : descriptor_(descriptor) {}

  uint64_t lines_lost() const { return lost_; }

 private:
  void sink_it_(const spdlog::details::log_msg& msg) override;
  void flush_() override {}
  // False when it could not be written as a whole.
  bool Write(std::string line);

  const int descriptor_;
  std::atomic<uint64_t> lost_{0};
  // Guarded by the mutex of base_sink.
  uint64_t reported_ = 0;   // of the lost ones
  bool in_a_line_ = false;  // what was written last is not the end of a line
};

}  // namespace linetree
