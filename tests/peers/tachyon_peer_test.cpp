// Tachyon's pictures of what its shading can express, against the classical tracer's.
#include "peers/tachyon_peer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "peers/classical_peer.h"
#include "peers/picture_difference.h"
#include "tests/io/scene_fixture.h"

namespace linetree {
namespace {

constexpr int kWidth = 120, kHeight = 90;

// Both programs' pictures of the scene's first camera.
struct Pair {
  PictureDifference difference;
  std::vector<std::string> differences;
};
Pair Render(const std::shared_ptr<const Scene>& scene, int threads = 1) {
  const PeerSetup setup{scene, {.max_depth = 4, .min_weight = 0}, threads};
  const auto classical = MakeClassicalPeer(setup), tachyon = MakeTachyonPeer(setup);
  EXPECT_TRUE(classical.ok() && tachyon.ok()) << tachyon.status();
  if (!tachyon.ok()) return {};
  const auto expected = (*classical)->Render(scene->cameras.at(0), kWidth, kHeight);
  const auto found = (*tachyon)->Render(scene->cameras.at(0), kWidth, kHeight);
  EXPECT_TRUE(expected.ok() && found.ok()) << found.status();
  if (!found.ok()) return {};
  EXPECT_GE(found->seconds, 0);
  return {DifferenceOf(found->radiance, expected->radiance), found->differences};
}

// Everything that Tachyon has: round shapes, plane ones, smooth triangles, both kinds of light, a
// fading one, mirrors, films. The film is grey and dull and the background black.
constexpr char kExpressible[] = R"(
  ambient { r: 0.2 g: 0.19 b: 0.18 }
  materials { name: "floor" ambient { r: 0.5 g: 0.5 b: 0.4 } diffuse { r: 0.5 g: 0.5 b: 0.4 } }
  materials { name: "red" ambient { r: 0.6 g: 0.2 b: 0.2 } diffuse { r: 0.6 g: 0.2 b: 0.2 } }
  materials { name: "mirror" ambient { r: 0.1 g: 0.1 b: 0.1 } diffuse { r: 0.2 g: 0.2 b: 0.2 }
    reflect { r: 0.5 g: 0.5 b: 0.5 } }
  materials { name: "film" diffuse { r: 0.1 g: 0.1 b: 0.1 } transmit { r: 0.6 g: 0.6 b: 0.6 } }
  lights { irradiance { r: 0.4 g: 0.4 b: 0.35 } point { position { x: 3 y: 6 z: 5 } fade_distance: 8 } }
  lights { irradiance { r: 0.2 g: 0.2 b: 0.25 } directional { direction { x: 1 y: -2 z: -1 } } }
  objects { material: "floor" polygon { vertices { x: -9 z: 5 } vertices { x: 9 z: 5 }
    vertices { x: 9 z: -9 } vertices { x: -9 z: -9 } } }
  objects { material: "mirror" sphere { center { x: -1.2 y: 1.001 } radius: 1 } }
  objects { material: "red" cylinder { base { x: 1 y: 0.001 z: -1 } top { x: 1 y: 1.8 z: -1 } radius: 0.5 } }
  objects { material: "red" cylinder { base { x: 2.4 y: 0.3 z: 0 } top { x: 2.9 y: 1.5 z: 0.4 } radius: 0.3 open: true } }
  objects { material: "red" box { min { x: 0.2 y: 0.001 z: 1 } max { x: 0.9 y: 0.6 z: 1.6 } }
    transform { rotate { axis { y: 1 } angle_deg: 25 } } }
  objects { material: "floor" disc { center { x: -2.4 y: 2.4 z: -1.5 } normal { x: 0.3 z: 1 } radius: 0.6 } }
  objects { material: "film" polygon { vertices { x: -0.9 y: 0.2 z: 2 } vertices { x: 0.1 y: 0.2 z: 2.2 }
    vertices { x: 0.1 y: 1.6 z: 2.2 } vertices { x: -0.9 y: 1.6 z: 2 } } }
  objects { material: "red" polyhedron {
    half_spaces { normal { x: 1 } offset: -2.5 } half_spaces { normal { x: -1 } offset: 3.1 }
    half_spaces { normal { y: 1 z: 1 } offset: 2 } half_spaces { normal { y: -1 } offset: -0.001 }
    half_spaces { normal { z: -1 } offset: -0.5 } } }
  cameras { eye { x: 0.3 y: 2.2 z: 7 } look_at { y: 0.9 } up { x: 0.1 y: 1 } fov_deg: 48 }
)";

// Edges fall on either side of a pixel's centre, whose position Tachyon computes from numbers in
// float; where light grazes, Tachyon leaves out what is below 1/512 of it. Of 10,800 pixels a few
// at most lie that close to an edge.
constexpr double kShareAtEdges = 0.001;

TEST(TachyonPeer, RendersWhatItCanExpressAsTheClassicalTracerDoes) {
  const auto scene = BuildText(kExpressible);
  ASSERT_TRUE(scene.ok()) << scene.status();
  const Pair pair = Render(*scene);
  std::printf("%.3f %% of the pixels differ, rms %.2g\n", 100 * pair.difference.share_beyond_code,
              pair.difference.rms);
  EXPECT_LE(pair.difference.share_beyond_code, kShareAtEdges);
  // The order of paths' ends is told even where the background is black.
  EXPECT_THAT(pair.differences, testing::SizeIs(testing::Le(1)));
}

// A polygon of 64 sides for a circle is off by 0.0012 of its radius, a tenth of a pixel here, and
// its shadow as much: pixels at outlines differ, others hardly.
constexpr double kShareAtOutlines = 0.02;

TEST(TachyonPeer, MeshesComeNearToCurvedShapes) {
  const auto scene = BuildText(R"(
    background { r: 0.1 g: 0.1 b: 0.2 }
    ambient { r: 0.2 g: 0.2 b: 0.2 }
    materials { name: "m" ambient { r: 0.5 g: 0.5 b: 0.4 } diffuse { r: 0.5 g: 0.5 b: 0.4 } }
    lights { irradiance { r: 0.8 g: 0.8 b: 0.8 } point { position { x: 3 y: 6 z: 5 } } }
    objects { material: "m" cone { base { x: -2 } top { x: -2 y: 2 } base_radius: 0.9 } }
    objects { material: "m" cone { base { y: 1.9 } top { y: 0.1 z: 0.5 } base_radius: 0.9 top_radius: 0.4 open: true } }
    objects { material: "m" ellipsoid { center { x: 2 y: 1 } semi_axes { x: 0.7 y: 1 z: 0.5 } } }
    objects { material: "m" disc { center { y: -0.5 } normal { y: 1 } radius: 1 }
      transform { scale { x: 3 y: 1 z: 2 } } }
    cameras { eye { x: 0.3 y: 3 z: 7 } look_at { y: 0.9 } fov_deg: 48 }
  )");
  ASSERT_TRUE(scene.ok()) << scene.status();
  const Pair pair = Render(*scene, 2);
  std::printf("%.3f %% of the pixels differ, rms %.2g\n", 100 * pair.difference.share_beyond_code,
              pair.difference.rms);
  EXPECT_LE(pair.difference.share_beyond_code, kShareAtOutlines);
  EXPECT_THAT(pair.differences, testing::Contains(testing::HasSubstr("4 curved objects")));
}

}  // namespace
}  // namespace linetree
