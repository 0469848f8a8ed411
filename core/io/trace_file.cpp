#include "core/io/trace_file.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>

#include "absl/strings/str_cat.h"
#include "core/io/atomic_file.h"
#include "core/io/read_file.h"

namespace linetree {
namespace {

static_assert(std::endian::native == std::endian::little, "records are copied as they are");

constexpr uint64_t kMostTraceBytes = uint64_t{16} << 30;

template <class T>
void Put(std::string& out, T value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof(value));
}
template <class T>
T Take(const char*& at) {
  T value;
  std::memcpy(&value, at, sizeof(value));
  at += sizeof(value);
  return value;
}

absl::Status Odd(const std::string& path, size_t record, const std::string& what) {
  return absl::InvalidArgumentError(absl::StrCat(path, ": record ", record, ": ", what));
}

absl::StatusOr<Trace> ReadEvents(const std::string& path) {
  const absl::StatusOr<std::string> bytes = ReadFileAtMost(path, kMostTraceBytes);
  if (!bytes.ok()) return bytes.status();
  if (bytes->size() % kTraceRecordBytes != 0) {
    return absl::InvalidArgumentError(
        absl::StrCat(path, ": expected records of ", kTraceRecordBytes, " bytes, found ",
                     bytes->size(), " bytes: the last record is cut short"));
  }
  Trace trace(bytes->size() / kTraceRecordBytes);
  const char* at = bytes->data();
  for (TraceEvent& event : trace) {
    event.time = Take<uint32_t>(at);
    event.id = Take<uint64_t>(at);
    event.bytes = Take<uint32_t>(at);
    event.next = Take<int64_t>(at);
  }
  return trace;
}

// Against `linked`, the same events with their true links.
absl::Status CheckEvents(const Trace& trace, const Trace& linked, const std::string& path) {
  for (size_t i = 0; i < trace.size(); ++i) {
    const TraceEvent& event = trace[i];
    if (event.bytes == 0) return Odd(path, i, "expected a size of at least 1 byte, found 0");
    if (i > 0 && event.time < trace[i - 1].time) {
      return Odd(
          path, i,
          absl::StrCat("expected a time of at least ", trace[i - 1].time, ", found ", event.time));
    }
    const bool is_last = event.next < 0 || event.next == std::numeric_limits<int64_t>::max();
    const int64_t next = is_last ? kNeverAgain : event.next;
    const int64_t found = linked[i].next;
    if (next == found || (!is_last && found != kNeverAgain && next == found + 1)) continue;
    if (!is_last && next >= static_cast<int64_t>(trace.size())) {
      return Odd(path, i,
                 absl::StrCat("its object is next used by record ", next, ", there are ",
                              trace.size(), ": the file is cut short"));
    }
    return Odd(
        path, i,
        absl::StrCat("expected ", found, " as the next use of its object, found ", event.next));
  }
  return absl::OkStatus();
}

absl::Status ReadCosts(const std::string& path, Trace& trace) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return absl::OkStatus();
  const absl::StatusOr<std::string> bytes = ReadFileAtMost(path, kMostTraceBytes);
  if (!bytes.ok()) return bytes.status();
  if (bytes->size() != trace.size() * sizeof(float)) {
    return absl::InvalidArgumentError(
        absl::StrCat(path, ": expected ", trace.size() * sizeof(float), " bytes, 4 for each of ",
                     trace.size(), " records of the trace, found ", bytes->size()));
  }
  const char* at = bytes->data();
  for (size_t i = 0; i < trace.size(); ++i) {
    trace[i].rebuild_ns = Take<float>(at);
    if (!std::isfinite(trace[i].rebuild_ns) || trace[i].rebuild_ns <= 0) {
      return Odd(path, i, absl::StrCat("expected a cost above 0, found ", trace[i].rebuild_ns));
    }
  }
  return absl::OkStatus();
}

}  // namespace

std::string TraceCostPath(const std::string& path) { return path + ".cost"; }

absl::Status WriteTrace(const Trace& trace, const std::string& path) {
  std::string events, costs;
  events.reserve(trace.size() * kTraceRecordBytes);
  costs.reserve(trace.size() * sizeof(float));
  for (const TraceEvent& event : trace) {
    Put(events, event.time);
    Put(events, event.id);
    Put(events, event.bytes);
    Put(events, event.next);
    Put(costs, event.rebuild_ns);
  }
  // Costs first: who finds a new trace finds its costs.
  if (auto s = WriteFileAtomically(TraceCostPath(path), costs); !s.ok()) return s;
  return WriteFileAtomically(path, events);
}

absl::StatusOr<Trace> ReadTrace(const std::string& path) {
  absl::StatusOr<Trace> trace = ReadEvents(path);
  if (!trace.ok()) return trace.status();
  Trace linked = *trace;
  LinkTrace(linked);
  if (auto s = CheckEvents(*trace, linked, path); !s.ok()) return s;
  if (auto s = ReadCosts(TraceCostPath(path), linked); !s.ok()) return s;
  return linked;
}

}  // namespace linetree
