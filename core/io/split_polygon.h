// Concave polygons into convex ones: ear clipping, then Hertel and Mehlhorn's merging (at most four
// times as many pieces as the fewest possible).
#pragma once

#include <array>
#include <vector>

#include "absl/status/statusor.h"
#include "core/scene/planar_loop.h"

namespace linetree {

// Counter-clockwise triangles of indices into loop.vertices that cover the polygon. Holes that are
// joined to the border by a bridge (two edges on each other) are allowed. INVALID_ARGUMENT
// "vertices: expected ..." when the loop crosses itself. Cost: O(n^2) for common polygons.
absl::StatusOr<std::vector<std::array<int, 3>>> Triangulate(const PlanarLoop& loop);

// Convex pieces, each of which MakeConvexPolygon accepts; together they cover the polygon but for
// slivers thinner than LoopTolerance. Errors as above.
absl::StatusOr<std::vector<std::vector<Vec3d>>> SplitPolygon(const PlanarLoop& loop);

}  // namespace linetree
