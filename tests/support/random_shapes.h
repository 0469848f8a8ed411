// Random shapes of every kind under random affine maps.
#pragma once

#include <algorithm>
#include <array>
#include <numbers>
#include <string_view>
#include <vector>

#include "core/scene/affine_map.h"
#include "tests/support/random.h"
#include "tests/support/scene_builder.h"

namespace linetree::test {

enum class ShapeKind {
  kSphere,
  kBox,
  kCylinder,
  kCone,  // with its apex
  kFrustum,
  kOpenCylinder,
  kOpenCone,
  kDisc,
  kPolygon,
  kSmoothTriangle,
  kPolyhedron,
};
inline constexpr std::array kShapeKinds = {
    ShapeKind::kSphere,         ShapeKind::kBox,       ShapeKind::kCylinder,
    ShapeKind::kCone,           ShapeKind::kFrustum,   ShapeKind::kOpenCylinder,
    ShapeKind::kOpenCone,       ShapeKind::kDisc,      ShapeKind::kPolygon,
    ShapeKind::kSmoothTriangle, ShapeKind::kPolyhedron};
inline constexpr std::array<std::string_view, kShapeKinds.size()> kShapeKindNames = {
    "sphere", "box",     "cylinder",        "cone",      "frustum", "open cylinder", "open cone",
    "disc",   "polygon", "smooth triangle", "polyhedron"};
inline std::string_view NameOf(ShapeKind kind) {
  return kShapeKindNames[static_cast<size_t>(kind)];
}

// Largest over smallest stretch of RandomMap.
inline constexpr double kMaxStretch = 4;

// Stretched and sheared about a centre; the largest semi-axis of a unit sphere becomes about
// `size`.
inline AffineMap RandomMap(Random& random, double size, const Vec3d& center) {
  const auto turn = [&] { return Rotation(random.Direction(), random.Uniform(0, 360)); };
  const auto stretch = [&] { return size * random.LogUniform(1 / kMaxStretch, 1); };
  const double x = stretch();
  const double y = stretch();
  const AffineMap first = turn();
  return Then(Then(Then(first, Scaling({x, y, stretch()})), turn()), Translation(center));
}

// Points on the unit circle in the plane z = 0, counter-clockwise, at least min_gap_rad apart.
inline std::vector<Vec3d> RandomLoop(Random& random, int count, double min_gap_rad = 0.2) {
  std::vector<double> gaps;
  double sum = 0;
  for (int i = 0; i < count; ++i) sum += gaps.emplace_back(random.Uniform(0, 1));
  const double free = 2 * std::numbers::pi - count * min_gap_rad;
  std::vector<Vec3d> loop;
  double angle = random.Uniform(0, 6);
  for (const double gap : gaps) {
    loop.push_back({std::cos(angle), std::sin(angle), 0});
    angle += min_gap_rad + free * gap / sum;
  }
  return loop;
}

inline Shape RandomPolyhedron(Random& random, const AffineMap& map) {
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
  return Good(MakePolyhedron(half_spaces, map));
}

// About as large as a unit sphere, under the map.
inline Shape RandomShape(ShapeKind kind, Random& random, const AffineMap& map) {
  const auto frustum = [&](double base_radius, double top_radius, bool open) {
    return Good(MakeFrustum({{0, 0, -0.7}, {0, 0, 0.7}, base_radius, top_radius, open}, map));
  };
  switch (kind) {
    case ShapeKind::kSphere:
      return Good(MakeSphere({}, 1, map));
    case ShapeKind::kBox:
      return Good(MakeBox({-0.6, -0.6, -0.6}, {0.6, 0.6, 0.6}, map));
    case ShapeKind::kCylinder:
    case ShapeKind::kOpenCylinder:
      return frustum(0.7, 0.7, kind == ShapeKind::kOpenCylinder);
    case ShapeKind::kCone:
    case ShapeKind::kOpenCone:
      return random.Below(2) == 0 ? frustum(0.7, 0, kind == ShapeKind::kOpenCone)
                                  : frustum(0, 0.7, kind == ShapeKind::kOpenCone);
    case ShapeKind::kFrustum:
      return frustum(random.Uniform(0.1, 0.9), random.Uniform(0.1, 0.9), false);
    case ShapeKind::kDisc:
      return Good(MakeDisc({}, {0, 0, 1}, 1, map));
    case ShapeKind::kPolygon:
      return Good(MakeConvexPolygon(RandomLoop(random, 3 + random.Below(8)), map));
    case ShapeKind::kSmoothTriangle: {
      std::vector<Vec3d> normals;
      for (int i = 0; i < 3; ++i) normals.push_back(Vec3d{0, 0, 1} + random.InCube(0.4));
      return Good(MakeTriangle(RandomLoop(random, 3), normals, map));
    }
    case ShapeKind::kPolyhedron:
      return RandomPolyhedron(random, map);
  }
  LT_CHECK(false);
}
inline Shape RandomShape(ShapeKind kind, Random& random, double size, const Vec3d& center) {
  return RandomShape(kind, random, RandomMap(random, size, center));
}

}  // namespace linetree::test
