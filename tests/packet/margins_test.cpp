// The margins of core/packet/margins.h against what rounding really does: rays that make the search
// in float as wrong as they can, found by climbing.
#include "core/packet/margins.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/trace/intersect.h"
#include "tests/packet/crossing_bounds.h"
#include "tests/support/every_target.h"
#include "tests/support/random_shapes.h"

namespace linetree::test {
namespace {

// Where the search in float is wrong by its own account, this is above 1.
constexpr double kWrong = 1e9;

// Distance of the true crossing from the middle of its interval, in units of half its length: the
// largest of both crossings. 0 where the search leaves all to double.
double ErrorOverBound(const Shape& shape, const Ray& ray, int lane,
                      const std::array<CrossingBounds, 2>& bounds) {
  using S = long double;
  const Crossings<S> crossings =
      LineCrossings(shape, CastVec3<S>(ray.origin), CastVec3<S>(ray.direction));
  double largest = 0;
  for (int k = 0; k < 2; ++k) {
    const CrossingBounds& b = bounds[static_cast<size_t>(k)];
    const bool maybe = (b.maybe >> lane & 1) != 0, sure = (b.sure >> lane & 1) != 0;
    if (k >= crossings.count) {
      if (sure) return kWrong;
      continue;
    }
    if (!maybe) return kWrong;
    if (!sure) continue;
    const auto i = static_cast<size_t>(lane);
    const double low = b.low[i], high = b.high[i];
    const double off = std::abs(static_cast<double>(crossings.at[k].t) - (low + high) / 2);
    largest = std::max(largest, off / ((high - low) / 2));
  }
  return largest;
}

class Climb {
 public:
  Climb(Shape shape, uint64_t seed) : random_(seed) {
    AddMaterial(scene_, Matte({1, 1, 1}));
    AddObject(scene_, std::move(shape));
    // Away from the first, so that lengths are those of a scene and not of one shape.
    AddObject(scene_, Sphere(random_.Direction() * 6, 1));
    tracer_.emplace(scene_);
    packets_.emplace(*tracer_);
  }

  // The largest error that some rays come to in so many steps.
  double Run(int steps) {
    std::array<Ray, kPacketLanes> rays;
    std::array<double, kPacketLanes> best{};
    for (Ray& ray : rays) ray = SomeRay();
    double largest = 0;
    for (int step = 0; step < steps; ++step) {
      std::array<Ray, kPacketLanes> tried = rays;
      PacketRays packet;
      for (int lane = 0; lane < kPacketLanes; ++lane) {
        Ray& ray = tried[static_cast<size_t>(lane)];
        if (step > 0) ray = best[static_cast<size_t>(lane)] == 0 ? SomeRay() : Near(ray);
        packet.SetRay(lane, ray.origin, ray.direction, RayStart{});
      }
      std::array<CrossingBounds, 2> bounds;
      if (!FindCrossingBounds(*packets_, 0, packet, bounds)) return 0;
      for (int lane = 0; lane < kPacketLanes; ++lane) {
        const auto i = static_cast<size_t>(lane);
        const double error = ErrorOverBound(scene_.objects[0].shape, tried[i], lane, bounds);
        if (error < best[i]) continue;
        best[i] = error;
        rays[i] = tried[i];
        largest = std::max(largest, error);
      }
    }
    return largest;
  }

 private:
  Ray SomeRay() {
    const Box3& bounds = scene_.objects[0].bounds;
    const Vec3d eye = bounds.Center() + random_.Direction() * random_.Uniform(1.5, 4);
    return {eye, Normalized(random_.InBox(bounds.min, bounds.max) - eye)};
  }
  Ray Near(const Ray& ray) {
    const double by = random_.LogUniform(1e-8, 1e-2);
    return {ray.origin + random_.Direction() * by,
            Normalized(ray.direction + random_.Direction() * (by * random_.Unit()))};
  }

  Random random_;
  Scene scene_;
  std::optional<Tracer> tracer_;
  std::optional<PacketScene> packets_;
};

class Margins : public testing::TestWithParam<ShapeKind> {};

TEST_P(Margins, HoldWhatTheyPromise) {
  ForEveryTarget([&](const char* name) {
    if (std::string(name) == "SCALAR") return;
    double largest = 0;
    for (uint64_t seed = 0; seed < 20; ++seed) {
      Random random(seed);
      largest = std::max(
          largest, Climb(RandomShape(GetParam(), random, 1, random.InCube(1)), seed).Run(300));
    }
    std::printf("%s, %s: error / bound %.3f\n", std::string(NameOf(GetParam())).c_str(), name,
                largest);
    EXPECT_LE(largest, 1) << name;
  });
}

// Lines that end at `to`, eye rays or shadow rays to a light there: how far the line in float is
// from the one in double where it comes near a ball, in units of kLineMargin * R.
class LineClimb {
 public:
  LineClimb(uint64_t seed, bool shadows) : random_(seed), shadows_(shadows) {
    AddMaterial(scene_, Matte({1, 1, 1}));
    center_ = random_.InCube(4);
    AddObject(scene_, Sphere(center_, 1e-3));
    AddObject(scene_, Sphere({0, 0, 0}, 1e-3));
    light_ = random_.InCube(6);
    scene_.lights.push_back(PointLight(light_));
    tracer_.emplace(scene_);
    packets_.emplace(*tracer_);
  }

