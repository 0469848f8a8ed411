// Margins against what the classical tracer's rounding becomes on its way over curved mirrors.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "core/certify/margins-inl.h"
#include "core/certify/path_certifier.h"
#include "core/trace/intersect.h"
#include "core/trace/shade.h"
#include "tests/support/climb.h"
#include "tests/support/random_scene.h"

namespace linetree {
namespace {

using Wide = long double;
using WideVec = Vec3<Wide>;

// Balls that mirror a ray one after the other, and the ray of a cell of the first one. Numbers: the
// first ball's centre and the logarithm of its radius; the logarithms of each other's radius and of
// its distance along the ray, and where the ray meets it; the ray; the cell's edge as a power of 2.
struct Mirrors {
  std::vector<double> x;
  std::vector<Shape> balls{};
  std::vector<Vec3d> centers{};
  std::vector<double> radii{};

  double Edge() const { return std::exp2(std::clamp(x.back(), -15.0, -2.0)); }
  double Reach(size_t i) const {
    const Vec3d& c = centers[i];
    return std::max({std::abs(c.x), std::abs(c.y), std::abs(c.z)}) + 3 * radii[i];
  }
  void Add(const Vec3d& center, double log_radius) {
    centers.push_back(center);
    radii.push_back(std::exp(std::clamp(log_radius, -4.0, 4.0)));
    balls.push_back(test::Sphere(centers.back(), radii.back()));
  }
  // Puts the balls into the ray's way.
  void Build() {
    balls.clear();
    centers.clear();
    radii.clear();
    Add({x[0], x[1], x[2]}, x[3]);
    WideVec origin, direction, unused, last;
    for (size_t i = 4; i + 5 < x.size(); i += 4) {
      RayAt({}, origin, direction);
      if (!Follow(origin, direction, unused, last)) return;
      const Vec3d d = CastVec3<double>(direction);
      const Vec3d across =
          Normalized(Cross(d, std::abs(d.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0}));
      const double radius = std::exp(std::clamp(x[i], -4.0, 4.0));
      const double distance = radius + std::exp(std::clamp(x[i + 1], -3.0, 8.0));
      Add(CastVec3<double>(last) + d * distance +
              (across * std::tanh(x[i + 2]) + Cross(d, across) * std::tanh(x[i + 3])) *
                  (0.7 * radius),
          x[i]);
    }
  }

  // Where the last ball is met, and the direction it mirrors the ray to; false where one is missed.
  // `first`: where the first one is met.
  template <class S>
  bool Follow(Vec3<S>& origin, Vec3<S>& direction, Vec3<S>& first, Vec3<S>& last) const {
    for (size_t i = 0; i < balls.size(); ++i) {
      const auto crossings = LineCrossings(balls[i], origin, direction);
      if (crossings.count == 0 || !(crossings.at[0].t > 0)) return false;
      last = origin + direction * crossings.at[0].t;
      if (i == 0) first = last;
      direction = Reflected(direction, FacingNormal(balls[i], 0, last, direction));
      origin = last;
    }
    return true;
  }
  // The ray at coordinates within [-1/2, 1/2]^4 of the cell.
  void RayAt(const std::array<double, 4>& local, WideVec& origin, WideVec& direction) const {
    std::array<double, 4> at;
    for (size_t i = 0; i < 4; ++i) {
      at[i] = radii[0] * (0.6 * std::tanh(x[x.size() - 5 + i]) + 2 * Edge() * local[i]);
    }
    const Vec3d from = centers[0] + Vec3d{at[0], at[1], -3 * radii[0]};
    const Vec3d to = centers[0] + Vec3d{at[2], at[3], radii[0]};
    origin = CastVec3<Wide>(from);
    direction = CastVec3<Wide>(to) - origin;
    direction = direction * (1 / Length(direction));
  }
  bool FollowAt(const std::array<double, 4>& local, WideVec& first, WideVec& last) const {
    WideVec origin, direction;
    RayAt(local, origin, direction);
    return Follow(origin, direction, first, last);
  }

