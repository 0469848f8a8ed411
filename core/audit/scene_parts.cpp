#include "core/audit/scene_parts.h"

#include <numbers>
#include <utility>

#include "core/math/check.h"

namespace linetree {
namespace {

// Largest over smallest stretch of a random map.
constexpr double kMaxStretch = 4;
// Corners of random polygons are at least this far apart on their circle.
constexpr double kMinGap_rad = 0.2;

// Points on the unit circle in the plane z = 0, counter-clockwise.
std::vector<Vec3d> RandomLoop(RandomStream& random, int count) {
  std::vector<double> gaps;
  double sum = 0;
  for (int i = 0; i < count; ++i) sum += gaps.emplace_back(random.Uniform(0.01, 1));
  const double spare_rad = 2 * std::numbers::pi - count * kMinGap_rad;
  std::vector<Vec3d> loop;
  double angle_rad = random.Uniform(0, 6);
  for (const double gap : gaps) {
    loop.push_back({std::cos(angle_rad), std::sin(angle_rad), 0});
    angle_rad += kMinGap_rad + spare_rad * gap / sum;
  }
  return loop;
}

// A cube whose corners and edges are cut off.
std::vector<HalfSpace> RandomHalfSpaces(RandomStream& random) {
  std::vector<HalfSpace> half_spaces;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      Vec3d normal;
      normal[axis] = sign;
      half_spaces.push_back({normal, random.Uniform(0.7, 1)});
    }
  }
  for (int i = random.Below(8); i > 0; --i) {
    half_spaces.push_back({random.Direction(), random.Uniform(0.6, 0.9)});
  }
  return half_spaces;
}

absl::StatusOr<Shape> FrustumOf(double base_radius, double top_radius, bool open,
                                const AffineMap& map) {
  return MakeFrustum({{0, 0, -0.7}, {0, 0, 0.7}, base_radius, top_radius, open}, map);
}

absl::StatusOr<Shape> ConeOf(RandomStream& random, bool open, const AffineMap& map) {
  const bool apex_up = random.OneIn(2);
  return FrustumOf(apex_up ? 0.7 : 0, apex_up ? 0 : 0.7, open, map);
}

absl::StatusOr<Shape> SmoothTriangleOf(RandomStream& random, const AffineMap& map) {
  std::vector<Vec3d> normals;
  for (int i = 0; i < 3; ++i) normals.push_back(Vec3d{0, 0, 1} + random.InCube(0.4));
  return MakeTriangle(RandomLoop(random, 3), normals, map);
}

absl::StatusOr<Shape> ShapeOf(ShapeSort sort, RandomStream& random, const AffineMap& map) {
  switch (sort) {
    case ShapeSort::kSphere:
      return MakeSphere({}, 1, map);
    case ShapeSort::kEllipsoid:
      return MakeEllipsoid({}, {random.Uniform(0.2, 1), random.Uniform(0.2, 1), 1}, map);
    case ShapeSort::kBox:
      return MakeBox({-0.6, -0.6, -0.6}, {0.6, 0.6, 0.6}, map);
    case ShapeSort::kCylinder:
      return FrustumOf(0.7, 0.7, false, map);
    case ShapeSort::kCone:
      return ConeOf(random, false, map);
    case ShapeSort::kFrustum:
      return FrustumOf(random.Uniform(0.1, 0.9), random.Uniform(0.1, 0.9), false, map);
    case ShapeSort::kOpenCylinder:
      return FrustumOf(0.7, 0.7, true, map);
    case ShapeSort::kOpenCone:
      return ConeOf(random, true, map);
    case ShapeSort::kDisc:
      return MakeDisc({}, {0, 0, 1}, 1, map);
    case ShapeSort::kPolygon:
      return MakeConvexPolygon(RandomLoop(random, 3 + random.Below(8)), map);
    case ShapeSort::kTriangle:
      return MakeTriangle(RandomLoop(random, 3), {}, map);
    case ShapeSort::kSmoothTriangle:
      return SmoothTriangleOf(random, map);
    case ShapeSort::kPolyhedron:
      return MakePolyhedron(RandomHalfSpaces(random), map);
  }
  LT_CHECK(false);
}

}  // namespace

SceneSetter::SceneSetter(Scene& scene, RandomStream& random, double scale, const Vec3d& offset)
    : scene_(scene),
      random_(random),
      scale_(scale),
      placement_(Then(Scaling({scale, scale, scale}), Translation(offset))) {}

int SceneSetter::AddMaterial(const Material& material) {
  scene_.materials.push_back(material);
  return static_cast<int>(scene_.materials.size()) - 1;
}

