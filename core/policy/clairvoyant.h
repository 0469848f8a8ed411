// What no policy can do better than, even if it knew the future.
#pragma once

#include "core/policy/trace.h"

namespace linetree {

// Rebuild cost of a trace, in ns, that no policy falls below which never holds more than the budget
// between two events, whatever the items' sizes and costs and whether or not it keeps what it
// fetches.
//
// Proof. A hit at an event needs the item to be held from its last event on. So a policy chooses a
// set H of such pairs of events; its cost is the sum C of all events' costs less those of the
// second events of H, and between any two events the bytes of the pairs of H that span that moment
// are at most B. Take any moments t of all those and any prices p(t) >= 0. Then
//   saved(H) <= saved(H) + sum_t p(t) (B - held(H, t))
//            =  B sum_t p(t) + sum_(h in H) (cost(h) - bytes(h) sum_(t in h) p(t))
//            <= B sum_t p(t) + sum_(all pairs h) max(0, cost(h) - bytes(h) sum_(t in h) p(t)),
// which does not depend on H: C less the last line bounds every policy's cost from below (weak
// duality of the relaxation to fractions; with one price for all moments it is PFOO-L of Berger,
// Beckmann, Harchol-Balter: Practical Bounds on Optimal Caching with Variable Object Sizes, 2018).
// Which prices are chosen changes how good the bound is, not whether it is one; they are improved
// step by step. First events cannot be saved, so the bound is never below their cost.
//
// Moments are those at which the clock changes, so that a frame has one, thinned out to 4096; for a
// trace of at most 4096 events, all. An item that changes counts with the least bytes that it
// had up to the pair's first event, and with the cost of the second one. Seconds for a million
// events.
double LeastRebuildCost(const Trace& trace, uint64_t budget_bytes, bool ignores_size = false);

}  // namespace linetree
