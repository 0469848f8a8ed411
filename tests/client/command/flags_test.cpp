#include "client/command/flags.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace linetree {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

v1::SceneInfo SceneWithCameras() {
  v1::SceneInfo scene;
  scene.set_name("room");
  for (const char* name : {"front", "side"}) {
    v1::Camera* camera = scene.add_cameras();
    camera->set_name(name);
    camera->mutable_eye()->set_z(*name == 'f' ? 5 : 7);
    camera->mutable_look_at()->set_x(0.5);
  }
  return scene;
}

TEST(Flags, TheFirstCameraIsTheDefault) {
  const absl::StatusOr<Camera> camera = ResolveCamera(SceneWithCameras(), {});
  ASSERT_EQ(camera.status(), absl::OkStatus());
  EXPECT_EQ(camera->name, "front");
  EXPECT_EQ(camera->eye, (Vec3d{0, 0, 5}));
  EXPECT_EQ(camera->up, (Vec3d{0, 1, 0}));
  EXPECT_EQ(camera->fov_deg, 45);
}

TEST(Flags, CamerasByName) {
  ViewFlags flags;
  flags.camera = "side";
  EXPECT_EQ(ResolveCamera(SceneWithCameras(), flags)->eye, (Vec3d{0, 0, 7}));
  flags.camera = "top";
  const absl::Status status = ResolveCamera(SceneWithCameras(), flags).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(status.message(), "no camera 'top' in scene 'room': it has 'front', 'side'");
}

TEST(Flags, PartsReplaceTheCameras) {
  ViewFlags flags;
  flags.camera = "side";
  flags.eye = {1, 2, 3};
  flags.fov_deg = 70;
  const absl::StatusOr<Camera> camera = ResolveCamera(SceneWithCameras(), flags);
  ASSERT_EQ(camera.status(), absl::OkStatus());
  EXPECT_EQ(camera->name, "");
  EXPECT_EQ(camera->eye, (Vec3d{1, 2, 3}));
  EXPECT_EQ(camera->look_at, (Vec3d{0.5, 0, 0}));
  EXPECT_EQ(camera->fov_deg, 70);
}

TEST(Flags, ASceneWithoutCamerasNeedsEyeAndLookAt) {
  ViewFlags flags;
  flags.eye = {0, 0, 1};
  EXPECT_EQ(ResolveCamera(v1::SceneInfo(), flags).status().message(),
            "scene '' has no camera: give --eye and --look-at");
  flags.look_at = {0, 0, 0};
  EXPECT_EQ(ResolveCamera(v1::SceneInfo(), flags).status(), absl::OkStatus());
}

TEST(Flags, AnImpossibleCameraIsRefused) {
  ViewFlags flags;
  flags.eye = {0.5, 0, 0};
  EXPECT_THAT(std::string(ResolveCamera(SceneWithCameras(), flags).status().message()),
              HasSubstr("camera.look_at"));
}

TEST(Flags, EveryGroupParses) {
  CLI::App app;
  ConnectionFlags connection;
  SceneFlags scene;
  ViewFlags view;
  SizeFlags size;
  RenderOptions options;
  OutputFlags output;
  AddConnectionFlags(app, connection);
  AddSceneFlags(app, scene);
  AddViewFlags(app, view);
  AddSizeFlags(app, size);
  AddOptionsFlags(app, options);
  AddOutputFlags(app, output);
  app.parse(
      "--local --threads 3 --memory 64m --scene a.nff --eye -1,2,3 --up 0,0,1 --fov 50 --width 40 "
      "--height 30 --mode classical --judge paper --epsilon 0.25 --max-depth 5 --min-weight 0.125 "
      "-o a.exr -o b.PNG --layer depth --stats s.json --quiet");
  EXPECT_TRUE(connection.local);
  EXPECT_EQ(connection.threads, 3);
  EXPECT_EQ(connection.memory_bytes, uint64_t{64} << 20);
  EXPECT_EQ(scene.scene, "a.nff");
  EXPECT_EQ(*view.eye, (Vec3d{-1, 2, 3}));
  EXPECT_EQ(*view.up, (Vec3d{0, 0, 1}));
  EXPECT_FALSE(view.look_at.has_value());
  EXPECT_EQ(*view.fov_deg, 50);
  EXPECT_EQ(size.width, 40);
  EXPECT_EQ(size.height, 30);
  EXPECT_EQ(options.mode, Mode::kClassical);
  EXPECT_EQ(options.max_relative_error, 0.25);
  EXPECT_EQ(options.limits, (PathLimits{5, 0.125}));
  EXPECT_THAT(output.pictures, ElementsAre("a.exr", "b.PNG"));
  EXPECT_EQ(output.layer, Layer::kDepth);
  EXPECT_EQ(output.stats, "s.json");
  EXPECT_TRUE(output.quiet);
}

TEST(Flags, DefaultsAreThoseOfTheOptions) {
  CLI::App app;
  RenderOptions options;
  AddOptionsFlags(app, options);
  app.parse("");
  EXPECT_EQ(options.mode, Mode::kCached);
  EXPECT_EQ(options.max_relative_error, RenderOptions{}.max_relative_error);
  EXPECT_EQ(options.limits, PathLimits{});
}

TEST(Flags, TheLegendNamesEveryColorOfThePlate) {
  const std::string legend = LegendText();
  for (const char* word : {"yellow", "green", "cyan", "purple", "red", "orange", "silhouette"}) {
    EXPECT_THAT(legend, HasSubstr(word));
  }
}

}  // namespace
}  // namespace linetree
