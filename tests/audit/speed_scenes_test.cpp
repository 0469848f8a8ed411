#include "core/audit/speed_scenes.h"

#include <gtest/gtest.h>

#include "core/trace/tracer.h"

namespace linetree {
namespace {

TEST(SpeedScenesTest, HaveWhatWasAskedFor) {
  for (const int objects : {10, 200, 3000}) {
    const auto scene = MakeSpheres(objects, 5);
    EXPECT_EQ(scene->objects.size(), static_cast<size_t>(objects));
    EXPECT_EQ(scene->lights.size(), 5u);
  }
  for (const int objects : {18, 1000}) {
    const auto scene = MakeRoom(objects, 16, false);
    EXPECT_EQ(scene->objects.size(), static_cast<size_t>(objects));
    EXPECT_EQ(scene->lights.size(), 16u);
  }
}

TEST(SpeedScenesTest, AreTheSameEachTime) {
  const auto a = MakeSpheres(100, 3), b = MakeSpheres(100, 3);
  for (size_t i = 0; i < a->objects.size(); ++i) {
    EXPECT_EQ(a->objects[i].shape, b->objects[i].shape);
  }
}

TEST(SpeedScenesTest, SpheresKeepApart) {
  const auto scene = MakeSpheres(200, 1);
  for (size_t i = 1; i < scene->objects.size(); ++i) {
    const Box3& a = scene->objects[i].bounds;
    for (size_t j = i + 1; j < scene->objects.size(); ++j) {
      const Box3& b = scene->objects[j].bounds;
      const double radii = (a.Extent().x + b.Extent().x) / 2;
      ASSERT_GT(Length(a.Center() - b.Center()), radii) << i << ", " << j;
    }
  }
}

TEST(SpeedScenesTest, AGlassRoomSendsRaysThroughItsThings) {
  const auto scene = MakeGlassRoom(40, 3);
  EXPECT_EQ(scene->objects.size(), 40u);
  EXPECT_EQ(scene->lights.size(), 3u);
  const Tracer tracer(*scene);
  const EyeRays rays(scene->cameras[0], 32, 32);
  RayCounts counts;
  for (int p = 0; p < 32 * 32; ++p) {
    const Ray ray = rays.ThroughPixel(p % 32, p / 32);
    tracer.Radiance(ray.origin, ray.direction, {}, counts);
  }
  EXPECT_GT(counts.refracted, counts.eye / 3);
}

TEST(SpeedScenesTest, AreMadeAsWritten) {
  for (const char* text : {"spheres:30:2", "room:30:2", "mirrors:30:2", "glass:30:2"}) {
    const auto made = ParseMadeScene(text);
    ASSERT_TRUE(made.ok()) << made.status();
    EXPECT_EQ(made->Text(), text);
    const auto scene = Make(*made);
    EXPECT_EQ(scene->objects.size(), 30u) << text;
    EXPECT_EQ(scene->lights.size(), 2u) << text;
  }
  EXPECT_EQ(Make(*ParseMadeScene("mirrors:18:1"))->name, "mirror room");
  for (const char* text :
       {"room", "room:1", "room:0:1", "room:1:2000", "cave:3:1", "room:1:1:1", "room:x:1", ""}) {
    EXPECT_TRUE(absl::IsInvalidArgument(ParseMadeScene(text).status())) << text;
  }
}

// The walls of a mirror room send most paths on to the end.
TEST(SpeedScenesTest, MirrorsMakeLongPaths) {
  PathLimits limits;
  limits.max_depth = 8;
  uint64_t reflected[2];
  for (const bool mirrors : {false, true}) {
    const auto scene = MakeRoom(18, 3, mirrors);
    const Tracer tracer(*scene);
    const EyeRays rays(scene->cameras[0], 32, 32);
    RayCounts counts;
    for (int y = 0; y < 32; ++y) {
      for (int x = 0; x < 32; ++x) {
        const Ray ray = rays.ThroughPixel(x, y);
        tracer.Radiance(ray.origin, ray.direction, limits, counts);
      }
    }
    reflected[mirrors] = counts.reflected;
  }
  EXPECT_GT(reflected[1], 5 * reflected[0]);
}

}  // namespace
}  // namespace linetree
