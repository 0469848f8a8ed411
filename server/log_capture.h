// What libraries say goes to the log, too: on their own they write to standard error, whose reader
// may be slow or gone, and callers choose how often.
#pragma once

#include <spdlog/logger.h>

#include <memory>

namespace linetree {

// gRPC's and Protobuf's lines become lines of `log`, errors as warnings and the rest for debugging.
// For the rest of the process, which may have one such log.
void CaptureLibraryLogs(std::shared_ptr<spdlog::logger> log);

}  // namespace linetree
