// Random parts of scenes: shapes of every kind, materials, lights; and the hand that puts them into
// a scene.
#pragma once

#include <span>
#include <vector>

#include "core/audit/random_stream.h"
#include "core/scene/affine_map.h"
#include "core/scene/make_shape.h"
#include "core/scene/scene.h"

namespace linetree {

enum class ShapeSort {
  kSphere,
  kEllipsoid,
  kBox,
  kCylinder,
  kCone,  // with its apex
  kFrustum,
  kOpenCylinder,
  kOpenCone,
  kDisc,
  kPolygon,
  kTriangle,
  kSmoothTriangle,
  kPolyhedron,
};
inline constexpr int kShapeSorts = 13;

// Sets a scene up in coordinates of its own, of about unit size; `placement` takes them to the
// world's. The parameters of shapes must be good.
class SceneSetter {
 public:
  // `placement` scales uniformly and moves.
  SceneSetter(Scene& scene, RandomStream& random, double scale, const Vec3d& offset);

  RandomStream& random() { return random_; }
  Scene& scene() { return scene_; }

  int AddMaterial(const Material& material);
  int AddObject(absl::StatusOr<Shape> shape, int material);

  void AddSphere(const Vec3d& center, double radius, int material);
  void AddBox(const Vec3d& low, const Vec3d& high, int material);
  void AddPolygon(const std::vector<Vec3d>& vertices, int material);
  void AddFrustum(const FrustumParameters& parameters, int material);
  // Of size up to `size`, stretched (spheres and boxes not always) and turned.
  void AddRandom(ShapeSort sort, const Vec3d& center, double size, int material);

  void AddPointLight(const Vec3d& position, const Rgb& irradiance, double fade_distance = 0);
  void AddDirectionalLight(const Vec3d& to_light, const Rgb& irradiance);
  void AddCamera(const Vec3d& eye, const Vec3d& look_at, double fov_deg);

  Vec3d ToWorld(const Vec3d& point) const { return Apply(placement_, point); }
  double scale() const { return scale_; }

 private:
  AffineMap RandomMap(double size, const Vec3d& center);

  Scene& scene_;
  RandomStream& random_;
  const double scale_;
  const AffineMap placement_;
};

// Any mixture of terms: matte, glossy, mirror, glass, black.
Material RandomMaterial(RandomStream& random);
Material MatteMaterial(RandomStream& random);
Material MirrorMaterial(RandomStream& random);
Material GlassMaterial(RandomStream& random);
Material GlossMaterial(RandomStream& random);

}  // namespace linetree
