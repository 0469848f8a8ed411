#include "core/certify/curved_screen.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <vector>

#include "core/certify/curved_terms.h"
#include "core/certify/diffuse_summer.h"
#include "tests/support/random_scene.h"

namespace linetree {
namespace {

// A ball, ellipsoid or frustum under lamps near and far, some of which fade, and the sun.
Scene CurvedUnderLights(test::ShapeKind kind, test::Random& random) {
  Scene scene;
  test::AddMaterial(scene, test::Matte({0.5, 0.6, 0.7}));
  test::AddObject(scene, test::RandomShape(kind, random, 1, random.InCube(3)), 0);
  for (int i = 0; i < 12; ++i) {
    scene.lights.push_back(test::PointLight(
        scene.objects[0].bounds.Center() + random.Direction() * random.LogUniform(0.5, 1e4),
        test::RandomRgb(random, 1)));
    if (i % 3 != 0) continue;
    scene.lights.back().fade_distance = random.LogUniform(0.1, 30);
    scene.lights.back().fade_power = random.Uniform(0.3, 8);
  }
  scene.lights.push_back(test::DirectionalLight(random.Direction(), {0.3, 0.2, 0.1}));
  return scene;
}

struct Judged {
  int taken = 0, refused = 0, screened = 0;
};

// All lights over random cells of the object's curved patches.
void Judge(const Scene& scene, test::Random& random, Judged& judged) {
  const Shape& shape = scene.objects[0].shape;
  const JetShape jet_shape = MakeJetShape(scene.objects[0]);
  std::vector<size_t> lights(scene.lights.size());
  for (size_t i = 0; i < lights.size(); ++i) lights[i] = i;
  std::vector<CurvedTerm> terms(lights.size());
  const int patches = std::holds_alternative<SphereShape>(shape) ? 6 : 4;
  for (int round = 0; round < 20; ++round) {
    const int patch = random.Below(patches);
    const SurfaceCell cell =
        CellAt({patch, random.Uniform(0, 1), random.Uniform(0, 1)}, random.Below(9));
    const CurvedScreen screen(shape, patch, cell);
    const CurvedTask task{scene, jet_shape, patch, cell, SurfaceChart(scene.objects[0]).Slack(),
                          lights};
    if (!FindCurvedTermsScalar(task, terms.data())) continue;
    EXPECT_FALSE(screen.HasApex());
    for (size_t i = 0; i < lights.size(); ++i) {
      const bool is_taken = terms[i].is_known && terms[i].error <= kMaxTermSpread * terms[i].least;
      const bool may_be = screen.MayBeLinear(scene.lights[i], kMaxTermSpread);
      EXPECT_TRUE(may_be || !is_taken) << "light " << i << ", depth " << int{cell.depth};
      (is_taken ? judged.taken : judged.refused) += 1;
      judged.screened += may_be ? 0 : 1;
    }
  }
}

TEST(CurvedScreen, RefusesWhatJetsRefuse) {
  test::Random random(77);
  Judged judged;
  for (const test::ShapeKind kind : test::kShapeKinds) {
    for (int i = 0; i < 30; ++i) {
      const Scene scene = CurvedUnderLights(kind, random);
      const Shape& shape = scene.objects[0].shape;
      const bool is_curved =
          std::holds_alternative<SphereShape>(shape) || std::holds_alternative<FrustumShape>(shape);
      if (is_curved) Judge(scene, random, judged);
    }
  }
  std::printf("%d taken, %d refused, of which the screen %d\n", judged.taken, judged.refused,
              judged.screened);
  EXPECT_GT(judged.taken, 2000);
  EXPECT_GT(judged.screened, judged.refused / 2) << "then it is not worth its price";
}

}  // namespace
}  // namespace linetree