int SceneSetter::AddObject(absl::StatusOr<Shape> shape, int material) {
  LT_CHECK(shape.ok());
  Object object;
  object.material = material;
  object.bounds = Bounds(*shape);
  object.shape = *std::move(shape);
  scene_.objects.push_back(std::move(object));
  return static_cast<int>(scene_.objects.size()) - 1;
}

void SceneSetter::AddSphere(const Vec3d& center, double radius, int material) {
  AddObject(MakeSphere(center, radius, placement_), material);
}

void SceneSetter::AddBox(const Vec3d& low, const Vec3d& high, int material) {
  AddObject(MakeBox(low, high, placement_), material);
}

void SceneSetter::AddPolygon(const std::vector<Vec3d>& vertices, int material) {
  AddObject(MakeConvexPolygon(vertices, placement_), material);
}

void SceneSetter::AddFrustum(const FrustumParameters& parameters, int material) {
  AddObject(MakeFrustum(parameters, placement_), material);
}

AffineMap SceneSetter::RandomMap(double size, const Vec3d& center) {
  AffineMap map;
  if (random_.OneIn(3)) {  // upright and not sheared: what people write
    map = Scaling({size, size, size});
  } else {
    const AffineMap first = Rotation(random_.Direction(), random_.Uniform(0, 360));
    Vec3d stretch;
    for (int k = 0; k < 3; ++k) stretch[k] = size * random_.LogUniform(1 / kMaxStretch, 1);
    const AffineMap last = Rotation(random_.Direction(), random_.Uniform(0, 360));
    map = Then(Then(first, Scaling(stretch)), last);
  }
  return Then(Then(map, Translation(center)), placement_);
}

void SceneSetter::AddRandom(ShapeSort sort, const Vec3d& center, double size, int material) {
  const AffineMap map = RandomMap(size, center);
  AddObject(ShapeOf(sort, random_, map), material);
}

void SceneSetter::AddPointLight(const Vec3d& position, const Rgb& irradiance,
                                double fade_distance) {
  Light light;
  light.position = ToWorld(position);
  light.irradiance = irradiance;
  light.fade_distance = fade_distance * scale_;
  scene_.lights.push_back(light);
}

void SceneSetter::AddDirectionalLight(const Vec3d& to_light, const Rgb& irradiance) {
  Light light;
  light.kind = LightKind::kDirectional;
  light.to_light = Normalized(to_light);
  light.irradiance = irradiance;
  scene_.lights.push_back(light);
}

void SceneSetter::AddCamera(const Vec3d& eye, const Vec3d& look_at, double fov_deg) {
  Camera camera;
  camera.eye = ToWorld(eye);
  camera.look_at = ToWorld(look_at);
  camera.up = random_.Direction();
  camera.fov_deg = fov_deg;
  if (ValidateCamera(camera).ok()) scene_.cameras.push_back(camera);
}

Material MatteMaterial(RandomStream& random) {
  Material material;
  material.ambient = random.RandomRgb(0, 0.3);
  material.diffuse = random.RandomRgb(0.1, 0.8);
  return material;
}

Material GlossMaterial(RandomStream& random) {
  Material material = MatteMaterial(random);
  material.specular = random.RandomRgb(0.2, 0.8);
  material.exponent = random.Uniform(40, 160);
  return material;
}

Material MirrorMaterial(RandomStream& random) {
  Material material;
  if (random.OneIn(2)) material = MatteMaterial(random);
  material.reflect = random.RandomRgb(0.3, 0.9);
  return material;
}

Material GlassMaterial(RandomStream& random) {
  Material material;
  if (random.OneIn(4)) material = GlossMaterial(random);
  material.transmit = random.RandomRgb(0.4, 0.95);
  material.ior = random.Uniform(1.05, 2);
  if (random.OneIn(3)) material.reflect = random.RandomRgb(0.05, 0.3);
  return material;
}

Material RandomMaterial(RandomStream& random) {
  Material material;
  material.ambient = random.RandomRgb(0, 0.3);
  if (!random.OneIn(5)) material.diffuse = random.RandomRgb(0, 0.8);
  if (random.OneIn(2)) material.specular = random.RandomRgb(0, 0.5);
  material.exponent = random.Uniform(1, 60);
  if (random.OneIn(3)) material.reflect = random.RandomRgb(0, 0.7);
  if (random.OneIn(3)) {
    material.transmit = random.RandomRgb(0, 0.9);
    material.ior = random.Uniform(1, 1.8);
  }
  return material;
}

}  // namespace linetree
