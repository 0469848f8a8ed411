// What an audit counts, and how counts are summed.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

namespace linetree {

// How queries were chosen.
enum class QueryKind {
  kFrame,    // pixels of frames, cold and warm
  kRandom,   // rays at random
  kLattice,  // rays at corners and edges
  kClimb,    // rays moved towards larger errors
};
inline constexpr int kQueryKinds = 4;
inline constexpr std::array<std::string_view, kQueryKinds> kQueryKindNames = {"frame", "random",
                                                                              "lattice", "climb"};

struct AuditTally {
  uint64_t queries = 0;
  uint64_t hits = 0;        // of the queries: not the background
  uint64_t from_cells = 0;  // of the hits: not traced
  uint64_t shadow_rays = 0;
  uint64_t listed_shadow_rays = 0;  // answered without a search of the scene
  uint64_t equal = 0;               // to the classical answer, bit for bit
  uint64_t violations = 0;
  double max_error_over_allowed = 0;

  AuditTally& operator+=(const AuditTally& o) {
    queries += o.queries;
    hits += o.hits;
    from_cells += o.from_cells;
    shadow_rays += o.shadow_rays;
    listed_shadow_rays += o.listed_shadow_rays;
    equal += o.equal;
    violations += o.violations;
    max_error_over_allowed = std::max(max_error_over_allowed, o.max_error_over_allowed);
    return *this;
  }
  bool operator==(const AuditTally&) const = default;
};

}  // namespace linetree
