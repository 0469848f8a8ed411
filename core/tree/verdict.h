// What a judge says of a cell (paper sections 4 and 5). Values are those of the wire format.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace linetree {

enum class Verdict : uint8_t {
  kUntried = 0,     // no cell was tried
  kCertified = 1,   // the cell may answer
  kGap = 2,         // extremal rays meet different things
  kSelfShadow = 3,  // extremal rays differ in facing a light
  kBlocker = 4,     // an object may cut some ray, or extremal rays differ in shadow
  kFunnel = 5,      // a ray of the bundle leaves a denser medium
  kPeak = 6,        // a highlight may peak inside
  kEpsilon = 7,     // extremal radiances differ too much
};
inline constexpr int kVerdictCount = 8;

// Names as they stand in statistics and on the wire.
inline constexpr std::array<std::string_view, kVerdictCount> kVerdictNames = {
    "untried", "certified", "gap", "self_shadow", "blocker", "funnel", "peak", "epsilon"};

inline constexpr std::string_view VerdictName(Verdict v) {
  return kVerdictNames[static_cast<size_t>(v)];
}

}  // namespace linetree
