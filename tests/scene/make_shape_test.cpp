#include "core/scene/make_shape.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

namespace linetree {
namespace {

// A map that shears, mirrors and moves.
const AffineMap kMap{{{Vec3d{1, 0.5, 0}, Vec3d{0, -2, 0.3}, Vec3d{0.2, 0, 3}}}, {7, -8, 9}};

double NormOf(const Mat3& m) {
  return std::sqrt(LengthSquared(m.row[0]) + LengthSquared(m.row[1]) + LengthSquared(m.row[2]));
}

void ExpectInverse(const AffineFrame& frame) {
  const Mat3 product = Product(frame.object_from_world, frame.world_from_object);
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_LE(Length(product.row[i] - Mat3{}.row[i]), 1e-13);
  }
  EXPECT_GT(NormOf(frame.world_from_object), 0);
}

// Object coordinates of the image of `own`, a point in the shape's own coordinates.
Vec3d Canonical(const AffineFrame& frame, const AffineMap& map, const Vec3d& own) {
  return frame.object_from_world * (Apply(map, own) - frame.center);
}

TEST(MakeShape, SphereAndEllipsoidAreUnitSpheres) {
  for (const AffineMap& map : {AffineMap{}, kMap}) {
    const auto sphere = std::get<SphereShape>(*MakeSphere({1, 2, 3}, 0.25, map));
    ExpectInverse(sphere.frame);
    EXPECT_NEAR(Length(Canonical(sphere.frame, map, {1.25, 2, 3})), 1, 1e-14);
    EXPECT_NEAR(Length(Canonical(sphere.frame, map, {1, 2, 3.125})), 0.5, 1e-14);
    const auto egg = std::get<SphereShape>(*MakeEllipsoid({1, 2, 3}, {1, 2, 0.125}, map));
    ExpectInverse(egg.frame);
    EXPECT_NEAR(Length(Canonical(egg.frame, map, {1, 4, 3})), 1, 1e-13);
  }
}

TEST(MakeShape, BoxIsTheUnitCube) {
  for (const AffineMap& map : {AffineMap{}, kMap}) {
    const auto box = std::get<BoxShape>(*MakeBox({1, 2, 3}, {2, 4, 9}, map));
    ExpectInverse(box.frame);
    const Vec3d corner = Canonical(box.frame, map, {2, 2, 9});
    EXPECT_NEAR(Length(corner - Vec3d{1, -1, 1}), 0, 1e-13);
  }
}

TEST(MakeShape, FrustumStandsOnItsBase) {
  const Vec3d base{1, 1, 1}, top{1, 3, 2};
  const Vec3d across = Normalized(Cross(top - base, Vec3d{1, 0, 0}));
  for (const AffineMap& map : {AffineMap{}, kMap}) {
    const auto cone = std::get<FrustumShape>(*MakeFrustum({base, top, 0.5, 2, /*open=*/true}, map));
    ExpectInverse(cone.frame);
    EXPECT_TRUE(cone.open);
    EXPECT_EQ(cone.base_radius, 0.25);
    EXPECT_EQ(cone.top_radius, 1);
    EXPECT_NEAR(Length(Canonical(cone.frame, map, base)), 0, 1e-14);
    EXPECT_NEAR(Length(Canonical(cone.frame, map, top) - Vec3d{0, 0, 1}), 0, 1e-14);
    const Vec3d rim = Canonical(cone.frame, map, top + across * 2);
    EXPECT_NEAR(rim.z, 1, 1e-14);
    EXPECT_NEAR(std::hypot(rim.x, rim.y), 1, 1e-14);
  }
}

TEST(MakeShape, AxesOfAnyDirection) {
  for (int i = 0; i < 200; ++i) {
    const double a = 0.1 * i, b = 0.37 * i;
    const Vec3d axis{std::cos(a) * std::cos(b), std::sin(a) * std::cos(b), std::sin(b)};
    const auto disc = std::get<DiscShape>(*MakeDisc({1, 2, 3}, axis * 1e-200, 2));
    ExpectInverse(disc.frame);
    EXPECT_NEAR(Length(disc.plane.normal - axis), 0, 1e-14);
    EXPECT_NEAR(Length(disc.frame.world_from_object * Vec3d{1, 0, 0}), 2, 1e-14);
    EXPECT_NEAR(Dot(disc.frame.world_from_object * Vec3d{1, 0, 0}, axis), 0, 1e-14);
  }
}

TEST(MakeShape, DiscNormalStaysPerpendicularUnderShear) {
  const auto disc = std::get<DiscShape>(*MakeDisc({1, 0, 0}, {1, 1, 1}, 2, kMap));
  for (const Vec3d& in_plane : {Vec3d{1, -1, 0}, Vec3d{0, 1, -1}}) {
    EXPECT_NEAR(Dot(kMap.linear * in_plane, disc.plane.normal), 0, 1e-14);
  }
  EXPECT_NEAR(SignedDistance(disc.plane, Apply(kMap, {1, 0, 0})), 0, 1e-14);
}

TEST(MakeShape, PolygonsAreMapped) {
  const std::vector<Vec3d> square{{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  const auto polygon = std::get<PolygonShape>(*MakeConvexPolygon(square, kMap));
  ASSERT_EQ(polygon.vertices.size(), 4u);
  for (size_t i = 0; i < 4; ++i) EXPECT_EQ(polygon.vertices[i], Apply(kMap, square[i]));
  const Vec3d middle = Apply(kMap, {0.5, 0.5, 1});
  EXPECT_NEAR(SignedDistance(polygon.plane, middle), 0, 1e-14);
  for (const Plane& edge : polygon.edges) EXPECT_LT(SignedDistance(edge, middle), 0);
  EXPECT_EQ(MakeConvexPolygon({{0, 0, 0}, {2, 0, 0}, {1, 0.2, 0}, {1, 2, 0}}).status().message(),
            "vertices: expected a convex polygon");
}

TEST(MakeShape, TriangleNormalsGoByTheInverseTranspose) {
  const std::vector<Vec3d> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<Vec3d> normals{{0, 0, 2}, {1, 0, 1}, {0, 1, 1}};
  const auto triangle = std::get<TriangleShape>(*MakeTriangle(corners, normals, kMap));
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(Length(triangle.normals[i]), 1, 1e-14);
    // Tangents of the own space stay tangents.
    const Vec3d tangent = Cross(normals[i], Vec3d{0.3, 0.5, -0.7});
    EXPECT_NEAR(Dot(triangle.normals[i], kMap.linear * tangent), 0, 1e-14);
    EXPECT_GT(Dot(triangle.normals[i], kMap.linear * normals[i]), 0);
  }
  EXPECT_TRUE(std::holds_alternative<PolygonShape>(*MakeTriangle(corners, {}, kMap)));
}

std::vector<HalfSpace> Cube() {
  return {{{2, 0, 0}, 2},  {{-1, 0, 0}, 1}, {{0, 1, 0}, 1},
          {{0, -1, 0}, 1}, {{0, 0, 1}, 1},  {{0, 0, -3}, 3}};
}

TEST(MakeShape, PolyhedronCorners) {
  const auto cube = std::get<PolyhedronShape>(*MakePolyhedron(Cube()));
  EXPECT_EQ(cube.faces.size(), 6u);
  ASSERT_EQ(cube.vertices.size(), 8u);
  for (const Vec3d& v : cube.vertices) {
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(std::abs(v[i]), 1, 1e-12);
  }
  // Four faces meet in each corner of an octahedron.
  std::vector<HalfSpace> octahedron;
  for (int i = 0; i < 8; ++i) {
    octahedron.push_back({{i & 1 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, i & 4 ? 1.0 : -1.0}, 1});
  }
  EXPECT_EQ(std::get<PolyhedronShape>(*MakePolyhedron(octahedron)).vertices.size(), 6u);
}

TEST(MakeShape, PolyhedronIsMappedWithItsFaces) {
  auto planes = Cube();
  planes.push_back({{1, 1, 1}, 100});  // touches nothing
  const auto cube = std::get<PolyhedronShape>(*MakePolyhedron(planes, kMap));
  EXPECT_EQ(cube.faces.size(), 7u);
  const Vec3d center = Apply(kMap, {0, 0, 0});
  for (size_t i = 0; i < 6; ++i) {
    EXPECT_LT(SignedDistance(cube.faces[i], center), 0);
    // Each face carries four of the eight corners.
    int on_face = 0;
    for (const Vec3d& v : cube.vertices) {
      EXPECT_LE(SignedDistance(cube.faces[i], v), 1e-12);
      on_face += std::abs(SignedDistance(cube.faces[i], v)) <= 1e-12;
    }
    EXPECT_EQ(on_face, 4);
  }
}

TEST(MakeShape, PolyhedronFarAwayAndSmall) {
  std::vector<HalfSpace> cube;
  for (int i = 0; i < 3; ++i) {
    Vec3d n;
    n[i] = 1;
    cube.push_back({n, 1e6 + 0.001});
    cube.push_back({-n, -1e6 + 0.001});
  }
  const auto shape = MakePolyhedron(cube);
  ASSERT_TRUE(shape.ok()) << shape.status();
  EXPECT_EQ(std::get<PolyhedronShape>(*shape).vertices.size(), 8u);
}

// Many planes touch one sphere: every one carries a face.
TEST(MakeShape, PolyhedronOfManyFaces) {
  std::vector<HalfSpace> planes;
  constexpr int kCount = 256;
  for (int i = 0; i < kCount; ++i) {
    const double z = 1 - (2 * i + 1.0) / kCount;
    const double angle = i * std::numbers::pi * (3 - std::sqrt(5.0));
    const double r = std::sqrt(1 - z * z);
    planes.push_back({{r * std::cos(angle), r * std::sin(angle), z}, 1});
  }
  const auto shape = MakePolyhedron(planes);
  ASSERT_TRUE(shape.ok()) << shape.status();
  // Euler: 2 n - 4 corners when three faces meet in each.
  EXPECT_EQ(std::get<PolyhedronShape>(*shape).vertices.size(), 2u * kCount - 4);
}

TEST(MakeShape, ErrorsNameTheParameter) {
  const auto message = [](const absl::StatusOr<Shape>& shape) {
    EXPECT_EQ(shape.status().code(), absl::StatusCode::kInvalidArgument);
    return std::string(shape.status().message());
  };
  EXPECT_EQ(message(MakeSphere({0, 0, 0}, -1)), "radius: expected a finite number > 0, got -1");
  EXPECT_THAT(message(MakeSphere({NAN, 0, 0}, 1)), testing::StartsWith("center: expected finite"));
  EXPECT_THAT(message(MakeSphere({0, 0, 0}, 1, Scaling({1, 1, 0}))),
              testing::StartsWith("transform: expected an invertible map"));
  EXPECT_THAT(message(MakeSphere({0, 0, 0}, 1e-29, Scaling({1e-9, 1e-9, 1e-9}))),
              testing::StartsWith("transform: expected a map that keeps"));
  EXPECT_THAT(message(MakeTriangle({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{1, 0, 0}})),
              testing::StartsWith("normals: expected 0 or 3"));
}

}  // namespace
}  // namespace linetree
