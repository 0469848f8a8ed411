#include "core/io/camera_path.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/io/temp_dir.h"

namespace linetree {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

// Rounding of a handful of operations on numbers of at most 100.
constexpr double kRounding = 1e-12;

Keyframe Key(double time_s, const Vec3d& eye, double fov_deg = 45) {
  return {time_s, {"", eye, {0, 0, -100}, {0, 1, 0}, fov_deg}};
}

CameraPath MakePath(PathInterpolation interpolation, std::vector<Keyframe> keys) {
  CameraPath path;
  path.name = "walk";
  path.interpolation = interpolation;
  path.keyframes = std::move(keys);
  return path;
}

absl::StatusCode CodeOf(const std::string& text) {
  return ParseCameraPath(text, "p.textproto").status().code();
}
std::string ErrorOf(const std::string& text) {
  return std::string(ParseCameraPath(text, "p.textproto").status().message());
}

constexpr char kGood[] = R"(
name: "walk"
interpolation: CATMULL_ROM
frames: 12
keyframes { time_s: 0 camera { eye { z: 5 } look_at { } } }
keyframes { time_s: 2 camera { eye { x: 1 z: 5 } look_at { } up { z: 1 } fov_deg: 60 } }
)";

TEST(CameraPath, ReadsText) {
  const absl::StatusOr<CameraPath> path = ParseCameraPath(kGood, "p.textproto");
  ASSERT_EQ(path.status(), absl::OkStatus());
  EXPECT_EQ(path->name, "walk");
  EXPECT_EQ(path->interpolation, PathInterpolation::kCatmullRom);
  EXPECT_EQ(path->frames, 12);
  ASSERT_EQ(path->keyframes.size(), 2u);
  EXPECT_EQ(path->keyframes[0].camera.up, (Vec3d{0, 1, 0}));
  EXPECT_EQ(path->keyframes[0].camera.fov_deg, 45);
  EXPECT_EQ(path->keyframes[1].time_s, 2);
  EXPECT_EQ(path->keyframes[1].camera.up, (Vec3d{0, 0, 1}));
  EXPECT_EQ(path->keyframes[1].camera.fov_deg, 60);
}

TEST(CameraPath, ReadsFiles) {
  TempDir dir;
  std::ofstream(dir.File("p.textproto")) << kGood;
  EXPECT_EQ(LoadCameraPath(dir.File("p.textproto")).status(), absl::OkStatus());
  EXPECT_EQ(LoadCameraPath(dir.File("none")).status().code(), absl::StatusCode::kNotFound);
}

TEST(CameraPath, SaysWhereTheTextIsWrong) {
  EXPECT_THAT(ErrorOf("name: \"a\"\nkeyfames { }"), StartsWith("p.textproto:2:10: "));
  EXPECT_THAT(ErrorOf("keyframes {\n  time_s: soon }"), StartsWith("p.textproto:2:11: "));
}

TEST(CameraPath, RefusesAPathWithoutKeyframes) {
  EXPECT_EQ(CodeOf("name: \"a\""), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(ErrorOf("name: \"a\""), "p.textproto: keyframes: expected at least one");
}

TEST(CameraPath, RefusesTimesThatDoNotIncrease) {
  const std::string text = R"(keyframes { time_s: 1 camera { eye { z: 5 } } }
keyframes { time_s: 1 camera { eye { z: 5 } } })";
  EXPECT_EQ(ErrorOf(text),
            "p.textproto:2:13: keyframes[1].time_s: expected a time after that of the keyframe "
            "before (1), found 1");
}

TEST(CameraPath, RefusesATimeThatIsNotFinite) {
  EXPECT_THAT(ErrorOf("keyframes { time_s: nan camera { eye { z: 5 } } }"),
              HasSubstr("keyframes[0].time_s: expected a finite"));
}

TEST(CameraPath, RefusesInvalidCameras) {
  EXPECT_THAT(ErrorOf("keyframes {\n camera {\n  fov_deg: 200 eye { z: 1 } } }"),
              StartsWith("p.textproto:3:3: keyframes[0].camera.fov_deg: expected an angle"));
  EXPECT_THAT(ErrorOf("keyframes { camera { } }"), HasSubstr("keyframes[0].camera.look_at: "));
}

TEST(CameraPath, RefusesTooManyFrames) {
  EXPECT_THAT(ErrorOf("frames: 1000001 keyframes { camera { eye { z: 1 } } }"),
              HasSubstr("frames: expected at most 1000000"));
}

TEST(CameraPath, LinearGoesStraightAndHoldsItsEnds) {
  const CameraPath path =
      MakePath(PathInterpolation::kLinear,
               {Key(1, {0, 0, 0}, 40), Key(2, {4, 0, 0}, 60), Key(6, {4, 8, 0}, 60)});
  EXPECT_EQ(CameraAt(path, 1.25).eye, (Vec3d{1, 0, 0}));
  EXPECT_EQ(CameraAt(path, 1.25).fov_deg, 45);
  EXPECT_EQ(CameraAt(path, 3).eye, (Vec3d{4, 2, 0}));
  EXPECT_EQ(CameraAt(path, 0).eye, (Vec3d{0, 0, 0}));
  EXPECT_EQ(CameraAt(path, 7).eye, (Vec3d{4, 8, 0}));
  EXPECT_EQ(CameraAt(path, 3).name, "walk");
}

