// Surface cells with shadow functions and without: what both say, and that the tracer's answer is
// its own, bit for bit.
#include "core/audit/light_study.h"

#include <gtest/gtest.h>

#include "core/audit/scene_families.h"
#include "core/cache/surface_cache.h"
#include "core/trace/shade.h"
#include "tests/support/demo_scenes.h"

namespace linetree {
namespace {

constexpr int kSide = 48;

const ParallelLoop kInTurn = [](size_t count, const std::function<void(size_t)>& body) {
  for (size_t i = 0; i < count; ++i) body(i);
};

struct Seen {
  Ray ray;
  Hit hit;
};

std::vector<Seen> SeenBy(const Tracer& tracer, const Camera& camera) {
  const EyeRays rays(camera, kSide, kSide);
  std::vector<Seen> seen;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const Ray ray = rays.ThroughPixel(x, y);
      const Hit hit = tracer.Intersect(ray.origin, ray.direction, {});
      if (hit.IsHit()) seen.push_back({ray, hit});
    }
  }
  return seen;
}

struct Tally {
  uint64_t answers = 0, unequal = 0, states = 0, wrong_states = 0, with_functions = 0;
};

// States of the lights that the cell at a hit is sure of, against shadow rays.
void CheckStates(const Tracer& tracer, const Hit& hit, const KnownLights& known, Tally& tally) {
  if (known.lists == nullptr || hit.side == Side::kInside) return;
  tally.with_functions += known.shadows != nullptr ? 1 : 0;
  for (size_t i = 0; i < tracer.scene().lights.size(); ++i) {
    const LightKnowledge knowledge = known.lists[i].knowledge;
    if (knowledge != LightKnowledge::kOn && knowledge != LightKnowledge::kOff) continue;
    const auto shadow =
        tracer.CastShadow(hit.point, static_cast<int>(i), {hit.object, hit.face, hit.side});
    const bool is_on = shadow.term.state == LightState::kLit && shadow.term.crossings == 0;
    const bool is_off = shadow.term.state == LightState::kBlocked;
    ++tally.states;
    tally.wrong_states += (knowledge == LightKnowledge::kOn ? is_on : is_off) ? 0 : 1;
  }
}

void Check(const Scene& scene, bool functions, Tally& tally) {
  const Tracer tracer(scene);
  // Small cells: their sides are where rounding matters.
  SurfaceCache cache(tracer, uint64_t{1} << 28, 20, functions);
  for (const Camera& camera : scene.cameras) {
    const std::vector<Seen> seen = SeenBy(tracer, camera);
    for (int round = 0; round < 4; ++round) {
      {
        const SurfaceCache::Reader reader(cache);
        for (const Seen& s : seen) reader.Find(s.hit);
      }
      cache.Refine(4, kInTurn);
    }
    const SurfaceCache::Reader reader(cache);
    for (const Seen& s : seen) {
      RayCounts counts;
      const PathLimits limits;
      const Rgb classical =
          tracer.RadianceFromHit(s.hit, s.ray.origin, s.ray.direction, limits, counts);
      const Rgb listed = tracer.RadianceFromHit(s.hit, s.ray.origin, s.ray.direction, limits,
                                                reader, nullptr, counts);
      ++tally.answers;
      tally.unequal += classical == listed ? 0 : 1;
      CheckStates(tracer, s.hit, reader.Find(s.hit), tally);
    }
  }
}

class LightStudyTest : public testing::TestWithParam<int> {};

TEST_P(LightStudyTest, AnswersAreTheTracersWithAndWithoutFunctions) {
  for (const bool functions : {false, true}) {
    Tally tally;
    for (uint64_t seed = 100; seed < 108; ++seed) {
      Check(*MakeFamilyScene(static_cast<SceneFamily>(GetParam()), seed), functions, tally);
    }
    EXPECT_EQ(tally.unequal, 0u) << "of " << tally.answers;
    EXPECT_EQ(tally.wrong_states, 0u) << "of " << tally.states;
    EXPECT_GT(tally.states, 1'000u);
    if (functions) {
      EXPECT_GT(tally.with_functions, 100u);
    } else {
      EXPECT_EQ(tally.with_functions, 0u);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Families, LightStudyTest, testing::Range(0, kSceneFamilies),
                         [](const auto& info) {
                           std::string name(kSceneFamilyNames[static_cast<size_t>(info.param)]);
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST(LightStudy, CountsEveryLightOnce) {
  const auto scene = MakeFamilyScene(SceneFamily::kWalls, 5);
  WorkerPool pool(1);
  const auto with = StudyLights(*scene, scene->cameras.at(0), 64, 50, true, pool);
  const auto without = StudyLights(*scene, scene->cameras.at(0), 64, 50, false, pool);
  EXPECT_EQ(with.covered, without.covered);
  EXPECT_EQ(with.decided + with.undecided, without.decided + without.undecided);
  EXPECT_EQ(without.answered, 0u);
  EXPECT_LE(with.answered, with.candidates);
}

// What shadow functions answer for is not worth as many cells.
TEST(LightStudy, FunctionsSpareCells) {
  uint64_t with_cells = 0, without_cells = 0;
  WorkerPool pool(1);
  for (uint64_t seed = 5; seed < 9; ++seed) {
    const auto scene = MakeFamilyScene(SceneFamily::kWalls, seed);
    const auto with = StudyLights(*scene, scene->cameras.at(0), 128, 25, true, pool);
    const auto without = StudyLights(*scene, scene->cameras.at(0), 128, 25, false, pool);
    with_cells += with.cells;
    without_cells += without.cells;
    // Curved receivers have none, and their cells stay.
    EXPECT_LE(with.cells, without.cells) << seed;
  }
  EXPECT_LT(with_cells, 3 * without_cells / 4);
  EXPECT_GT(with_cells, without_cells / 10) << "what is undecided is divided all the same";
}

}  // namespace
}  // namespace linetree
