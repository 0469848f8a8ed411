// Replays a trace: what a policy, the clairvoyant one among them, would have made of it.
#pragma once

#include <string_view>

#include "absl/status/statusor.h"
#include "core/policy/trace.h"

namespace linetree {

// Belady's: evicts what is used last from now on. Known to simulations only.
inline constexpr std::string_view kBelady = "belady";

struct SimulationOptions {
  uint64_t budget_bytes = 0;
  // Every item counts as one byte; the budget is a number of items.
  bool ignores_size = false;
  // The policy is told what is used within so many frames, as by an owner who knew the paths that
  // far ahead (SetForesight, ExpectUse); 0: nothing.
  uint32_t foresight_frames = 0;
};

struct SimulationResult {
  uint64_t requests = 0, hits = 0, evictions = 0;
  uint64_t requested_bytes = 0, hit_bytes = 0;
  double rebuild_ns = 0;  // of all misses

  double HitRatio() const { return Share(hits, requests); }
  double ByteHitRatio() const { return Share(hit_bytes, requested_bytes); }

 private:
  static double Share(uint64_t part, uint64_t all) {
    return all == 0 ? 0 : static_cast<double>(part) / static_cast<double>(all);
  }
};

// Every event that does not find its item is a miss and brings it in, after the policy has evicted
// as much as that takes; what is larger than the whole budget is not kept. An item that comes back
// in another size or at another cost counts as the same and keeps what it came in with. `name` is
// one of AllPolicies or kBelady; INVALID_ARGUMENT for another. Events must be linked (LinkTrace).
absl::StatusOr<SimulationResult> Simulate(const Trace& trace, std::string_view name,
                                          const SimulationOptions& options);

}  // namespace linetree
