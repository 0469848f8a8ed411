#include "client/command/load_plan.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "core/math/check.h"

namespace linetree {
namespace {

// A piece of n that neighbours share by `overlap` is as long as the path, divided by this.
double PiecesEndToEnd(size_t n, double overlap) {
  return 1 + static_cast<double>(n - 1) * (1 - overlap);
}

// Of client `rank` among the n clients of a path of `cameras`.
FlightPiece PieceOf(size_t rank, size_t n, size_t cameras, std::optional<double> overlap) {
  if (!overlap) return {.first = rank * cameras / n, .frames = cameras};
  const double length = static_cast<double>(cameras) / PiecesEndToEnd(n, *overlap);
  // Less a hair, so that a length that is whole but for rounding stays it.
  const auto frames = std::clamp(static_cast<size_t>(std::ceil(length - 1e-9)), size_t{1}, cameras);
  FlightPiece piece{.frames = frames};
  // The last one ends where the path does.
  if (n > 1) piece.first = (rank * (cameras - frames) + (n - 1) / 2) / (n - 1);
  return piece;
}

}  // namespace

std::vector<FlightPiece> PlanPieces(size_t clients, const std::vector<size_t>& path_frames,
                                    std::optional<double> overlap) {
  const size_t paths = path_frames.size();
  LT_CHECK(paths > 0);
  std::vector<FlightPiece> pieces;
  for (size_t c = 0; c < clients; ++c) {
    const size_t path = c % paths;
    const size_t of_path = (clients - path + paths - 1) / paths;
    pieces.push_back(PieceOf(c / paths, of_path, path_frames[path], overlap));
    pieces.back().path = path;
  }
  return pieces;
}

std::vector<double> PlanArrivals(const ArrivalOptions& options, size_t most, double until_s) {
  LT_CHECK(options.rate > 0);
  std::mt19937_64 random(options.seed);
  std::vector<double> times;
  double next_s = 0;
  while (times.size() < most && next_s < until_s) {
    times.push_back(next_s);
    if (options.kind == ArrivalKind::kFixed) {
      next_s = static_cast<double>(times.size()) / options.rate;
    } else {
      // In [0, 1), of 53 bits.
      const double share = static_cast<double>(random() >> 11) * 0x1p-53;
      next_s -= std::log1p(-share) / options.rate;
    }
  }
  return times;
}

}  // namespace linetree
