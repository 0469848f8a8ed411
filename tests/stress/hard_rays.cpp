#include "tests/stress/hard_rays.h"

#include <cmath>
#include <limits>
#include <variant>

#include "core/scene/affine_map.h"
#include "core/trace/intersect.h"
#include "core/tree/ray_space.h"
#include "tests/support/shape_points.h"

namespace linetree::stress {
namespace {

using test::Random;

const Object& AnyOf(const Scene& scene, Random& random) {
  return scene.objects[static_cast<size_t>(random.Below(static_cast<int>(scene.objects.size())))];
}

double SizeOf(const Object& object) { return Length(object.bounds.Extent()); }

// A ray that comes from `distance` away and goes through the point.
Ray Through(const Vec3d& point, const Vec3d& direction, double distance) {
  return {point - Unit(direction) * distance, direction};
}

bool IsUsable(const Ray& ray) {
  return IsFinite(ray.origin) && IsFinite(ray.direction) && ray.direction != Vec3d{};
}

void Add(const Ray& ray, std::vector<Ray>& rays) {
  if (IsUsable(ray)) rays.push_back(ray);
}

}  // namespace

double Nudged(double x, int ulps) {
  const double to = ulps < 0 ? -Box3::kInf : Box3::kInf;
  for (int i = std::abs(ulps); i > 0; --i) x = std::nextafter(x, to);
  return x;
}

Vec3d Nudged(const Vec3d& v, Random& random, int most_ulps) {
  Vec3d w = v;
  for (int i = 0; i < 3; ++i) w[i] = Nudged(w[i], random.Int(-most_ulps, most_ulps));
  return w;
}

Vec3d PointOn(const Object& object, Random& random) {
  return std::visit(test::PointOf{random}, object.shape);
}

void AddSpread(const Scene& scene, int count, Random& random, std::vector<Ray>& rays) {
  for (int i = 0; i < count; ++i) {
    const Object& object = AnyOf(scene, random);
    const Vec3d target = PointOn(object, random);
    const double away = SizeOf(object) * random.LogUniform(1, 100);
    const Vec3d origin = object.bounds.Center() + random.Direction() * away;
    Add({origin, target - origin}, rays);
  }
}

void AddFocused(const Vec3d& target, double size, int count, Random& random,
                std::vector<Ray>& rays) {
  const Vec3d from = target + random.Direction() * (size * random.Uniform(1, 4));
  for (int i = 0; i < count; ++i) {
    const Vec3d at = target + random.Direction() * (size * random.LogUniform(1e-9, 1));
    Add({from, at - from}, rays);
  }
}

void AddClusters(const Scene& scene, int clusters, int count, Random& random,
                 std::vector<Ray>& rays) {
  for (int i = 0; i < clusters; ++i) {
    const Object& object = AnyOf(scene, random);
    AddFocused(PointOn(object, random), SizeOf(object), count / clusters, random, rays);
  }
}

void AddOnLinetreeCells(const Scene& scene, int count, Random& random, std::vector<Ray>& rays) {
  for (int i = 0; i < count; ++i) {
    const Object& object = AnyOf(scene, random);
    const int depth = random.Int(0, kMaxCellDepth);
    RayCoords x;
    for (double& c : x) c = std::ldexp(random.Int(0, 1 << depth), -depth);
    const Ray line = ObjectChart(object).LineOf(random.Below(kFacePairs), x);
    Add(Through(line.origin, line.direction, SizeOf(object) * random.Uniform(0, 8)), rays);
  }
}

void AddTies(const Scene& scene, int count, Random& random, std::vector<Ray>& rays) {
  for (int i = 0; i < count; ++i) {
    const Object& object = AnyOf(scene, random);
    const auto sign = [&] { return random.Below(2) == 0 ? -1.0 : 1.0; };
    Vec3d d{sign(), sign(), sign()};
    const int axis = random.Below(3);
    if (random.Below(3) > 0) d[axis] *= random.Below(2) == 0 ? 0 : random.Unit();
    if (random.Below(4) == 0) d[(axis + 1) % 3] = 0;
    if (random.Below(4) == 0) d = Nudged(d, random, 1);
    const Vec3d point = random.Below(2) == 0
                            ? PointOn(object, random)
                            : (random.Below(2) == 0 ? object.bounds.min : object.bounds.max) * 0.5 +
                                  object.bounds.Center() * 0.5;
    Add(Through(point, d, SizeOf(object) * random.Int(0, 8)), rays);
  }
}

void AddTangents(const Scene& scene, int count, Random& random, std::vector<Ray>& rays) {
  for (int i = 0; i < count; ++i) {
    const Object& object = AnyOf(scene, random);
    const Vec3d point = PointOn(object, random);
    const int face = random.Below(FaceCount(object.shape));
    const Vec3d normal = FacingNormal(object.shape, face, point, random.Direction());
    const Vec3d across = Cross(normal, random.Direction());
    if (!(Length(across) > 0)) continue;
    const Ray ray = Through(Nudged(point, random, 4), Unit(across),
                            SizeOf(object) * random.LogUniform(0.1, 10));
    Add({ray.origin, Nudged(ray.direction, random, 4)}, rays);
  }
}

void AddFromWithin(const Scene& scene, int count, Random& random, std::vector<Ray>& rays) {
  for (int i = 0; i < count; ++i) {
    const Object& object = AnyOf(scene, random);
    const Vec3d origin = random.Below(2) == 0 ? PointOn(object, random)
                                              : random.InBox(object.bounds.min, object.bounds.max);
    const Vec3d aim =
        random.Below(2) == 0 ? random.Direction() : PointOn(AnyOf(scene, random), random) - origin;
    Add({origin, aim}, rays);
  }
}

std::vector<Ray> HardRays(const Scene& scene, int count, Random& random) {
  std::vector<Ray> rays;
  AddSpread(scene, count / 4, random, rays);
  AddClusters(scene, 6, count / 4, random, rays);
  AddOnLinetreeCells(scene, count / 8, random, rays);
  AddTies(scene, count / 8, random, rays);
  AddTangents(scene, count / 8, random, rays);
  AddFromWithin(scene, count / 8, random, rays);
  return rays;
}

}  // namespace linetree::stress