TEST(CameraPath, BothInterpolationsPassThroughTheKeyframes) {
  const std::vector<Keyframe> keys = {Key(0, {0, 0, 0}), Key(1, {3, 1, 0}), Key(1.5, {4, -2, 1}),
                                      Key(4, {0, 5, 2})};
  for (const auto kind : {PathInterpolation::kLinear, PathInterpolation::kCatmullRom}) {
    const CameraPath path = MakePath(kind, keys);
    for (const Keyframe& key : keys) {
      EXPECT_EQ(CameraAt(path, key.time_s).eye, key.camera.eye);
    }
  }
}

// With equal steps of time the slope at a keyframe is (next - previous) / 2, as Catmull and Rom
// have it, so that half way p = (-a + 9 b + 9 c - d) / 16.
TEST(CameraPath, CatmullRomOnEqualSteps) {
  const CameraPath path =
      MakePath(PathInterpolation::kCatmullRom,
               {Key(0, {1, 0, 0}), Key(1, {2, 0, 0}), Key(2, {7, 0, 0}), Key(3, {3, 0, 0})});
  EXPECT_NEAR(CameraAt(path, 1.5).eye.x, (-1 + 9 * 2 + 9 * 7 - 3) / 16.0, kRounding);
}

// A motion with constant acceleration is followed exactly between inner keyframes, however the
// keyframes are spaced.
TEST(CameraPath, CatmullRomReproducesParabolasOnUnequalSteps) {
  std::vector<Keyframe> keys;
  for (const double t : {0.0, 1.0, 1.25, 3.0, 3.5}) keys.push_back(Key(t, {t * t - t, 2 * t, 1}));
  const CameraPath path = MakePath(PathInterpolation::kCatmullRom, keys);
  for (const double t : {1.1, 1.2, 1.5, 2.0, 2.9}) {
    EXPECT_NEAR(CameraAt(path, t).eye.x, t * t - t, kRounding) << t;
    EXPECT_NEAR(CameraAt(path, t).eye.y, 2 * t, kRounding) << t;
  }
}

TEST(CameraPath, CatmullRomHasNoKinks) {
  const CameraPath path =
      MakePath(PathInterpolation::kCatmullRom,
               {Key(0, {0, 0, 0}), Key(1, {3, 0, 0}), Key(1.5, {1, 0, 0}), Key(4, {9, 0, 0})});
  const double h = 1e-6;
  for (const double t : {1.0, 1.5}) {
    const double before = (CameraAt(path, t).eye.x - CameraAt(path, t - h).eye.x) / h;
    const double after = (CameraAt(path, t + h).eye.x - CameraAt(path, t).eye.x) / h;
    // The second derivative is below 100 here.
    EXPECT_NEAR(before, after, 100 * h) << t;
  }
}

TEST(CameraPath, SamplesRunFromTheFirstToTheLastKeyframe) {
  const CameraPath path =
      MakePath(PathInterpolation::kLinear, {Key(0.1, {0, 0, 0}), Key(0.7, {6, 0, 0})});
  const absl::StatusOr<std::vector<Camera>> cameras = SampleCameraPath(path, 4);
  ASSERT_EQ(cameras.status(), absl::OkStatus());
  ASSERT_EQ(cameras->size(), 4u);
  EXPECT_EQ(cameras->front().eye, (Vec3d{0, 0, 0}));
  EXPECT_NEAR((*cameras)[1].eye.x, 2, kRounding);
  EXPECT_NEAR((*cameras)[2].eye.x, 4, kRounding);
  EXPECT_EQ(cameras->back().eye, (Vec3d{6, 0, 0}));
  EXPECT_EQ(SampleCameraPath(path, 1)->front().eye, (Vec3d{0, 0, 0}));
}

TEST(CameraPath, OneKeyframeIsAStandingCamera) {
  const CameraPath path = MakePath(PathInterpolation::kCatmullRom, {Key(3, {1, 2, 3})});
  const absl::StatusOr<std::vector<Camera>> cameras = SampleCameraPath(path, 3);
  ASSERT_EQ(cameras.status(), absl::OkStatus());
  for (const Camera& camera : *cameras) EXPECT_EQ(camera.eye, (Vec3d{1, 2, 3}));
}

TEST(CameraPath, NamesTheFrameWhoseCameraIsInvalid) {
  // Half way the eye runs through the point that it looks at.
  const CameraPath path =
      MakePath(PathInterpolation::kLinear, {Key(0, {-1, 0, -100}), Key(2, {1, 0, -100})});
  const absl::Status status = SampleCameraPath(path, 3).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(status.message()),
              StartsWith("camera path 'walk', frame 1 (1 s): camera.look_at: "));
}

}  // namespace
}  // namespace linetree
