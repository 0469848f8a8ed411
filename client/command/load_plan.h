// Who flies what in a load test, and when: plans only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace linetree {

// The part of a path that one client flies, round and round. Its i-th frame shows the path's camera
// (first + i % frames) % (cameras of the path).
struct FlightPiece {
  size_t path = 0;
  size_t first = 0;
  size_t frames = 0;
};

// One piece for each client. `path_frames` are the cameras of each path, at least one; clients take
// the paths in turn.
//
// Without `overlap` everybody flies the whole path, and the n clients of a path start evenly spread
// over it. With it each flies one piece, the pieces are equally long and cover the path together,
// and neighbours share this share of theirs: at 0 they join end to end, at 1 everybody flies the
// whole path from its first camera on.
std::vector<FlightPiece> PlanPieces(size_t clients, const std::vector<size_t>& path_frames,
                                    std::optional<double> overlap);

enum class ArrivalKind { kFixed, kPoisson };

struct ArrivalOptions {
  double rate = 1;  // frames per second
  ArrivalKind kind = ArrivalKind::kFixed;
  uint64_t seed = 1;  // of kPoisson
};

// When frames shall begin, in seconds from the first, which is at 0: at most `most`, all before
// until_s. Equal steps, or a Poisson process.
std::vector<double> PlanArrivals(const ArrivalOptions& options, size_t most, double until_s);

}  // namespace linetree
