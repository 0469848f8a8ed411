// What ships in scenes/ loads and shows what its header promises: figures at a quarter of the size
// that the headers quote, where they agree to the digits quoted.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numeric>
#include <string>
#include <vector>

#include "core/io/camera_path.h"
#include "core/io/load_scene.h"
#include "core/render/scene_host.h"

namespace linetree {
namespace {

namespace fs = std::filesystem;

const fs::path kScenes = fs::path(LINETREE_SOURCE_DIR) / "scenes";
constexpr int kSide = 128;

std::vector<fs::path> FilesIn(const fs::path& folder, const std::string& extension) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == extension) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::shared_ptr<const Scene> Load(const std::string& name) {
  auto scene = LoadSceneFile(kScenes / name);
  EXPECT_TRUE(scene.ok()) << scene.status();
  return scene.ok() ? *scene : nullptr;
}

Frame Render(const std::string& name, const std::string& camera, Mode mode) {
  const auto scene = Load(name);
  SceneHost host(scene);
  WorkerPool pool(1);
  FrameRequest request;
  request.camera = *scene->FindCamera(camera);
  request.width = request.height = kSide;
  request.options.mode = mode;
  request.options.judge = JudgeKind::kPaper;
  request.options.max_relative_error = 0.25;
  auto frame = host.RenderFrame(request, pool);
  EXPECT_TRUE(frame.ok()) << frame.status();
  return *std::move(frame);
}

std::vector<uint64_t> CellsTried(SceneHost& host, const std::vector<Camera>& cameras) {
  WorkerPool pool(1);
  std::vector<uint64_t> tried;
  for (const Camera& camera : cameras) {
    FrameRequest request;
    request.camera = camera;
    request.width = request.height = kSide / 2;
    request.options.judge = JudgeKind::kPaper;
    request.options.max_relative_error = 0.25;
    const auto frame = host.RenderFrame(request, pool);
    EXPECT_TRUE(frame.ok()) << frame.status();
    tried.push_back(frame->stats.cells_tried);
  }
  return tried;
}

double PerPixel(uint64_t count) { return static_cast<double>(count) / (kSide * kSide); }

uint64_t PixelsOf(const Frame& frame, Verdict verdict) {
  return frame.stats.verdicts[static_cast<size_t>(verdict)];
}

TEST(Scenes, AllLoadAndHaveACamera) {
  std::vector<fs::path> files = FilesIn(kScenes, ".textproto");
  for (const fs::path& file : FilesIn(kScenes / "spd", ".nff")) files.push_back(file);
  ASSERT_GE(files.size(), 16U);
  for (const fs::path& file : files) {
    SCOPED_TRACE(file);
    const auto scene = LoadSceneFile(file);
    ASSERT_TRUE(scene.ok()) << scene.status();
    EXPECT_FALSE((*scene)->cameras.empty());
    EXPECT_FALSE((*scene)->lights.empty());
  }
}

TEST(Scenes, HaveTheNameOfTheirFile) {
  for (const fs::path& file : FilesIn(kScenes, ".textproto")) {
    const auto scene = LoadSceneFile(file);
    ASSERT_TRUE(scene.ok()) << scene.status();
    EXPECT_EQ((*scene)->name, file.stem());
  }
}

TEST(Scenes, TheExampleInTheReadmeLoads) {
  std::ifstream file(fs::path(LINETREE_SOURCE_DIR) / "README.md");
  const std::string readme{std::istreambuf_iterator<char>(file), {}};
  const std::string fence = "```textproto\n";
  const size_t begin = readme.find(fence);
  ASSERT_NE(begin, std::string::npos);
  const size_t from = begin + fence.size();
  const auto source =
      ParseSceneText(readme.substr(from, readme.find("```", from) - from), "README");
  ASSERT_TRUE(source.ok()) << source.status();
  const auto scene = BuildScene(**source);
  ASSERT_TRUE(scene.ok()) << scene.status();
  EXPECT_EQ((*scene)->objects.size(), 2U);
}

TEST(Paths, AllLoadAndCanBeFlown) {
  const std::vector<fs::path> files = FilesIn(kScenes / "paths", ".textproto");
  ASSERT_GE(files.size(), 5U);
  for (const fs::path& file : files) {
    SCOPED_TRACE(file);
    const auto path = LoadCameraPath(file);
    ASSERT_TRUE(path.ok()) << path.status();
    EXPECT_EQ(path->name, file.stem());
    const auto cameras = SampleCameraPath(*path, path->frames);
    ASSERT_TRUE(cameras.ok()) << cameras.status();
    EXPECT_GE(cameras->size(), 12U);
  }
}

// Who walks through a wall or a table leg meets a surface between two viewpoints.
TEST(Paths, WalkThroughNothing) {
  for (const auto& [scene_name, path_name] :
       {std::pair{"face", "face_walk"}, {"room", "room_walk"}, {"glass", "glass_orbit"}}) {
    SCOPED_TRACE(path_name);
    const auto scene = Load(std::string(scene_name) + ".textproto");
    const Tracer tracer(*scene);
    const auto path = LoadCameraPath(kScenes / "paths" / (std::string(path_name) + ".textproto"));
    const auto cameras = SampleCameraPath(*path, path->frames);
    for (size_t i = 1; i < cameras->size(); ++i) {
      const Vec3d step = (*cameras)[i].eye - (*cameras)[i - 1].eye;
      const Hit hit = tracer.Intersect((*cameras)[i - 1].eye, step, {});
      EXPECT_FALSE(hit.IsHit() && hit.t <= 1) << "between frames " << i - 1 << " and " << i;
    }
  }
}

// What the headers of the paths promise: frames build on those before them, and who comes second
// finds everything built.
TEST(Paths, LaterFramesAndFlightsFindCellsBuilt) {
  for (const auto& [scene_name, path_name] : {std::pair{"face.textproto", "face_walk"},
                                              {"room.textproto", "room_walk"},
                                              {"glass.textproto", "glass_orbit"},
                                              {"spd/balls_3.nff", "balls_orbit"},
                                              {"spd/tree_8.nff", "tree_orbit"}}) {
    SCOPED_TRACE(path_name);
    SceneHost host(Load(scene_name));
    const auto path = LoadCameraPath(kScenes / "paths" / (std::string(path_name) + ".textproto"));
    const auto cameras = SampleCameraPath(*path, path->frames);
    const std::vector<uint64_t> first = CellsTried(host, *cameras);
    const std::vector<uint64_t> second = CellsTried(host, *cameras);
    const auto total = [](const std::vector<uint64_t>& tried) {
      return std::accumulate(tried.begin(), tried.end(), uint64_t{0});
    };
    ASSERT_GT(first[0], 0U);
    EXPECT_LT(2 * (total(first) - first[0]), first[0] * (first.size() - 1));
    EXPECT_LT(20 * total(second), total(first));
  }
}

struct Sequence {
  const char* scene;
  size_t objects;
  size_t lights;
};

// Tables 1 and 2: a first frame, two small moves forward, two sideways.
TEST(PaperScenes, HaveTheirPrimitivesLightsAndCameras) {
  for (const Sequence& expected : {Sequence{"face", 7, 2}, {"room", 18, 3}}) {
    SCOPED_TRACE(expected.scene);
    const auto scene = Load(std::string(expected.scene) + ".textproto");
    EXPECT_EQ(scene->objects.size(), expected.objects);
    EXPECT_EQ(scene->lights.size(), expected.lights);
    ASSERT_EQ(scene->cameras.size(), 5U);
    const CameraFrame frame = FrameOf(scene->cameras[0]);
    for (size_t i = 1; i < 5; ++i) {
      const Vec3d step = scene->cameras[i].eye - scene->cameras[i - 1].eye;
      const Vec3d& along = i <= 2 ? frame.forward : frame.right;
      // The files give coordinates to four decimals.
      EXPECT_NEAR(Dot(step, along), Length(step), 1e-5) << scene->cameras[i].name;
      EXPECT_GT(Length(step), 0.01);
      EXPECT_LT(Length(step), 0.03 * Length(scene->cameras[0].look_at - scene->cameras[0].eye));
    }
  }
}

TEST(PaperScenes, CostWhatTheirHeadersSay) {
  const Frame face = Render("face.textproto", "frame1", Mode::kClassical);
  EXPECT_NEAR(PerPixel(face.stats.base.shade), 0.96, 0.01);
  EXPECT_NEAR(PerPixel(face.stats.base.intersect), 2.97, 0.02);
  const Frame room = Render("room.textproto", "frame1", Mode::kClassical);
  EXPECT_NEAR(PerPixel(room.stats.base.shade), 1.05, 0.01);
  EXPECT_NEAR(PerPixel(room.stats.base.intersect), 4.17, 0.02);
  EXPECT_EQ(room.stats.background, 0U);
}

TEST(GlassScene, CostsWhatItsHeaderSays) {
  const Frame frame = Render("glass.textproto", "view1", Mode::kClassical);
  EXPECT_NEAR(PerPixel(frame.stats.base.shade), 1.61, 0.01);
  EXPECT_NEAR(PerPixel(frame.stats.base.reflected), 0.54, 0.01);
  EXPECT_NEAR(PerPixel(frame.stats.base.refracted), 0.73, 0.01);
}

TEST(ManyLightsScene, IsALatticeThatCostsWhatItsHeaderSays) {
  const auto scene = Load("many_lights.textproto");
  ASSERT_EQ(scene->lights.size(), 64U);
  for (size_t i = 0; i < 8; ++i) {
    for (size_t j = 0; j < 8; ++j) {
      const Vec3d expected{-1.75 + 0.5 * static_cast<double>(i), 2.45,
                           -1.75 + 0.5 * static_cast<double>(j)};
      EXPECT_EQ(scene->lights[8 * i + j].position, expected);
    }
  }
  const Frame frame = Render("many_lights.textproto", "view1", Mode::kClassical);
  EXPECT_NEAR(PerPixel(frame.stats.base.shadow), 60, 0.5);
}

struct Promise {
  const char* scene;
  std::vector<Verdict> shows;
  std::vector<Verdict> never_shows;
};

// One minimal scene for each source of aliasing (paper, Figure 1).
TEST(MinimalScenes, ShowTheVerdictThatTheyAreThereFor) {
  const Promise promises[] = {
      {"gap", {Verdict::kGap}, {Verdict::kFunnel, Verdict::kPeak}},
      {"blocker", {Verdict::kBlocker}, {Verdict::kFunnel, Verdict::kPeak}},
      {"funnel", {Verdict::kFunnel, Verdict::kGap}, {Verdict::kPeak}},
      {"peak",
       {Verdict::kPeak, Verdict::kSelfShadow, Verdict::kGap, Verdict::kEpsilon},
       {Verdict::kBlocker, Verdict::kFunnel}},
  };
  for (const Promise& promise : promises) {
    SCOPED_TRACE(promise.scene);
    const Frame frame = Render(std::string(promise.scene) + ".textproto", "front", Mode::kCached);
    EXPECT_GT(frame.stats.interpolated, 0U);
    for (const Verdict verdict : promise.shows) {
      EXPECT_GT(PixelsOf(frame, verdict), 0U) << VerdictName(verdict);
    }
    for (const Verdict verdict : promise.never_shows) {
      EXPECT_EQ(PixelsOf(frame, verdict), 0U) << VerdictName(verdict);
    }
  }
}

}  // namespace
}  // namespace linetree
