// Traces as files that other cache simulators read, too.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "core/policy/trace.h"

namespace linetree {

// The layout known as oracleGeneral: records of 24 bytes without header, little-endian, packed,
//   uint32 clock time, uint64 object, uint32 bytes, int64 next access of the object
// where the last is the record's number, from 0, and -1 if there is none. The clock counts frames.
inline constexpr uint64_t kTraceRecordBytes = 24;

// Rebuild costs stand in a file of their own beside it, a float32 in ns for each record.
std::string TraceCostPath(const std::string& path);

// Both files, each whole or not at all; the events must be linked.
absl::Status WriteTrace(const Trace& trace, const std::string& path);

// INVALID_ARGUMENT with file and record for what is cut short or contradicts itself, NOT_FOUND
// where there is no trace. Where there is no file of costs, each event costs 1. Next accesses that
// are numbered from 1 and, for none, the largest int64 are understood as well.
absl::StatusOr<Trace> ReadTrace(const std::string& path);

}  // namespace linetree
