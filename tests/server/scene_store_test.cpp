#include "server/scene_store.h"

#include <gtest/gtest.h>

#include "tests/support/demo_scenes.h"

namespace linetree {
namespace {

// Scenes of different content have different versions.
std::shared_ptr<const Scene> SceneOfVersion(const std::string& version) {
  auto scene = std::make_shared<Scene>(*test::BallsOnFloor(3, 1));
  scene->version = version;
  return scene;
}

void Render(SceneHost& host) {
  WorkerPool pool(1);
  FrameRequest request;
  request.camera = host.scene().cameras[0];
  request.width = request.height = 256;
  request.options.judge = JudgeKind::kPaper;  // whose cells fill any budget soon
  ASSERT_TRUE(host.RenderFrame(request, pool).ok());
}

TEST(SceneStoreTest, AHostOutlivesItsUnloading) {
  SceneStore store({});
  ASSERT_TRUE(store.Add("a", SceneOfVersion("1"), false).ok());
  const auto held = store.Find("a", "scene");
  ASSERT_TRUE(held.ok());
  EXPECT_TRUE(store.Remove("a", "scene").ok());
  EXPECT_TRUE(absl::IsNotFound(store.Find("a", "scene").status()));
  Render(*held->host);
}

TEST(SceneStoreTest, AReplacedSceneIsAnotherHost) {
  SceneStore store({});
  const auto first = store.Add("a", SceneOfVersion("1"), false);
  EXPECT_EQ(store.Add("a", SceneOfVersion("1"), true)->host, first->host);
  EXPECT_TRUE(absl::IsAlreadyExists(store.Add("a", SceneOfVersion("2"), false).status()));
  EXPECT_NE(store.Add("a", SceneOfVersion("2"), true)->host, first->host);
  EXPECT_EQ(store.All().size(), 1u);
}

TEST(SceneStoreTest, ScenesAndObjectsAreCounted) {
  SceneStore store({.max_scenes = 2, .max_objects = 13});  // each scene has 6
  ASSERT_TRUE(store.Add("a", SceneOfVersion("1"), false).ok());
  ASSERT_TRUE(store.Add("b", SceneOfVersion("1"), false).ok());
  EXPECT_TRUE(absl::IsResourceExhausted(store.Add("c", SceneOfVersion("1"), false).status()));
  EXPECT_TRUE(store.Add("b", SceneOfVersion("2"), true).ok());
  auto large = std::make_shared<Scene>(*test::BallsOnFloor(5, 1));
  large->version = "large";
  EXPECT_TRUE(absl::IsResourceExhausted(store.Add("b", large, true).status()));
  EXPECT_EQ(store.Find("b", "scene")->host->scene().version, "2") << "refused, so still there";
  EXPECT_TRUE(store.Remove("a", "scene").ok());
  EXPECT_TRUE(store.Add("b", large, true).ok());
}

TEST(SceneStoreTest, CachesShareTheMemory) {
  constexpr uint64_t kMemory = 400'000;
  // Of two scenes' linetrees of the paper's judge.
  constexpr auto kHalf = static_cast<uint64_t>((1 - kSurfaceShare - kPathShare) * kMemory / 2);
  SceneStore store({.memory_bytes = kMemory});
  const auto first = store.Add("a", SceneOfVersion("1"), false);
  Render(*first->host);
  const uint64_t alone = first->host->CacheBytes();
  ASSERT_GT(alone, kHalf) << "too little for the test to mean anything";
  const auto second = store.Add("b", SceneOfVersion("1"), false);
  EXPECT_LE(first->host->CacheBytes(), kHalf);
  Render(*first->host);
  Render(*second->host);
  EXPECT_LE(first->host->CacheBytes() + second->host->CacheBytes(), kMemory);
  EXPECT_TRUE(store.Remove("b", "scene").ok());
  Render(*first->host);
  EXPECT_GT(first->host->CacheBytes(), kHalf);
}

TEST(SceneStoreTest, WeightsSayWhatPartOfTheMemoryAScenesCachesGet) {
  SceneStore store({.memory_bytes = 1'000'000});
  EXPECT_EQ(store.Add("a", SceneOfVersion("1"), false)->memory_bytes, 1'000'000u);
  EXPECT_EQ(store.Add("b", SceneOfVersion("1"), false, nullptr, 3)->memory_bytes, 750'000u);
  EXPECT_EQ(store.Find("a", "scene")->memory_bytes, 250'000u);
  EXPECT_EQ(store.Add("b", SceneOfVersion("2"), true)->weight, 3) << "the name's";
  EXPECT_EQ(store.Add("b", SceneOfVersion("2"), false, nullptr, 1)->memory_bytes, 500'000u);
  EXPECT_TRUE(store.Remove("b", "scene").ok());
  EXPECT_EQ(store.Find("a", "scene")->memory_bytes, 1'000'000u);
}

TEST(SceneStoreTest, ErrorsNameTheField) {
  SceneStore store({});
  EXPECT_EQ(store.Find("", "frame.scene").status().message().substr(0, 12), "frame.scene:");
  EXPECT_TRUE(absl::IsInvalidArgument(store.Find("", "scene").status()));
  EXPECT_TRUE(absl::IsNotFound(store.Remove("a", "scene")));
  EXPECT_TRUE(absl::IsInvalidArgument(store.Add("a/b", SceneOfVersion("1"), false).status()));
}

}  // namespace
}  // namespace linetree
