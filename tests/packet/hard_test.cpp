// Packets against the scalar tracer where rounding decides: hard scenes, hard rays.
#include "core/render/scene_host.h"
#include "tests/packet/packet_check.h"
#include "tests/stress/hard_rays.h"
#include "tests/stress/hard_scenes.h"
#include "tests/stress/stress.h"

namespace linetree::test {
namespace {

class Hard : public testing::TestWithParam<stress::NamedScene> {};

TEST_P(Hard, DecidedAsTheScalarTracerDoes) {
  CheckTotals totals;
  Random random = stress::RandomFor(std::string("packets ") + GetParam().name);
  for (int i = 0; i < stress::Times(6); ++i) {
    const Scene scene = GetParam().make(random);
    const Tracer tracer(scene);
    const PacketTracer packets(tracer);
    std::vector<Ray> rays;
    for (const Ray& ray : stress::HardRays(scene, 800, random)) {
      const auto unit = UnitRay(ray, rays.size());
      if (unit.ok()) rays.push_back(*unit);
    }
    CheckPackets(packets, WithSpawned(tracer, rays, {}), {}, GetParam().name, totals);
  }
  Print(GetParam().name, totals);
  EXPECT_EQ(totals.wrong, 0u);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Hard, testing::ValuesIn(stress::AllHardScenes()),
                         [](const auto& info) {
                           std::string name = info.param.name;
                           std::erase_if(name, [](char c) { return !std::isalnum(c); });
                           return name;
                         });

}  // namespace
}  // namespace linetree::test
