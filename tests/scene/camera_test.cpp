#include "core/scene/camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <numbers>

#include "tests/support/random.h"

namespace linetree {
namespace {

using test::Random;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kRounding = 0x1p-48;

Camera RandomCamera(Random& random) {
  Camera camera;
  camera.eye = random.InCube(10);
  camera.look_at = camera.eye + random.Direction() * random.LogUniform(1e-3, 1e3);
  camera.up = random.Direction() * random.LogUniform(1e-3, 1e3);
  camera.fov_deg = random.Uniform(1, 170);
  return camera;
}

TEST(Camera, FrameIsRightHandedAndUpright) {
  Random random(1);
  for (int k = 0; k < 1000; ++k) {
    const Camera camera = RandomCamera(random);
    ASSERT_TRUE(ValidateCamera(camera).ok());
    const CameraFrame frame = FrameOf(camera);
    EXPECT_LT(Length(frame.forward - Normalized(camera.look_at - camera.eye)), kRounding);
    EXPECT_NEAR(Length(frame.right), 1, kRounding);
    EXPECT_NEAR(Length(frame.up), 1, kRounding);
    EXPECT_NEAR(Dot(frame.right, frame.forward), 0, 1e-10);
    EXPECT_LT(Length(Cross(frame.right, frame.forward) - frame.up), 1e-10);
    EXPECT_GT(Dot(frame.up, camera.up), 0);
  }
}

// Looking down -z with y up: x to the right, rows from the top.
TEST(EyeRays, CentreAndCorners) {
  Camera camera;
  camera.eye = {0, 0, 5};
  camera.fov_deg = 90;
  const EyeRays rays(camera, 4, 2);
  EXPECT_EQ(rays.Through(2, 1).direction, (Vec3d{0, 0, -1}));
  EXPECT_EQ(rays.Through(2, 1).origin, camera.eye);
  EXPECT_LT(Length(rays.Through(0, 1).direction - Normalized(Vec3d{-1, 0, -1})), kRounding)
      << "half the horizontal angle";
  EXPECT_LT(Length(rays.Through(0, 0).direction - Normalized(Vec3d{-1, 0.5, -1})), kRounding);
  EXPECT_LT(Length(rays.Through(4, 2).direction - Normalized(Vec3d{1, -0.5, -1})), kRounding);
  const Vec3d pixel = rays.ThroughPixel(3, 0).direction;
  EXPECT_EQ(pixel, rays.Through(3.5, 0.5).direction);
  EXPECT_LT(Length(pixel - Normalized(Vec3d{0.75, 0.25, -1})), kRounding);
}

TEST(EyeRays, DirectionsAreUnit) {
  Random random(2);
  for (int k = 0; k < 1000; ++k) {
    const EyeRays rays(RandomCamera(random), 640, 480);
    EXPECT_NEAR(Length(rays.Through(random.Uniform(0, 640), random.Uniform(0, 480)).direction), 1,
                kRounding);
  }
}

// The formula of camera.h, in a wider type.
Vec3<long double> DirectionThrough(const Camera& camera, double x, double y, int width,
                                   int height) {
  using Wide = long double;
  using WideVec = Vec3<Wide>;
  const WideVec f = Normalized(CastVec3<Wide>(camera.look_at) - CastVec3<Wide>(camera.eye));
  const WideVec r = Normalized(Cross(f, CastVec3<Wide>(camera.up)));
  const Wide tangent = std::tan(camera.fov_deg * (std::numbers::pi_v<Wide> / 360));
  const Wide across = (2 * Wide(x) / width - 1) * tangent;
  const Wide along = (1 - 2 * Wide(y) / height) * tangent * height / width;
  return Normalized(f + r * across + Cross(r, f) * along);
}

// All angles, far from the origin, with `up` down to the smallest angle that is accepted.
TEST(EyeRays, RoundingIsAsPublished) {
  Random random(3);
  double largest = 0;
  for (int i = 0; i < 100'000; ++i) {
    Camera camera = RandomCamera(random);
    camera.eye = camera.eye * random.LogUniform(1, 1e6);
    camera.look_at = camera.eye + random.Direction() * random.LogUniform(1e-3, 1e6);
    const Vec3d view = camera.look_at - camera.eye;
    if (i % 3 == 0)
      camera.up = view + random.Direction() * (Length(view) * random.LogUniform(1e-4, 1));
    camera.fov_deg = i % 5 == 0 ? 180 - random.LogUniform(1e-3, 1) : random.LogUniform(1e-3, 179);
    if (!ValidateCamera(camera).ok()) continue;
    const int width = random.Int(1, 4096), height = random.Int(1, 4096);
    const double x = random.Uniform(0, width), y = random.Uniform(0, height);
    const Vec3d direction = EyeRays(camera, width, height).Through(x, y).direction;
    const auto off =
        CastVec3<long double>(direction) - DirectionThrough(camera, x, y, width, height);
    const double sine = Length(Cross(Normalized(view), Normalized(camera.up)));
    const double tangent = std::tan(camera.fov_deg * std::numbers::pi / 360);
    largest = std::max(largest, static_cast<double>(Length(off)) * sine / (1 + tangent));
  }
  std::printf("largest error %.3g, bound %.3g\n", largest, kEyeRayRounding);
  EXPECT_LE(largest, kEyeRayRounding);
}

TEST(ValidateCamera, NamesTheFieldAndWhatWasExpected) {
  EXPECT_TRUE(ValidateCamera(Camera{}).ok());
  struct Case {
    const char* field;
    const char* expected;
    std::function<void(Camera&)> spoil;
  };
  const std::vector<Case> cases = {
      {"camera.eye", "finite", [](Camera& c) { c.eye.x = kNaN; }},
      {"camera.look_at", "finite", [](Camera& c) { c.look_at.y = Camera().eye.x / 0.0; }},
      {"camera.up", "finite", [](Camera& c) { c.up.z = kNaN; }},
      {"camera.look_at", "other than camera.eye", [](Camera& c) { c.look_at = c.eye; }},
      {"camera.up", "non-zero",
       [](Camera& c) {
         c.up = {0, 0, 0};
       }},
      {"camera.up", "not parallel",
       [](Camera& c) {
         c.up = {0, 0, -3};
       }},
      {"camera.fov_deg", "(0, 180)", [](Camera& c) { c.fov_deg = 0; }},
      {"camera.fov_deg", "(0, 180)", [](Camera& c) { c.fov_deg = 180; }},
      {"camera.fov_deg", "(0, 180)", [](Camera& c) { c.fov_deg = -1; }},
      {"camera.fov_deg", "(0, 180)", [](Camera& c) { c.fov_deg = kNaN; }},
  };
  for (const Case& spoiled : cases) {
    Camera camera;
    spoiled.spoil(camera);
    const absl::Status status = ValidateCamera(camera);
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << spoiled.field;
    EXPECT_THAT(std::string(status.message()), testing::HasSubstr(spoiled.field));
    EXPECT_THAT(std::string(status.message()), testing::HasSubstr(spoiled.expected));
  }
}

}  // namespace
}  // namespace linetree
