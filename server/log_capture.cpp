#include "server/log_capture.h"

#include <google/protobuf/stubs/logging.h>
#include <grpc/support/log.h>

#include <string>

namespace linetree {
namespace {

// Never destroyed: libraries log until the process ends.
std::shared_ptr<spdlog::logger>& Captured() {
  static auto* const log = new std::shared_ptr<spdlog::logger>;
  return *log;
}

void Log(bool is_error, const char* library, const std::string& message) {
  Captured()->log(is_error ? spdlog::level::warn : spdlog::level::debug, "{}: {}", library,
                  message);
}

}  // namespace

void CaptureLibraryLogs(std::shared_ptr<spdlog::logger> log) {
  Captured() = std::move(log);
  gpr_set_log_function([](gpr_log_func_args* args) {
    Log(args->severity == GPR_LOG_SEVERITY_ERROR, "gRPC", args->message);
  });
  google::protobuf::SetLogHandler(
      [](google::protobuf::LogLevel level, const char*, int, const std::string& message) {
        Log(level >= google::protobuf::LOGLEVEL_ERROR, "Protobuf", message);
      });
}

}  // namespace linetree
