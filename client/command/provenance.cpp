#include "client/command/provenance.h"

#include <cctype>
#include <cstring>
#include <ctime>
#include <fstream>
#include <iterator>
#include <thread>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "core/jet/simd_targets.h"
#include "hwy/highway.h"

namespace linetree {
namespace {

// As Linux says.
std::string Processor() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    const std::pair<std::string, std::string> parts = absl::StrSplit(line, absl::MaxSplits(':', 1));
    if (absl::StartsWith(parts.first, "model name")) {
      return std::string(absl::StripAsciiWhitespace(parts.second));
    }
  }
  return "unknown processor";
}

std::string Quoted(const std::string& word) {
  bool is_plain = !word.empty();
  for (const char c : word) {
    is_plain =
        is_plain && (std::isalnum(static_cast<unsigned char>(c)) || std::strchr("_-./:=,%+@", c));
  }
  if (is_plain) return word;
  return absl::StrCat("'", absl::StrReplaceAll(word, {{"'", "'\\''"}}), "'");
}

std::string OwnCommand() {
  std::ifstream file("/proc/self/cmdline", std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  std::string command;
  for (const absl::string_view word : absl::StrSplit(absl::StripSuffix(text, {"\0", 1}), '\0')) {
    std::string part(word);
    // Where the program lies does not matter.
    if (command.empty()) part = part.substr(part.rfind('/') + 1);
    absl::StrAppend(&command, command.empty() ? "" : " ", Quoted(part));
  }
  return command;
}

std::string WidestTarget() {
  const int64_t targets = hwy::SupportedTargets() & HWY_TARGETS;
  // Wider ones have lower bits.
  return hwy::TargetName(targets & -targets);
}

std::string Now() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  char text[32];
  return {text, std::strftime(text, sizeof(text), "%Y-%m-%d %H:%M", &parts)};
}

}  // namespace

std::string Provenance::ToString() const {
  return absl::StrCat(command, "; ", machine, "; ", date, " UTC; linetree ", version);
}

Provenance ProvenanceOf(std::string command) {
  if (command.empty()) command = OwnCommand();
  const std::string machine = absl::StrCat(Processor(), ", ", std::thread::hardware_concurrency(),
                                           " threads, ", WidestTarget());
  return {std::move(command), machine, Now(), LINETREE_VERSION};
}

nlohmann::json ProvenanceJson(const Provenance& provenance) {
  return {{"command", provenance.command},
          {"machine", provenance.machine},
          {"date", provenance.date},
          {"version", provenance.version}};
}

std::optional<Provenance> ProvenanceFromJson(const nlohmann::json& json) {
  Provenance provenance;
  for (auto& [name, value] : {std::pair("command", &provenance.command),
                              {"machine", &provenance.machine},
                              {"date", &provenance.date},
                              {"version", &provenance.version}}) {
    if (!json.is_object() || !json.contains(name) || !json[name].is_string()) return std::nullopt;
    *value = json[name].get<std::string>();
  }
  return provenance;
}

}  // namespace linetree
