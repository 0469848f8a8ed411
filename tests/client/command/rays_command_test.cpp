#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/io/exr.h"
#include "tests/client/command/program.h"

namespace linetree {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

std::vector<std::string> Rays(std::vector<std::string> more) {
  more.insert(more.begin(), {"rays", "--local", "--scene", SourceFile("scenes/gap.textproto")});
  return more;
}

// The rays of a picture's pixels must come back as the picture: one answer per ray, in order.
TEST(RaysCommand, RaysThroughPixelsGiveThePicture) {
  TempDir dir;
  ASSERT_EQ(
      RunLinetree({"render", "--local", "--scene", SourceFile("scenes/gap.textproto"), "--width",
                   "8", "--height", "6", "--mode", "classical", "-o", dir.File("a.exr")})
          .exit_status,
      0);
  const auto frame = ReadExr(dir.File("a.exr"));
  ASSERT_EQ(frame.status(), absl::OkStatus());
  std::ostringstream rays;
  rays.precision(17);
  const EyeRays eye_rays(frame->camera, 8, 6);
  for (int i = 0; i < 48; ++i) {
    const Ray ray = eye_rays.ThroughPixel(i % 8, i / 8);
    rays << ray.origin.x << ' ' << ray.origin.y << ' ' << ray.origin.z << ' ' << ray.direction.x
         << ' ' << ray.direction.y << ' ' << ray.direction.z << '\n';
  }
  const Finished run = RunLinetree(Rays({"--input", "-", "--mode", "classical"}), rays.str());
  ASSERT_EQ(run.exit_status, 0) << run.err;
  std::istringstream out(run.out);
  for (size_t i = 0; i < 48; ++i) {
    float r = 0, g = 0, b = 0;
    std::string source, depth;
    int object = 0;
    ASSERT_TRUE(out >> r >> g >> b >> source >> object >> depth) << "line " << i;
    // Directions are normalised again, which may move the last bit of what follows from them.
    EXPECT_NEAR(r, frame->radiance[3 * i], 1e-6);
    EXPECT_NEAR(g, frame->radiance[3 * i + 1], 1e-6);
    EXPECT_NEAR(b, frame->radiance[3 * i + 2], 1e-6);
    EXPECT_EQ(object, frame->object[i]);
    EXPECT_EQ(source, object < 0 ? "background" : "traced");
  }
  std::string rest;
  EXPECT_FALSE(out >> rest);
}

TEST(RaysCommand, JsonHasAnswersAndCounters) {
  TempDir dir;
  std::ofstream(dir.File("r.txt")) << "# two rays\n0 5 0 0 -2 0\n0 5 0 0 1 0\n";
  const Finished run =
      RunLinetree(Rays({"--input", dir.File("r.txt"), "--json", "--stats", dir.File("s.json")}));
  ASSERT_EQ(run.exit_status, 0) << run.err;
  const nlohmann::json json = nlohmann::json::parse(run.out);
  ASSERT_EQ(json["rays"].size(), 2u);
  EXPECT_GE(json["rays"][0]["object"], 0);
  EXPECT_EQ(json["rays"][0]["depth"], 5.0);  // the mirror at y = 0, between the blocks
  EXPECT_EQ(json["rays"][1]["object"], -1);
  EXPECT_EQ(json["rays"][1]["source"], "background");
  EXPECT_EQ(json["stats"]["pixels"], 2);
  EXPECT_EQ(ReadJson(dir.File("s.json")), json["stats"]);
}

TEST(RaysCommand, RaysGoByPacketsToo) {
  TempDir dir;
  std::ostringstream rays;
  for (int i = 0; i < 40; ++i) rays << 0.1 * i - 2 << " 5 0 0.1 -2 0.02\n";
  nlohmann::json runs[2];
  for (const char* lanes : {"scalar", "simd"}) {
    const Finished run = RunLinetree(
        Rays({"--input", "-", "--json", "--mode", "classical", "--lanes", lanes}), rays.str());
    ASSERT_EQ(run.exit_status, 0) << run.err;
    runs[lanes == std::string("simd")] = nlohmann::json::parse(run.out);
  }
  const double rounding = runs[1]["stats"]["lane_rounding"];
  EXPECT_EQ(runs[0]["stats"]["lane_rounding"], 0.0);
  EXPECT_GT(rounding, 0);
  for (size_t i = 0; i < 40; ++i) {
    const nlohmann::json &scalar = runs[0]["rays"][i], &simd = runs[1]["rays"][i];
    EXPECT_EQ(simd["object"], scalar["object"]);
    EXPECT_EQ(simd["depth"], scalar["depth"]);
    for (size_t c = 0; c < 3; ++c) {
      const double truth = scalar["radiance"][c];
      EXPECT_NEAR(simd["radiance"][c], truth, rounding * std::max(truth, 1.0 / 1024));
    }
  }
}

TEST(RaysCommand, BadLinesAreNumbered) {
  const Finished run = RunLinetree(Rays({"--input", "-"}), "0 0 0 0 0 1\n0 0 0 zero 0 1\n");
  EXPECT_EQ(run.exit_status, 1);
  EXPECT_THAT(run.err, StartsWith("linetree: standard input:2: expected six finite numbers"));
}

TEST(RaysCommand, AMissingFileIsNamed) {
  const Finished run = RunLinetree(Rays({"--input", "no/such/rays.txt"}));
  EXPECT_EQ(run.exit_status, 1);
  EXPECT_THAT(run.err, HasSubstr("cannot read no/such/rays.txt"));
}

TEST(RaysCommand, NoRaysAreNoError) {
  const Finished run = RunLinetree(Rays({"--input", "-"}), "");
  EXPECT_EQ(run.exit_status, 0) << run.err;
  EXPECT_EQ(run.out, "");
}

}  // namespace
}  // namespace linetree