  // By how much the classical tracer's last hit is off, relative to the margin that it is given; 0
  // where jets would refuse the cell: where rays miss a ball, the path bends, or the cell is not
  // above rounding.
  double DriftOverMargin() {
    Build();
    WideVec origin, direction, first, last;
    RayAt({}, origin, direction);
    Vec3d eye = CastVec3<double>(origin), way = CastVec3<double>(direction), unused, classical;
    if (!Follow(origin, direction, first, last) || !Follow(eye, way, unused, classical)) return 0;
    scalar_jets::JetVector<4> hits;
    double lo[3][4], variation[3] = {};
    for (size_t i = 0; i < 4; ++i) {
      std::array<double, 4> local{};
      WideVec first_up, up, first_down, down;
      local[i] = 0.5;
      if (!FollowAt(local, first_up, up)) return 0;
      local[i] = -0.5;
      if (!FollowAt(local, first_down, down)) return 0;
      for (int c = 0; c < 3; ++c) {
        lo[c][i] = static_cast<double>(first_up[c] - first_down[c]);
        const Wide rise = up[c] - last[c], fall = last[c] - down[c];
        const Wide both = std::abs(rise) + std::abs(fall);
        if (std::abs(rise - fall) > 0.5L * both + 0.01L * Wide(Edge())) return 0;
        variation[c] += static_cast<double>(both);
      }
    }
    scalar_jets::CornerJet<4>* hit[3] = {&hits.x, &hits.y, &hits.z};
    for (size_t c = 0; c < 3; ++c) {
      const auto d = scalar_jets::Pack<4>::Load(lo[c]);
      hit[c]->ds = Combine(scalar_jets::IntervalPack<4>{d, d}, scalar_jets::IntervalPack<4>{d, d});
    }
    if (!scalar_jets::IsAboveRounding(hits, Reach(0))) return 0;
    double most = 0;
    const Vec3d& before = centers[centers.size() - 2];
    const double scale =
        Reach(centers.size() - 1) + std::abs(before.x) + std::abs(before.y) + std::abs(before.z);
    for (int c = 0; c < 3; ++c) {
      const double margin = scalar_jets::kSignMargin * scale + scalar_jets::kDrift * variation[c];
      most = std::max(most, static_cast<double>(std::abs(classical[c] - last[c])) / margin);
    }
    return most;
  }
};

// The case that uses its margin up most, by climbing from random ones, of which the first ball is
// about so far from the world's origin.
double WorstDrift(size_t balls, double away, test::Random& random) {
  double worst = 0;
  for (int start = 0; start < 30; ++start) {
    Mirrors best{std::vector<double>(4 * balls + 5)};
    double most = 0;
    for (int i = 0; i < 300 && most == 0; ++i) {
      for (double& x : best.x) x = random.Uniform(-1, 1);
      for (size_t k = 0; k < 3; ++k) best.x[k] *= away;
      best.x.back() = random.Uniform(-15, -2);
      most = best.DriftOverMargin();
    }
    worst = std::max(worst, test::Climb(best, 700, 1e-6, random,
                                        [](Mirrors& of) { return of.DriftOverMargin(); }));
  }
  return worst;
}

TEST(Margins, CoverWhatMirrorsMakeOfRounding) {
  test::Random random(41);
  double largest = 0;
  for (const double away : {1.0, 1e3, 1e6}) {
    for (const size_t balls : {2, 3}) {
      const double worst = WorstDrift(balls, away, random);
      std::printf("%zu mirrors, the first %.0f away: largest drift / margin %.4f\n", balls, away,
                  worst);
      EXPECT_LT(worst, 1);
      largest = std::max(largest, worst);
    }
  }
  EXPECT_GT(largest, 1.0 / 128) << "margins that wide can shrink";
}

// Two mirrors that face each other, in a small cell of the first one.
size_t StepsAt(const Vec3d& place, double edge) {
  Scene scene;
  test::AddMaterial(scene, test::Mirror({0.8, 0.8, 0.8}));
  test::AddObject(scene, test::Sphere(place, 0.5), 0);
  test::AddObject(scene, test::Sphere(place + Vec3d{0, 0, 4}, 1), 0);
  const Tracer tracer(scene);
  const PathCertifier certifier(tracer);
  const ObjectChart chart(scene.objects[0]);
  const Vec3d eye = place + Vec3d{0.1, 0.05, 2.5}, direction = Normalized(Vec3d{-0.05, 0, -1});
  const Hit hit = tracer.IntersectObjectLine(0, eye, direction);
  const int pair = chart.PairOf(direction);
  const auto coords = chart.CoordsOf(pair, hit.point, direction);
  if (!coords) return 0;
  CellBox box;
  for (size_t i = 0; i < 4; ++i) {
    box.from[i] = (*coords)[i] - edge / 2;
    box.to[i] = (*coords)[i] + edge / 2;
  }
  return certifier.Certify(0, chart, pair, box, {}, nullptr).steps.size();
}

TEST(Margins, NoBranchLeavesACellThatRoundingFills) {
  EXPECT_GT(StepsAt({0, 0, 0}, 0x1p-15), 1u);
  EXPECT_GT(StepsAt({1e6, 1e6, 0}, 0x1p-5), 1u);
  EXPECT_EQ(StepsAt({1e6, 1e6, 0}, 0x1p-15), 1u);
}

}  // namespace
}  // namespace linetree
