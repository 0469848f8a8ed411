#include "core/tree/separable.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace linetree {
namespace {

// g + x gx + y gy >= kSeparationMargin.
struct HalfPlane {
  double gx, gy, g;
  double Slack(double x, double y) const { return g + x * gx + y * gy - kSeparationMargin; }
};

struct Point2 {
  double x = 0, y = 0;
};

// The point of the boundary of `line` that is nearest to the origin and satisfies the first `count`
// half-planes. False when there is none.
bool NearestOnLine(const HalfPlane& line, std::span<const HalfPlane> others, Point2& p) {
  const double norm2 = line.gx * line.gx + line.gy * line.gy;
  if (norm2 == 0) return false;  // a constant constraint that is violated
  const double k = (kSeparationMargin - line.g) / norm2;
  const Point2 foot{k * line.gx, k * line.gy};
  const Point2 along{-line.gy, line.gx};
  double lo = -std::numeric_limits<double>::infinity(), hi = -lo;
  for (const HalfPlane& other : others) {
    const double rate = other.gx * along.x + other.gy * along.y;
    const double slack = other.Slack(foot.x, foot.y);
    if (rate == 0) {
      if (slack < 0) return false;
    } else if (rate > 0) {
      lo = std::max(lo, -slack / rate);
    } else {
      hi = std::min(hi, -slack / rate);
    }
  }
  if (lo > hi) return false;
  const double s = std::clamp(0.0, lo, hi);
  p = {foot.x + s * along.x, foot.y + s * along.y};
  return true;
}

}  // namespace

bool StrictlySeparable(std::span<const Vec3d> a, std::span<const Vec3d> b) {
  std::vector<Vec3d> w;
  w.reserve(a.size() + b.size());
  for (const Vec3d& v : a) w.push_back(-Normalized(v));
  for (const Vec3d& v : b) w.push_back(Normalized(v));
  if (w.empty()) return true;
  Vec3d mean;
  for (const Vec3d& v : w) mean = mean + v;
  // A separating D has D.w > 0 for all w, so also D.mean > 0.
  if (Length(mean) <= kSeparationMargin * static_cast<double>(w.size())) return false;
  const Vec3d m = Normalized(mean);
  const Vec3d t = std::abs(m.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
  const Vec3d u = Normalized(Cross(m, t));
  const Vec3d v = Cross(m, u);
  std::vector<HalfPlane> planes;
  planes.reserve(w.size());
  Point2 p;  // the feasible point nearest to the origin, that is the D nearest to m
  for (const Vec3d& x : w) {
    const HalfPlane plane{Dot(u, x), Dot(v, x), Dot(m, x)};
    if (plane.Slack(p.x, p.y) < 0 && !NearestOnLine(plane, planes, p)) return false;
    planes.push_back(plane);
  }
  // The incremental steps round; the answer is yes only for a D that is seen to separate.
  const Vec3d d = Normalized(m + u * p.x + v * p.y);
  return std::all_of(w.begin(), w.end(), [&](const Vec3d& x) { return Dot(d, x) > 0; });
}

}  // namespace linetree
