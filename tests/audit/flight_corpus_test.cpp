#include "core/audit/flight_corpus.h"

#include <gtest/gtest.h>

#include "tests/support/demo_scenes.h"

namespace linetree {
namespace {

std::vector<Camera> Views(const Scene& scene, FlightPattern pattern, int frames) {
  return FlightViews(scene, scene.cameras[0], pattern, frames);
}

TEST(FlightCorpus, PatternsAreWhatTheySay) {
  const auto scene = test::BallsOnFloor(5, 3);
  for (size_t i = 0; i < kFlightPatternNames.size(); ++i) {
    const auto views = Views(*scene, static_cast<FlightPattern>(i), 80);
    ASSERT_EQ(views.size(), 80u);
    for (const Camera& camera : views) EXPECT_TRUE(ValidateCamera(camera).ok());
    EXPECT_EQ(views, Views(*scene, static_cast<FlightPattern>(i), 80)) << "the same every time";
  }
  // Four laps.
  const auto orbit = Views(*scene, FlightPattern::kOrbit, 80);
  EXPECT_LT(Length(orbit[3].eye - orbit[43].eye), 1e-9);
  EXPECT_GT(Length(orbit[3].eye - orbit[13].eye), 0.1);
  // There and back again.
  const auto bounced = Views(*scene, FlightPattern::kBackAndForth, 80);
  EXPECT_LT(Length(bounced[18].eye - bounced[22].eye), 1e-9);
  // The second client comes by where the first one was.
  const auto four = Views(*scene, FlightPattern::kFourClients, 400);
  EXPECT_LT(Length(four[1].eye - four[20].eye), 0.2 * Length(four[1].eye - four[0].eye));
}

TEST(FlightCorpus, RecordsEveryFrame) {
  const auto scene = test::BallsOnFloor(5, 3);
  WorkerPool pool(2);
  FlightTraceOptions options{48, 48, {}};
  double done = 0;
  const auto trace = RecordFlight(scene, Views(*scene, FlightPattern::kOrbit, 8), options, pool,
                                  [&](double share) { done = share; });
  ASSERT_TRUE(trace.ok()) << trace.status();
  EXPECT_EQ(done, 1);
  const WorkingSet set = WorkingSetOf(*trace);
  EXPECT_GT(set.items, 10u);
  EXPECT_GT(trace->size(), 2 * set.items) << "frames have cells in common";
  EXPECT_LE(trace->back().time, 7u);
}

}  // namespace
}  // namespace linetree
