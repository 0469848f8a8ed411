// Recorded traces: whatever the files hold, it is a trace in which everything adds up, or an error.
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "core/io/trace_file.h"
#include "core/math/check.h"
#include "tests/fuzz/fuzz.h"

namespace linetree::fuzz {
namespace {

// In memory where that is to be had; of this process.
const std::string& ThePath() {
  static const std::string path = [] {
    const std::filesystem::path shared = "/dev/shm";
    const auto folder =
        std::filesystem::is_directory(shared) ? shared : std::filesystem::temp_directory_path();
    return (folder / ("linetree-trace-fuzz-" + std::to_string(getpid()))).string();
  }();
  static const struct Remover {
    ~Remover() {
      std::filesystem::remove(path);
      std::filesystem::remove(TraceCostPath(path));
    }
    const std::string& path;
  } remover{path};
  return path;
}

void Write(const std::string& path, std::string_view bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

std::string Read(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

}  // namespace

// The first byte of an input says how many 28ths of the rest are the costs, 0 that there are none.
std::vector<std::string> Seeds() {
  Trace trace;
  for (uint32_t i = 0; i < 40; ++i) {
    trace.push_back({.time = i / 5, .id = i % 7, .bytes = 100 + i, .rebuild_ns = 1.5f});
  }
  LinkTrace(trace);
  LT_CHECK(WriteTrace(trace, ThePath()).ok());
  return {'\x04' + Read(ThePath()) + Read(TraceCostPath(ThePath())), '\0' + Read(ThePath()),
          '\x04' + Read(ThePath())};
}

}  // namespace linetree::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace linetree;  // NOLINT(google-build-using-namespace)
  if (size == 0) return 0;
  const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  const size_t costs = bytes.size() * (data[0] % 29u) / 28;
  const std::string& path = fuzz::ThePath();
  fuzz::Write(path, bytes.substr(0, bytes.size() - costs));
  if (costs > 0) {
    fuzz::Write(TraceCostPath(path), bytes.substr(bytes.size() - costs));
  } else {
    std::filesystem::remove(TraceCostPath(path));
  }
  const auto trace = ReadTrace(path);
  LT_CHECK(trace.ok() || !trace.status().message().empty());
  if (!trace.ok()) return 0;
  Trace linked = *trace;
  LinkTrace(linked);
  for (size_t i = 0; i < linked.size(); ++i) {
    const TraceEvent& event = (*trace)[i];
    LT_CHECK(event.next == linked[i].next);
    LT_CHECK(i == 0 || event.time >= linked[i - 1].time);
    LT_CHECK(std::isfinite(event.rebuild_ns) && event.rebuild_ns > 0);
  }
  WorkingSetOf(*trace);
  return 0;
}
