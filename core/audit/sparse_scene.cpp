#include "core/audit/sparse_scene.h"

#include <numbers>
#include <vector>

#include "core/audit/scene_parts.h"

namespace linetree {
namespace {

constexpr double kExponents[] = {10, 20, 40, 80, 160};

Rgb Grey(double value) { return {value, value, value}; }

enum class Finish { kMatte, kGlossy, kMirror, kGlass };

Finish SomeFinish(RandomStream& random, SparseFamily family, bool may_transmit) {
  if (family == SparseFamily::kEven) return static_cast<Finish>(random.Below(may_transmit ? 4 : 3));
  const double u = random.Unit();
  if (u < 0.3) return Finish::kMatte;
  if (u < 0.6) return Finish::kGlossy;
  return u < 0.82 ? Finish::kMirror : Finish::kGlass;
}

Material SomeMaterial(RandomStream& random, SparseFamily family, bool may_transmit) {
  Material material;
  const Rgb colour = random.RandomRgb(0.15, 1);
  double diffuse = random.Uniform(0.3, 0.8);
  material.exponent = kExponents[random.Below(5)];
  material.ambient = Scaled(colour, 0.15);
  const bool glossy = random.OneIn(2);
  switch (SomeFinish(random, family, may_transmit)) {
    case Finish::kMatte:
      break;
    case Finish::kGlossy:
      material.specular = Grey(random.Uniform(0.2, 0.8));
      break;
    case Finish::kMirror:
      diffuse *= 0.4;
      material.reflect = Grey(random.Uniform(0.2, 0.9));
      if (glossy) material.specular = Grey(0.5);
      break;
    case Finish::kGlass:
      diffuse *= 0.15;
      material.transmit = Grey(random.Uniform(0.5, 0.9));
      material.ior = random.Uniform(1.1, 1.7);
      if (random.OneIn(2)) material.reflect = Grey(0.1);
      if (glossy) material.specular = Grey(0.5);
      break;
  }
  material.diffuse = Scaled(colour, diffuse);
  return material;
}

// For what is not solid: of opaque scenes' glass, which reflects `reflect` instead.
Material SomeSheet(RandomStream& random, SparseFamily family, double reflect) {
  Material material = SomeMaterial(random, family, false);
  if (!IsBlack(material.transmit)) {
    material.transmit = {};
    material.reflect = Grey(reflect);
  }
  return material;
}

// Of a floor or wall; in opaque scenes a mirror every other time, whatever it was.
Material SomeGround(RandomStream& random, SparseFamily family, double reflect) {
  Material material = SomeSheet(random, family, 0);
  if (family == SparseFamily::kOpaque && IsBlack(material.reflect) && random.OneIn(2)) {
    material.reflect = Grey(reflect);
  }
  return material;
}

struct Ball {
  Vec3d center;
  double radius;
};

std::vector<Ball> PlaceApart(RandomStream& random, size_t count) {
  std::vector<Ball> balls;
  for (int tries = 0; tries < 2000 && balls.size() < count; ++tries) {
    const double r = random.Uniform(0.3, 1.1);
    const Ball ball{random.InBox({-3, -3, r - 0.99}, {3, 3, 2.5}), r};
    bool fits = true;
    for (const Ball& other : balls) {
      fits = fits && Length(ball.center - other.center) > 1.02 * (ball.radius + other.radius);
    }
    if (fits) balls.push_back(ball);
  }
  return balls;
}

// An orthonormal frame at random.
struct Axes {
  Vec3d u, v, w;
};
Axes SomeAxes(RandomStream& random) {
  const Vec3d u = random.Direction();
  Vec3d v = Cross(u, random.Direction());
  while (!(Length(v) > 0.1)) v = Cross(u, random.Direction());
  v = Normalized(v);
  return {u, v, Cross(u, v)};
}

void AddInside(SceneSetter& setter, SparseFamily family, const Ball& ball) {
  RandomStream& random = setter.random();
  const auto some_solid = [&] { return setter.AddMaterial(SomeMaterial(random, family, true)); };
  const Axes axes = SomeAxes(random);
  const double r = ball.radius;
  switch (random.Below(6)) {
    case 0:
    case 1:
      setter.AddSphere(ball.center, r, some_solid());
      break;
    case 2:
      if (family == SparseFamily::kOpaque) {
        const double a = r * random.Uniform(0.4, 1), b = r * random.Uniform(0.4, 1);
        const AffineMap turned = {Mat3{{axes.u, axes.v, axes.w}}, ball.center};
        setter.AddObject(MakeEllipsoid({}, {a, b, r}, turned), some_solid());
      } else {
        setter.AddSphere(ball.center, r, some_solid());
      }
      break;
    case 3: {
      std::vector<HalfSpace> sides;
      for (const Vec3d& axis : {axes.u, axes.v, axes.w}) {
        const double half = r * random.Uniform(0.3, 0.57), at = Dot(axis, ball.center);
        sides.push_back({axis, at + half});
        sides.push_back({-axis, half - at});
      }
      setter.AddObject(MakePolyhedron(sides), some_solid());
      break;
    }
    case 4: {
      const double angle_rad = random.Uniform(0.3, 1.2);
      const Vec3d half = axes.u * (r * std::cos(angle_rad));
      const double radius = r * std::sin(angle_rad);
      setter.AddFrustum({ball.center - half, ball.center + half, radius, radius, false},
                        some_solid());
      break;
    }
    case 5: {
      std::vector<Vec3d> vertices;
      const int count = 3 + random.Below(4);
      for (int k = 0; k < count; ++k) {
        const double angle_rad = 2 * std::numbers::pi * (k + 0.5) / count;
        vertices.push_back(ball.center + axes.u * (r * std::cos(angle_rad)) +
                           axes.v * (r * std::sin(angle_rad)));
      }
      setter.AddPolygon(vertices, setter.AddMaterial(SomeSheet(random, family, 0.4)));
      break;
    }
  }
}

}  // namespace

std::shared_ptr<const Scene> MakeSparseScene(SparseFamily family, uint64_t seed) {
  auto scene = std::make_shared<Scene>();
  RandomStream random(seed);
  scene->ambient = Grey(1);
  scene->background = {0.3, 0.4, 0.5};
  SceneSetter setter(*scene, random, 1, {});
  for (const Ball& ball : PlaceApart(random, 4 + random.Index(8))) AddInside(setter, family, ball);
  setter.AddPolygon({{-6, -6, -1}, {6, -6, -1}, {6, 6, -1}, {-6, 6, -1}},
                    setter.AddMaterial(SomeGround(random, family, 0.3)));
  if (random.OneIn(2)) {
    setter.AddPolygon({{-6, 6.02, -0.98}, {6, 6.02, -0.98}, {6, 6.02, 6}, {-6, 6.02, 6}},
                      setter.AddMaterial(SomeGround(random, family, 0.6)));
  }
  const int lights = 1 + random.Below(3);
  for (int i = 0; i < lights; ++i) {
    const Vec3d position = random.InBox({-5, -5, 3.8}, {5, 5, 7});
    setter.AddPointLight(position, Scaled(random.RandomRgb(0.6, 1), 1.56 / lights));
  }
  return scene;
}

}  // namespace linetree
