// Scenes and rays at the edges of what is allowed: certified answers keep their promise.
#include "tests/stress/promise.h"

#include <gtest/gtest.h>

#include "tests/stress/hard_rays.h"
#include "tests/stress/hard_scenes.h"

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

INSTANTIATE_TEST_SUITE_P(All, HardSceneTest, testing::ValuesIn(AllHardScenes()),
                         [](const auto& scene) { return std::string(scene.param.name); });

}  // namespace
}  // namespace linetree::stress
