#include "core/io/split_polygon.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <utility>

#include "core/math/check.h"

namespace linetree {
namespace {

// The pieces' area must be the polygon's to this fraction: it is lost or doubled where the border
// crosses itself, and rounding changes it by a few 2^-52 per vertex.
constexpr double kAreaTolerance = 1e-9;

struct Point {
  double x, y;
  bool operator==(const Point&) const = default;
};

// Twice the area of a, b, c; positive when they run counter-clockwise.
double Area(const Point& a, const Point& b, const Point& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

double Distance(const Point& a, const Point& b) { return std::hypot(b.x - a.x, b.y - a.y); }

// The loop without the coordinate along which its normal is longest: exact, counter-clockwise.
std::vector<Point> Flatten(const PlanarLoop& loop) {
  const Vec3d n{std::abs(loop.normal.x), std::abs(loop.normal.y), std::abs(loop.normal.z)};
  const int k = n.x >= n.y && n.x >= n.z ? 0 : n.y >= n.z ? 1 : 2;
  int u = (k + 1) % 3, v = (k + 2) % 3;
  if (loop.normal[k] < 0) std::swap(u, v);
  std::vector<Point> points;
  points.reserve(loop.vertices.size());
  for (const Vec3d& p : loop.vertices) points.push_back({p[u], p[v]});
  return points;
}

// -1, 0 or 1: the side of the line a -> b on which p lies, 0 within `tolerance` of it.
int SideOf(const Point& a, const Point& b, const Point& p, double tolerance) {
  const double area = Area(a, b, p);
  const double margin = tolerance * Distance(a, b);
  return area > margin ? 1 : area < -margin ? -1 : 0;
}

bool CrossesItself(const std::vector<Point>& p, double tolerance) {
  const size_t n = p.size();
  for (size_t i = 0; i < n; ++i) {
    const Point &a = p[i], &b = p[(i + 1) % n];
    for (size_t j = i + 2; j < n; ++j) {
      const Point &c = p[j], &d = p[(j + 1) % n];
      if (std::max(c.x, d.x) < std::min(a.x, b.x) || std::min(c.x, d.x) > std::max(a.x, b.x))
        continue;
      if (SideOf(a, b, c, tolerance) * SideOf(a, b, d, tolerance) < 0 &&
          SideOf(c, d, a, tolerance) * SideOf(c, d, b, tolerance) < 0)
        return true;
    }
  }
  return false;
}

// Clips ears off a ring of vertices.
class EarClipper {
 public:
  explicit EarClipper(const std::vector<Point>& points) : points_(points) {
    const int n = static_cast<int>(points.size());
    for (int i = 0; i < n; ++i) {
      next_.push_back((i + 1) % n);
      previous_.push_back((i + n - 1) % n);
    }
  }

  std::vector<std::array<int, 3>> Clip() {
    const int n = static_cast<int>(points_.size());
    for (int i = 0; i < n; ++i) Consider(i);
    for (int left = n; left > 3; --left) {
      const int ear = NextEar();
      const int before = previous_[At(ear)], after = next_[At(ear)];
      Emit(ear);
      next_[At(before)] = after;
      previous_[At(after)] = before;
      next_[At(ear)] = kClipped;
      somewhere_ = after;
      // Clipping an ear makes or unmakes ears at its neighbours only.
      Consider(before);
      Consider(after);
    }
    Emit(somewhere_);
    return std::move(triangles_);
  }

 private:
  static constexpr int kClipped = -1;
  static size_t At(int i) { return static_cast<size_t>(i); }
  const Point& P(int i) const { return points_[At(i)]; }

  double Turn(int i) const { return Area(P(previous_[At(i)]), P(i), P(next_[At(i)])); }

  void Consider(int i) {
    if (IsEar(i)) ears_.push_back(i);
  }

  // Convex, and no other reflex vertex of the ring lies in the closed triangle at i. Vertices that
  // repeat one of its corners (the ends of a bridge) do not count.
  bool IsEar(int i) const {
    if (Turn(i) <= 0) return false;
    const int before = previous_[At(i)], after = next_[At(i)];
    const Point &a = P(before), &b = P(i), &c = P(after);
    for (int k = next_[At(after)]; k != before; k = next_[At(k)]) {
      const Point& p = P(k);
      if (p == a || p == b || p == c || Turn(k) > 0) continue;
      if (Area(a, b, p) >= 0 && Area(b, c, p) >= 0 && Area(c, a, p) >= 0) return false;
    }
    return true;
  }

  int NextEar() {
    while (!ears_.empty()) {
      const int i = ears_.front();
      ears_.pop_front();
      if (next_[At(i)] != kClipped && IsEar(i)) return i;
    }
    // A ring without ears happens with bridges and with corners that rounding has flattened. The
    // flattest corner costs the least area, and the areas are checked afterwards.
    int flattest = somewhere_;
    for (int k = next_[At(somewhere_)]; k != somewhere_; k = next_[At(k)]) {
      if (std::abs(Turn(k)) < std::abs(Turn(flattest))) flattest = k;
    }
    return flattest;
  }

  void Emit(int i) {
    if (Turn(i) != 0) triangles_.push_back({previous_[At(i)], i, next_[At(i)]});
  }

  const std::vector<Point>& points_;
  std::vector<int> next_, previous_;
  std::deque<int> ears_;
  int somewhere_ = 0;  // a vertex that is still in the ring
  std::vector<std::array<int, 3>> triangles_;
};

using Ring = std::vector<int>;

// Removes diagonals while both of their ends stay convex by more than the tolerance.
class Merger {
 public:
  Merger(const std::vector<Point>& points, const std::vector<std::array<int, 3>>& triangles,
         double tolerance)
      : points_(points), tolerance_(tolerance) {
    for (const auto& t : triangles) {
      for (size_t k = 0; k < 3; ++k) owner_[{t[k], t[(k + 1) % 3]}] = rings_.size();
      rings_.emplace_back(t.begin(), t.end());
    }
  }

  std::vector<Ring> Merge() {
    std::vector<std::pair<int, int>> edges;
    for (const auto& [edge, ring] : owner_) edges.push_back(edge);
    for (const auto& [a, b] : edges) {
      if (a < b) TryEdge(a, b);
    }
    std::erase_if(rings_, [](const Ring& ring) { return ring.empty(); });
    return std::move(rings_);
  }

 private:
  bool IsConvex(int before, int at, int after) const {
    const Point &a = points_[static_cast<size_t>(before)], &b = points_[static_cast<size_t>(at)],
                &c = points_[static_cast<size_t>(after)];
    return SideOf(a, b, c, tolerance_) > 0 && SideOf(b, c, a, tolerance_) > 0;
  }

  // The ring, turned so that it starts with vertex `first`.
  static Ring From(const Ring& ring, int first) {
    Ring turned = ring;
    std::rotate(turned.begin(), std::find(turned.begin(), turned.end(), first), turned.end());
    return turned;
  }

  void TryEdge(int a, int b) {
    const auto one = owner_.find({a, b}), other = owner_.find({b, a});
    if (one == owner_.end() || other == owner_.end() || one->second == other->second) return;
    const size_t keep = one->second, gone = other->second;
    // keep = b ... a, gone = a ... b; together b ... a ... without the shared edge.
    Ring left = From(rings_[keep], b), right = From(rings_[gone], a);
    const size_t nl = left.size(), nr = right.size();
    if (!IsConvex(left[nl - 2], a, right[1]) || !IsConvex(right[nr - 2], b, left[1])) return;
    for (size_t k = 0; k < nr; ++k) owner_[{right[k], right[(k + 1) % nr]}] = keep;
    owner_.erase({a, b});
    owner_.erase({b, a});
    left.insert(left.end(), right.begin() + 1, right.end() - 1);
    rings_[keep] = std::move(left);
    rings_[gone].clear();
  }

  const std::vector<Point>& points_;
  double tolerance_;
  std::map<std::pair<int, int>, size_t> owner_;  // of directed edges
  std::vector<Ring> rings_;
};

absl::Status NotSimple() {
  return absl::InvalidArgumentError("vertices: expected a polygon that does not cross itself");
}

}  // namespace

absl::StatusOr<std::vector<std::array<int, 3>>> Triangulate(const PlanarLoop& loop) {
  LT_CHECK(loop.vertices.size() >= 3);
  const std::vector<Point> points = Flatten(loop);
  if (CrossesItself(points, LoopTolerance(loop.vertices))) return NotSimple();
  auto triangles = EarClipper(points).Clip();
  double expected = 0;
  for (size_t i = 1; i + 1 < points.size(); ++i) {
    expected += Area(points[0], points[i], points[i + 1]);
  }
  double covered = 0;
  for (const auto& [a, b, c] : triangles) {
    covered += std::abs(Area(points[static_cast<size_t>(a)], points[static_cast<size_t>(b)],
                             points[static_cast<size_t>(c)]));
  }
  if (!(std::abs(covered - expected) <= kAreaTolerance * expected)) return NotSimple();
  return triangles;
}

absl::StatusOr<std::vector<std::vector<Vec3d>>> SplitPolygon(const PlanarLoop& loop) {
  auto triangles = Triangulate(loop);
  if (!triangles.ok()) return triangles.status();
  const std::vector<Point> points = Flatten(loop);
  std::vector<std::vector<Vec3d>> pieces;
  for (const Ring& ring : Merger(points, *triangles, LoopTolerance(loop.vertices)).Merge()) {
    std::vector<Vec3d> piece;
    for (int i : ring) piece.push_back(loop.vertices[static_cast<size_t>(i)]);
    // Triangles without area in double arithmetic are the slivers that are left out.
    const auto clean = MakePlanarLoop(piece);
    if (!clean.ok()) continue;
    if (!clean->convex) return NotSimple();
    pieces.push_back(std::move(piece));
  }
  return pieces;
}

}  // namespace linetree
