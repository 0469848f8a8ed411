// One row per rule of a shape; then what the right ones become.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/io/scene_fixture.h"

namespace linetree {
namespace {

struct Rule {
  const char* name;
  const char* shape;  // stands at 2:25
  const char* message;
};

class ShapeRule : public testing::TestWithParam<Rule> {};

TEST_P(ShapeRule, IsRefusedWithItsPlace) {
  const auto scene = BuildText(WithShape(GetParam().shape));
  ASSERT_FALSE(scene.ok());
  EXPECT_EQ(scene.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(scene.status().message()), testing::StartsWith(GetParam().message));
}

const auto kName = [](const auto& info) { return std::string(info.param.name); };

INSTANTIATE_TEST_SUITE_P(
    Curved, ShapeRule,
    testing::Values(
        Rule{"SphereNoRadius", "sphere { center { x: 1 } }",
             "s.textproto:2:25: objects[0].sphere.radius: expected a finite number > 0, got 0"},
        Rule{"SphereNegativeRadius", "sphere { radius: -1 }",
             "s.textproto:2:34: objects[0].sphere.radius: expected a finite number > 0, got -1"},
        Rule{"SphereNanRadius", "sphere { radius: nan }",
             "s.textproto:2:34: objects[0].sphere.radius: expected a finite number > 0, got nan"},
        Rule{"SphereInfiniteRadius", "sphere { radius: inf }",
             "s.textproto:2:34: objects[0].sphere.radius: expected a finite number > 0, got inf"},
        Rule{"SphereTinyRadius", "sphere { radius: 1e-31 }",
             "s.textproto:2:34: objects[0].sphere.radius: expected a number in [1e-30, 1e+30]"},
        Rule{"SphereNanCenter", "sphere { radius: 1 center { z: nan } }",
             "s.textproto:2:44: objects[0].sphere.center: expected finite coordinates of magnitude "
             "<= 1e+30, got (0, 0, nan)"},
        Rule{"EllipsoidFlat", "ellipsoid { semi_axes { x: 1 y: 1 } }",
             "s.textproto:2:37: objects[0].ellipsoid.semi_axes.z: expected a finite number > 0"},
        Rule{"EllipsoidNegative", "ellipsoid { semi_axes { x: 1 y: -2 z: 1 } }",
             "s.textproto:2:54: objects[0].ellipsoid.semi_axes.y: expected a finite number > 0, "
             "got -2"},
        Rule{"EllipsoidCenter", "ellipsoid { center { x: inf } semi_axes { x: 1 y: 1 z: 1 } }",
             "s.textproto:2:37: objects[0].ellipsoid.center: expected finite"},
        Rule{"BoxEmpty", "box { min { x: 1 } max { x: 1 y: 1 z: 1 } }",
             "s.textproto:2:50: objects[0].box.max.x: expected more than min.x = 1, got 1"},
        Rule{"BoxTurned", "box { min { z: 2 } max { x: 1 y: 1 z: 1 } }",
             "s.textproto:2:60: objects[0].box.max.z: expected more than min.z = 2, got 1"},
        Rule{"BoxNan", "box { min { y: nan } max { x: 1 y: 1 z: 1 } }",
             "s.textproto:2:31: objects[0].box.min: expected finite"},
        Rule{"CylinderNoLength", "cylinder { base { x: 1 } top { x: 1 } radius: 1 }",
             "s.textproto:2:50: objects[0].cylinder.top: expected a point other than base, got (1, "
             "0, 0)"},
        Rule{"CylinderRadius", "cylinder { top { x: 1 } radius: 0 }",
             "s.textproto:2:49: objects[0].cylinder.radius: expected a finite number > 0, got 0"},
        Rule{"CylinderBase", "cylinder { base { x: nan } top { x: 1 } radius: 1 }",
             "s.textproto:2:36: objects[0].cylinder.base: expected finite"},
        Rule{"ConeNoRadii", "cone { top { x: 1 } }",
             "s.textproto:2:25: objects[0].cone.base_radius: expected a finite number > 0, got 0"},
        Rule{
            "ConeNegative", "cone { top { x: 1 } base_radius: 1 top_radius: -0.5 }",
            "s.textproto:2:60: objects[0].cone.top_radius: expected a finite number > 0, got -0.5"},
        Rule{
            "ConeNan", "cone { top { x: 1 } base_radius: nan top_radius: 1 }",
            "s.textproto:2:45: objects[0].cone.base_radius: expected a finite number > 0, got nan"},
        Rule{"ConeNoLength", "cone { base_radius: 1 }",
             "s.textproto:2:25: objects[0].cone.top: expected a point other than base"},
        Rule{"DiscNormal", "disc { radius: 1 }",
             "s.textproto:2:25: objects[0].disc.normal: expected a finite, non-zero vector, got "
             "(0, 0, 0)"},
        Rule{"DiscRadius", "disc { normal { x: 1 } radius: -1 }",
             "s.textproto:2:48: objects[0].disc.radius: expected a finite number > 0, got -1"},
        Rule{"DiscCenter", "disc { center { x: nan } normal { x: 1 } radius: 1 }",
             "s.textproto:2:32: objects[0].disc.center: expected finite"}),
    kName);

constexpr const char* kTwoCorners = "vertices { } vertices { x: 1 } ";

INSTANTIATE_TEST_SUITE_P(
    Planar, ShapeRule,
    testing::Values(
        Rule{"PolygonFew", "polygon { vertices { } vertices { x: 1 } }",
             "s.textproto:2:35: objects[0].polygon.vertices: expected at least 3, got 2"},
        Rule{"PolygonLine", "polygon { vertices { } vertices { x: 1 } vertices { x: 2 } }",
             "s.textproto:2:35: objects[0].polygon.vertices: expected a polygon with an area"},
        Rule{"PolygonNan", "polygon { vertices { } vertices { x: 1 } vertices { y: nan } }",
             "s.textproto:2:66: objects[0].polygon.vertices[2]: expected finite coordinates"},
        Rule{"PolygonBent",
             "polygon { vertices { } vertices { x: 1 } vertices { x: 1 y: 1 z: 0.1 } vertices { y: "
             "1 } }",
             "s.textproto:2:48: objects[0].polygon.vertices[1]: expected a point in the polygon's "
             "plane"},
        Rule{
            "PolygonBowTie",
            "polygon { vertices { } vertices { x: 2 y: 1 } vertices { x: 2 } vertices { y: 2 } }",
            "s.textproto:2:35: objects[0].polygon.vertices: expected a polygon that does not cross "
            "itself"},
        Rule{"TriangleFew", "triangle { vertices { } vertices { x: 1 } }",
             "s.textproto:2:36: objects[0].triangle.vertices: expected 3, got 2"},
        Rule{"TriangleLine", "triangle { vertices { } vertices { x: 1 } vertices { x: 3 } }",
             "s.textproto:2:36: objects[0].triangle.vertices: expected a polygon with an area"},
        Rule{"TriangleNormals",
             "triangle { vertices { } vertices { x: 1 } vertices { y: 3 } normals { z: 1 } }",
             "s.textproto:2:85: objects[0].triangle.normals: expected 0 or 3, got 1"},
        Rule{"TriangleZeroNormal",
             "triangle { vertices { } vertices { x: 1 } vertices { y: 3 } normals { z: 1 } "
             "normals { } normals { z: 1 } }",
             "s.textproto:2:102: objects[0].triangle.normals[1]: expected a finite, non-zero"}),
    kName);

#define SLAB "half_spaces { normal { x: 1 } offset: 1 } half_spaces { normal { x: -1 } offset: 1 } "
#define TUBE \
  SLAB "half_spaces { normal { y: 1 } offset: 1 } half_spaces { normal { y: -1 } offset: 1 } "

INSTANTIATE_TEST_SUITE_P(
    Polyhedra, ShapeRule,
    testing::Values(
        Rule{"Few", "polyhedron { " SLAB "}",
             "s.textproto:2:38: objects[0].polyhedron.half_spaces: expected at least 4, got 2"},
        Rule{"ZeroNormal", "polyhedron { half_spaces { } " TUBE "}",
             "s.textproto:2:38: objects[0].polyhedron.half_spaces[0].normal: expected a finite, "
             "non-zero"},
        Rule{"NanOffset", "polyhedron { half_spaces { normal { x: 1 } offset: nan } " TUBE "}",
             "s.textproto:2:68: objects[0].polyhedron.half_spaces[0].offset: expected a finite "
             "number"},
        Rule{"UnboundedTube", "polyhedron { " TUBE "}",
             "s.textproto:2:38: objects[0].polyhedron.half_spaces: expected a bounded set"},
        Rule{"UnboundedHalfTube",
             "polyhedron { " TUBE "half_spaces { normal { z: 1 } offset: 1 } }",
             "s.textproto:2:38: objects[0].polyhedron.half_spaces: expected a bounded set"},
        Rule{"Slabs", "polyhedron { " SLAB SLAB "}",
             "s.textproto:2:38: objects[0].polyhedron.half_spaces: expected a bounded set"},
        Rule{"Empty",
             "polyhedron { " TUBE
             "half_spaces { normal { z: 1 } offset: 1 } half_spaces { normal { z: -1 } offset: -2 "
             "} }",
             "s.textproto:2:38: objects[0].polyhedron.half_spaces: expected a bounded set of "
             "points with an interior"},
        Rule{"Flat",
             "polyhedron { " TUBE
             "half_spaces { normal { z: 1 } offset: 1 } half_spaces { normal { z: -1 } offset: -1 "
             "} }",
             "s.textproto:2:38: objects[0].polyhedron.half_spaces: expected a bounded set of "
             "points with an interior"}),
    kName);

TEST(BuildShape, ConcavePolygonsBecomeNumberedPieces) {
  const std::string arrow =
      "objects { name: \"arrow\" material: \"m\" polygon { vertices { } vertices { x: 2 } "
      "vertices { x: 1 y: 0.2 } vertices { x: 1 y: 2 } } }";
  const auto scene = BuildText(WithMaterial(arrow));
  ASSERT_TRUE(scene.ok()) << scene.status();
  ASSERT_EQ((*scene)->objects.size(), 2u);
  EXPECT_EQ((*scene)->objects[0].name, "arrow/0");
  EXPECT_EQ((*scene)->objects[1].name, "arrow/1");

  const auto clash = BuildText(
      WithMaterial("objects { name: \"arrow/1\" material: \"m\" sphere { radius: 1 } }\n" + arrow));
  EXPECT_THAT(std::string(clash.status().message()),
              testing::StartsWith("s.textproto:3:11: objects[1].name: expected a name that no "
                                  "other has, got 'arrow/1' again"));
}

TEST(BuildShape, EveryShapeIsBuilt) {
  const auto shape_of = [](const std::string& text) {
    const auto scene = BuildText(WithShape(text));
    EXPECT_TRUE(scene.ok()) << scene.status();
    return (*scene)->objects.at(0).shape;
  };
  EXPECT_TRUE(std::holds_alternative<SphereShape>(shape_of("sphere { radius: 2 }")));
  EXPECT_TRUE(
      std::holds_alternative<SphereShape>(shape_of("ellipsoid { semi_axes { x: 1 y: 2 z: 3 } }")));
  EXPECT_TRUE(std::holds_alternative<BoxShape>(shape_of("box { max { x: 1 y: 2 z: 3 } }")));
  const auto cylinder =
      std::get<FrustumShape>(shape_of("cylinder { top { x: 1 } radius: 2 open: true }"));
  EXPECT_TRUE(cylinder.open);
  EXPECT_EQ(cylinder.base_radius, cylinder.top_radius);
  const auto cone = std::get<FrustumShape>(shape_of("cone { top { x: 1 } base_radius: 2 }"));
  EXPECT_FALSE(cone.open);
  EXPECT_EQ(cone.base_radius, 1);
  EXPECT_EQ(cone.top_radius, 0);
  EXPECT_TRUE(std::holds_alternative<DiscShape>(shape_of("disc { normal { x: 1 } radius: 1 }")));
  const std::string corners = std::string(kTwoCorners) + "vertices { y: 1 } ";
  EXPECT_TRUE(std::holds_alternative<PolygonShape>(shape_of("polygon { " + corners + "}")));
  EXPECT_TRUE(std::holds_alternative<PolygonShape>(shape_of("triangle { " + corners + "}")));
  EXPECT_TRUE(std::holds_alternative<TriangleShape>(shape_of(
      "triangle { " + corners + "normals { z: 1 } normals { z: 1 } normals { x: 1 z: 1 } }")));
  EXPECT_TRUE(std::holds_alternative<PolyhedronShape>(
      shape_of("polyhedron { " TUBE "half_spaces { normal { z: 1 } offset: 1 } half_spaces { "
               "normal { z: -1 } } }")));
}

}  // namespace
}  // namespace linetree
