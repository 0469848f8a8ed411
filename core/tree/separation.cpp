#include "core/tree/separation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/math/check.h"
#include "core/scene/support.h"

namespace linetree {
namespace {

// A proposal whose distance is within this part of the best one is final: roundings of 2^-53 leave
// nothing to gain below.
constexpr double kConverged = 0x1p-40;

// A normal is made to lean away from the sweep by this, more than the four roundings of a dot
// product of unit vectors, so that n.direction <= 0 holds exactly.
constexpr double kLean = 0x1p-50;

// How many times the reach of all data the sweep's stand-in goes: farther than any point of the
// shape by so much that its far end is never the nearest part.
constexpr double kSweepReach = 4;

// A tetrahedron whose apex rises above a face by less than this sine has no side on which 0 could
// certainly lie: a hundred roundings of the products that decide it.
constexpr double kFlat = 0x1p-46;

// conv(points), or of balls about them, swept along a direction or not, relative to one point.
class Bundle {
 public:
  // No radii: points; no sweep: not swept.
  Bundle(std::span<const Vec3d> points, std::span<const double> radii, const Vec3d* sweep,
         const Shape& shape)
      : points_(points), radii_(radii), sweep_(sweep), origin_(points[0]) {
    Vec3d sum;
    for (const Vec3d& p : points) {
      const Vec3d x = p - origin_;
      reach_ = std::max(reach_, std::abs(x.x) + std::abs(x.y) + std::abs(x.z));
      sum = sum + x;
    }
    double widest = 0;
    for (const double r : radii) widest = std::max(widest, r);
    reach_ += widest;
    middle_ = sum * (1 / static_cast<double>(points.size()));
    reach_ += Reach(shape, origin_);
    if (sweep_) far_ = *sweep_ * (kSweepReach * reach_);
  }

  const Vec3d& Origin() const { return origin_; }
  // Of the points and the shape together.
  double ReachOfAll() const { return reach_; }

  // From a point near the middle (of the sweep: the nearest to x) to x.
  Vec3d FromMiddle(const Vec3d& x) const {
    const Vec3d v = x - middle_;
    if (!sweep_) return v;
    return v - *sweep_ * std::max(0.0, Dot(v, *sweep_));
  }

  // Farthest point; the sweep counts as far as its stand-in goes.
  Vec3d Farthest(const Vec3d& n) const {
    if (!radii_.empty()) return FarthestOfBalls(n);
    Vec3d farthest;
    double most = -Box3::kInf;
    for (const Vec3d& p : points_) {
      const Vec3d x = p - origin_;
      const double along = Dot(n, x);
      if (along > most) {
        most = along;
        farthest = x;
      }
    }
    return sweep_ && Dot(n, *sweep_) > 0 ? farthest + far_ : farthest;
  }

  // The unit normal nearest to n that bounds the sweep.
  Vec3d Bounding(const Vec3d& n) const {
    if (!sweep_ || Dot(n, *sweep_) <= -kLean) return n;
    return Normalized(n - *sweep_ * (Dot(n, *sweep_) + 2 * kLean));
  }
  bool IsBoundedAlong(const Vec3d& n) const { return !sweep_ || Dot(n, *sweep_) <= -kLean; }

  // For n of unit length.
  double Most(const Vec3d& n) const {
    double most = -Box3::kInf;
    for (size_t i = 0; i < points_.size(); ++i) {
      const double radius = radii_.empty() ? 0 : radii_[i];
      const double along = Dot(n, points_[i] - origin_) + radius;
      if (!(along <= most)) most = along;  // what is not a number stays, and separates nothing
    }
    return most;
  }

 private:
  Vec3d FarthestOfBalls(const Vec3d& n) const {
    const double length = Length(n);
    size_t farthest = 0;
    double most = -Box3::kInf;
    for (size_t i = 0; i < points_.size(); ++i) {
      const double along = Dot(n, points_[i] - origin_) + length * radii_[i];
      if (along > most) {
        most = along;
        farthest = i;
      }
    }
    return points_[farthest] - origin_ + n * (radii_[farthest] / length);
  }

  std::span<const Vec3d> points_;
  std::span<const double> radii_;
  const Vec3d* sweep_;
  Vec3d origin_, middle_, far_;
  double reach_ = 0;
};

// The only place that says "apart". The bundle's side rounds less than the shape's, and the margin
// counts with the rounding of |n| = 1.
bool Separates(const Vec3d& n, const Bundle& bundle, const Shape& shape, double margin) {
  if (!bundle.IsBoundedAlong(n)) return false;
  const double rounding = kSupportRounding * (bundle.ReachOfAll() + margin);
  return bundle.Most(n) + margin + rounding <= -Support(shape, -n, bundle.Origin());
}

// Up to four points of the difference {s - p}, and the point of their hull nearest to 0.
struct Simplex {
  std::array<Vec3d, 4> corners;
  int count = 0;
};
struct Nearest {
  Simplex simplex;  // the smallest face that holds the point
  Vec3d point;
  double square = Box3::kInf;

