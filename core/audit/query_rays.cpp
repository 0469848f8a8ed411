#include "core/audit/query_rays.h"

#include <algorithm>
#include <utility>

namespace linetree {
namespace {

// Dyadic points are multiples of 2^-k with k up to this.
constexpr int kMaxDyadicBits = 6;

double DyadicOf(RandomStream& random) { return random.Dyadic(1 + random.Below(kMaxDyadicBits)); }

Vec3d Between(const Vec3d& a, const Vec3d& b, double share) { return a + (b - a) * share; }

Vec3d FromObjectSpace(const AffineFrame& frame, const Vec3d& p) {
  return frame.center + frame.world_from_object * p;
}

Vec3d OnRim(RandomStream& random, double radius, double z) {
  const double angle_rad = random.Below(16) * (std::numbers::pi / 8);
  return {radius * std::cos(angle_rad), radius * std::sin(angle_rad), z};
}

// Corners, and dyadic points on edges, per kind of shape.
struct FeatureOf {
  RandomStream& random;

  Vec3d operator()(const SphereShape& sphere) const {
    // Corners of its patches, and where patches' sides meet the axes.
    const Vec3d p{random.Sign(), random.Sign(), random.Sign() * random.Below(2)};
    return FromObjectSpace(sphere.frame, Normalized(p));
  }
  Vec3d operator()(const BoxShape& box) const {
    Vec3d p{random.Sign(), random.Sign(), random.Sign()};
    p[random.Below(3)] = 2 * DyadicOf(random) - 1;
    return FromObjectSpace(box.frame, p);
  }
  Vec3d operator()(const FrustumShape& frustum) const {
    const bool top = random.OneIn(2);
    const double radius = top ? frustum.top_radius : frustum.base_radius;
    return FromObjectSpace(frustum.frame, OnRim(random, radius, top ? 1 : 0));
  }
  Vec3d operator()(const DiscShape& disc) const {
    return FromObjectSpace(disc.frame, OnRim(random, 1, 0));
  }
  Vec3d operator()(const PolygonShape& polygon) const {
    const size_t i = random.Index(polygon.vertices.size());
    const Vec3d& next = polygon.vertices[(i + 1) % polygon.vertices.size()];
    return Between(polygon.vertices[i], next, DyadicOf(random));
  }
  Vec3d operator()(const TriangleShape& triangle) const { return (*this)(triangle.polygon); }
  Vec3d operator()(const PolyhedronShape& polyhedron) const {
    const Vec3d& a = polyhedron.vertices[random.Index(polyhedron.vertices.size())];
    const Vec3d& b = polyhedron.vertices[random.Index(polyhedron.vertices.size())];
    return random.OneIn(2) ? a : Between(a, b, DyadicOf(random));
  }
};

}  // namespace

QueryRays::QueryRays(const Tracer& tracer, std::vector<Camera> views)
    : tracer_(tracer), scene_(tracer.scene()), views_(std::move(views)) {
  for (const Camera& view : views_) eye_rays_.emplace_back(view, 1, 1);
  for (const Object& object : scene_.objects) {
    charts_.emplace_back(object);
    surfaces_.emplace_back(object);
  }
  around_ = scene_.WorldBounds();
  if (around_.IsEmpty()) around_.Add(Vec3d{});
  const Vec3d extent = around_.Extent();
  size_ = Length(extent);
  around_.Add(around_.max + extent * 0.5);
  around_.Add(around_.min - extent * 0.5);
}

size_t QueryRays::AnyObject(RandomStream& random) const {
  return random.Index(scene_.objects.size());
}

Vec3d QueryRays::Feature(size_t object, RandomStream& random) const {
  return std::visit(FeatureOf{random}, scene_.objects[object].shape);
}

// Where rays start: mostly in an eye, so that they meet what views have warmed.
Vec3d QueryRays::Eye(RandomStream& random) const {
  if (!random.OneIn(3)) return views_[random.Index(views_.size())].eye;
  return random.InBox(around_.min, around_.max);
}

Ray QueryRays::Towards(const Vec3d& origin, const Vec3d& target, RandomStream& random) const {
  const Vec3d direction = target - origin;
  if (!(LengthSquared(direction) > 0)) return {origin, random.Direction()};
  return {origin, Normalized(direction)};
}

Ray QueryRays::Random(RandomStream& random) const {
  const int kind = random.Below(8);
  if (kind < 6 || scene_.objects.empty()) {
    const double x = random.Unit();
    return eye_rays_[random.Index(eye_rays_.size())].Through(x, random.Unit());
  }
  if (kind == 6) {
    const Box3& bounds = scene_.objects[AnyObject(random)].bounds;
    return Towards(random.InBox(around_.min, around_.max), random.InBox(bounds.min, bounds.max),
                   random);
  }
  return FromSurface(random);
}

// Rounding decides on which side of the surface it starts.
Ray QueryRays::FromSurface(RandomStream& random) const {
  const double x = random.Unit();
  const Ray ray = eye_rays_[random.Index(eye_rays_.size())].Through(x, random.Unit());
  const Hit hit = tracer_.Intersect(ray.origin, ray.direction, RayStart{});
  return {hit.IsHit() ? hit.point : ray.origin, random.Direction()};
}

Ray QueryRays::AlongLinetreeCorner(RandomStream& random) const {
  const ObjectChart& chart = charts_[AnyObject(random)];
  RayCoords coords;
  for (double& c : coords) c = DyadicOf(random);
  const Ray line = chart.LineOf(random.Below(kFacePairs), coords);
  return {line.origin - line.direction * (size_ * DyadicOf(random)), line.direction};
}

Ray QueryRays::AtSurfaceCorner(RandomStream& random) const {
  const SurfaceChart& chart = surfaces_[AnyObject(random)];
  const SurfacePoint corner{random.Below(chart.patches()), DyadicOf(random), DyadicOf(random)};
  const PatchHull hull = chart.HullOf(corner.patch, CellAt(corner, kMaxSurfaceDepth));
  return Towards(Eye(random), hull.points[random.Index(hull.points.size())], random);
}

// At a face, edge or dyadic point of an object's box, along an axis from a dyadic distance.
Ray QueryRays::AlongAxis(RandomStream& random) const {
  const Box3& bounds = scene_.objects[AnyObject(random)].bounds;
  Vec3d point;
  for (int k = 0; k < 3; ++k) {
    point[k] = bounds.min[k] + (bounds.max[k] - bounds.min[k]) * DyadicOf(random);
  }
  Vec3d direction;
  direction[random.Below(3)] = random.Sign();
  return {point - direction * (size_ * DyadicOf(random)), direction};
}

// From an eye to where the edge of an object's shadow falls.
Ray QueryRays::AtShadowEdge(RandomStream& random) const {
  const Vec3d edge = Feature(AnyObject(random), random);
  if (scene_.lights.empty()) return Towards(Eye(random), edge, random);
  const Light& light = scene_.lights[random.Index(scene_.lights.size())];
  const Vec3d away =
      light.kind == LightKind::kDirectional ? -light.to_light : edge - light.position;
  const Ray beyond = Towards(edge, edge + away, random);
  const Hit hit = tracer_.Intersect(beyond.origin, beyond.direction, RayStart{});
  return Towards(Eye(random), hit.IsHit() ? hit.point : edge, random);
}

Ray QueryRays::Lattice(RandomStream& random) const {
  if (scene_.objects.empty()) return Random(random);
  switch (random.Below(6)) {
    case 0:
      return AlongLinetreeCorner(random);
    case 1:
      return AtSurfaceCorner(random);
    case 2:
      return AlongAxis(random);
    case 3:
      return Towards(Eye(random), Feature(AnyObject(random), random), random);
    case 4: {  // through two objects' edges
      const Vec3d from = Feature(AnyObject(random), random);
      const Vec3d to = Feature(AnyObject(random), random);
      return Towards(from - (to - from) * DyadicOf(random), to, random);
    }
    default:
      return AtShadowEdge(random);
  }
}

Ray QueryRays::Near(const Ray& ray, double step, RandomStream& random) const {
  const Hit hit = tracer_.Intersect(ray.origin, ray.direction, RayStart{});
  const double distance = hit.IsHit() ? hit.t : size_;
  const int what = random.Below(3);
  Vec3d origin = ray.origin;
  Vec3d target = ray.origin + ray.direction * distance;
  if (what != 0) origin = origin + random.Direction() * (step * size_);
  if (what != 1) target = target + random.Direction() * (step * std::min(distance, size_));
  return Towards(origin, target, random);
}

}  // namespace linetree