  double Run(int steps) {
    std::array<Vec3d, kPacketLanes> from, tried;
    std::array<double, kPacketLanes> best{};
    for (Vec3d& p : from) p = Behind(random_.LogUniform(0.1, 10));
    for (int step = 0; step < steps; ++step) {
      for (size_t i = 0; i < kPacketLanes; ++i) {
        const double by = random_.LogUniform(1e-8, 1e-1);
        tried[i] = step == 0 ? from[i] : from[i] + random_.Direction() * by;
      }
      NearestPoints nearest;
      if (!Find(tried, nearest)) return 0;
      for (size_t i = 0; i < kPacketLanes; ++i) {
        const double error = ErrorOverMargin(tried[i], nearest, i);
        if (error < best[i]) continue;
        best[i] = error;
        from[i] = tried[i];
      }
    }
    return *std::max_element(best.begin(), best.end());
  }

 private:
  // A point from which the ball lies before the light.
  Vec3d Behind(double distance) {
    return center_ + Normalized(center_ - light_) * distance + random_.Direction() * 1e-3;
  }
  Vec3d AlongFrom(const Vec3d& from) const { return Normalized(light_ - from); }

  bool Find(const std::array<Vec3d, kPacketLanes>& from, NearestPoints& nearest) const {
    PacketRays rays;
    PacketHits hits;
    for (int lane = 0; lane < kPacketLanes; ++lane) {
      const Vec3d& p = from[static_cast<size_t>(lane)];
      rays.SetRay(lane, p, AlongFrom(p), RayStart{});
      Hit hit;
      hit.object = 1;
      hit.point = p;
      hit.normal = AlongFrom(p);
      hits.Set(lane, hit);
    }
    return shadows_ ? FindNearestPoints(*packets_, 0, hits, nearest)
                    : FindNearestPoints(*packets_, 0, rays, nearest);
  }

  double ErrorOverMargin(const Vec3d& from, const NearestPoints& nearest, size_t lane) const {
    using S = long double;
    const Vec3<S> along = shadows_ ? Normalized(CastVec3<S>(light_) - CastVec3<S>(from))
                                   : CastVec3<S>(AlongFrom(from));
    const Vec3<S> p = CastVec3<S>(from) - CastVec3<S>(center_);
    const S t = -Dot(p, along);
    const Vec3<S> exact = p + along * t;
    const Vec3<S> found{S(nearest.x[lane]), S(nearest.y[lane]), S(nearest.z[lane])};
    const S off = std::max(Length(exact - found), std::abs(t - S(nearest.t[lane])));
    return static_cast<double>(off) / static_cast<double>(kLineMargin * nearest.size);
  }

  Random random_;
  const bool shadows_;
  Vec3d center_, light_;
  Scene scene_;
  std::optional<Tracer> tracer_;
  std::optional<PacketScene> packets_;
};

// What makes up the margin's 24 units does not come together: R is the sum of lengths of which the
// lines use a part, and roundings are half as large on average and of either sign. Shadow rays
// reach a seventh of it, others a fifteenth: a margin four times as small would still hold.
TEST(LineMargin, IsReachedInPart) {
  ForEveryTarget([&](const char* name) {
    if (std::string(name) == "SCALAR") return;
    for (const bool shadows : {false, true}) {
      double largest = 0;
      for (uint64_t seed = 0; seed < 40; ++seed) {
        largest = std::max(largest, LineClimb(seed, shadows).Run(500));
      }
      std::printf("%s, %s: error / margin %.3f\n", shadows ? "shadow rays" : "rays", name, largest);
      EXPECT_LE(largest, 1) << name;
      EXPECT_GT(largest, 0.05) << name;
    }
  });
}

INSTANTIATE_TEST_SUITE_P(Shapes, Margins,
                         testing::Values(ShapeKind::kSphere, ShapeKind::kBox, ShapeKind::kCylinder,
                                         ShapeKind::kCone, ShapeKind::kFrustum, ShapeKind::kDisc,
                                         ShapeKind::kPolygon, ShapeKind::kPolyhedron),
                         [](const auto& info) { return std::string(NameOf(info.param)); });

}  // namespace
}  // namespace linetree::test