  void Take(const Nearest& other) {
    if (other.square < square) *this = other;
  }
};

Nearest NearestOf(const Vec3d& a) { return {{{a}, 1}, a, LengthSquared(a)}; }

Nearest NearestOf(const Vec3d& a, const Vec3d& b) {
  const Vec3d ab = b - a;
  const double along = -Dot(a, ab), square = LengthSquared(ab);
  if (!(along > 0)) return NearestOf(a);
  if (!(along < square)) return NearestOf(b);
  const Vec3d point = a + ab * (along / square);
  return {{{a, b}, 2}, point, LengthSquared(point)};
}

// The foot of 0 lies outside of the edges of negative weight, and the nearest point on one of them.
// A flat triangle has weights of any sign, so it takes all edges.
Nearest NearestOf(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d n = Cross(b - a, c - a);
  const double square = LengthSquared(n);
  const double wa = Dot(n, Cross(b, c)), wb = Dot(n, Cross(c, a)), wc = Dot(n, Cross(a, b));
  if (square > 0 && wa > 0 && wb > 0 && wc > 0) {
    // Along the normal rather than by the weights: exact in direction, which is what is wanted.
    const Vec3d point = n * (Dot(n, a) / square);
    return {{{a, b, c}, 3}, point, LengthSquared(point)};
  }
  Nearest nearest = NearestOf(a, b);
  nearest.Take(NearestOf(b, c));
  nearest.Take(NearestOf(c, a));
  return nearest;
}

// Empty when 0 lies inside.
std::optional<Nearest> NearestOf(const Simplex& s) {
  const auto& [a, b, c, d] = s.corners;
  if (s.count == 1) return NearestOf(a);
  if (s.count == 2) return NearestOf(a, b);
  if (s.count == 3) return NearestOf(a, b, c);
  Nearest nearest;
  const auto try_face = [&](const Vec3d& p, const Vec3d& q, const Vec3d& r, const Vec3d& apex) {
    const Vec3d n = Cross(q - p, r - p);
    const double height = Dot(n, p - apex);
    const bool is_flat = std::abs(height) <= kFlat * Length(n) * Length(p - apex);
    const bool is_inside = Dot(n, p) * height > 0;
    if (is_flat || !is_inside) nearest.Take(NearestOf(p, q, r));
  };
  try_face(a, b, c, d);
  try_face(a, b, d, c);
  try_face(a, c, d, b);
  try_face(b, c, d, a);
  if (nearest.simplex.count == 0) return std::nullopt;
  return nearest;
}

bool Holds(const Simplex& s, const Vec3d& w) {
  return std::find(s.corners.begin(), s.corners.begin() + s.count, w) !=
         s.corners.begin() + s.count;
}

// Gilbert, Johnson and Keerthi: v runs towards the point of {s - p} nearest to 0; the plane across
// v through the point w that lies lowest along v bounds the set, so every step is a proposal. The
// normal that separates is left in `normal`.
bool Search(const Bundle& bundle, const Shape& shape, double margin, Vec3d& normal) {
  Vec3d v = bundle.FromMiddle(MiddleOf(shape, bundle.Origin()));
  // Middles that coincide say nothing; almost always the sets overlap.
  if (!(LengthSquared(v) > 0)) v = {1, 0, 0};
  Simplex simplex;
  for (int i = 0; i < kMaxProposals; ++i) {
    const double length = Length(v);
    const Vec3d w = SupportPoint(shape, -v, bundle.Origin()) - bundle.Farthest(v);
    const double distance = Dot(v, w) / length;
    if (distance >= margin) {
      normal = bundle.Bounding(v * (1 / length));
      if (Separates(normal, bundle, shape, margin)) return true;
    }
    if (simplex.count > 0 && (length < margin || length - distance <= kConverged * length)) break;
    if (Holds(simplex, w)) break;
    simplex.corners[static_cast<size_t>(simplex.count++)] = w;
    const auto nearest = NearestOf(simplex);
    if (!nearest || !(nearest->square > 0)) break;
    v = nearest->point;
    simplex = nearest->simplex;
  }
  return false;
}

bool Search(const Bundle& bundle, const Shape& shape, double margin) {
  Vec3d unused;
  return Search(bundle, shape, margin, unused);
}

}  // namespace

bool CertainlyApart(std::span<const Vec3d> points, const Shape& shape, double margin) {
  LT_CHECK(!points.empty());
  return Search(Bundle(points, {}, nullptr, shape), shape, margin);
}

bool CertainlyApart(std::span<const Vec3d> points, const Shape& shape, double margin,
                    Vec3d& proposal) {
  LT_CHECK(!points.empty());
  const Bundle bundle(points, {}, nullptr, shape);
  const bool has_proposal = LengthSquared(proposal) > 0;
  if (has_proposal && Separates(proposal, bundle, shape, margin)) return true;
  Vec3d normal;
  if (!Search(bundle, shape, margin, normal)) return false;
  proposal = normal;
  return true;
}

bool CertainlyApart(std::span<const Vec3d> points, const Vec3d& direction, const Shape& shape,
                    double margin) {
  LT_CHECK(!points.empty());
  return Search(Bundle(points, {}, &direction, shape), shape, margin);
}

bool CertainlyApart(std::span<const Vec3d> centers, std::span<const double> radii,
                    const Shape& shape, double margin) {
  LT_CHECK(!centers.empty() && centers.size() == radii.size());
  return Search(Bundle(centers, radii, nullptr, shape), shape, margin);
}

}  // namespace linetree
