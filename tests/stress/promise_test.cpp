// Scenes and rays at the edges of what is allowed: certified answers keep their promise.
#include "tests/stress/promise.h"

#include <gtest/gtest.h>

#include "tests/stress/hard_rays.h"
#include "tests/stress/hard_scenes.h"
#include "tests/support/scene_builder.h"

namespace linetree::stress {
namespace {

class HardSceneTest : public testing::TestWithParam<NamedScene> {};

TEST_P(HardSceneTest, KeepsThePromise) {
  test::Random random = RandomFor(GetParam().name);
  Largest largest(GetParam().name, 1, "of the promise");
  uint64_t cells = 0;
  for (int i = 0; i < Times(8) && !HasFailure(); ++i) {
    const auto scene = std::make_shared<const Scene>(GetParam().make(random));
    cells += ExpectPromise(scene, HardRays(*scene, 6000, random), largest);
  }
  EXPECT_GT(cells, 100u);
}

// A light so near to a hit that the square of its distance vanishes.
TEST(NearLightTest, AnswersAreNumbers) {
  test::Random random = RandomFor("NearLight");
  Largest largest("NearLight", 1, "of the promise");
  for (const double away : {0.0, 0x1p-1074, 1e-300, 1e-200, 1e-162, 1e-160, 1e-150, 1e-30}) {
    for (const Vec3d& to : {Vec3d{0, 0, 1}, Vec3d{1, 1, 1}, Vec3d{-1, 2, 3}, Vec3d{1, 0, -1}}) {
      auto scene = std::make_shared<Scene>();
      scene->materials = {test::Matte({0.5, 0, 1})};
      scene->materials[0].specular = {0.5, 0.5, 0};
      scene->objects = {test::ObjectOf(test::Polygon({{1, -1, 0}, {0, 1, -1}, {-1, 0, 1}})),
                        test::ObjectOf(test::Sphere({-2, -2, -2}, 3))};
      scene->lights = {test::PointLight(to * away, {1, 1, 0})};
      std::vector<Ray> rays = {{{0, 0, 2}, {0, 0, -1}}, {{1, 1, 1}, {-1, -1, -1}}};
      AddFocused({}, 1, 400, random, rays);
      SCOPED_TRACE(testing::Message() << to.x << " " << to.y << " " << to.z << " times " << away);
      ExpectPromise(scene, rays, largest);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, HardSceneTest, testing::ValuesIn(AllHardScenes()),
                         [](const auto& scene) { return std::string(scene.param.name); });

}  // namespace
}  // namespace linetree::stress
