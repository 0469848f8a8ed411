#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "core/io/exr.h"
#include "core/io/png.h"
#include "core/io/stats_json.h"
#include "tests/client/command/program.h"

namespace linetree {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using ::testing::UnorderedElementsAre;

std::vector<std::string> Render(const std::string& scene, std::vector<std::string> more) {
  more.insert(more.begin(), {"render", "--local", "--scene", SourceFile("scenes/" + scene),
                             "--width", "40", "--height", "30"});
  return more;
}

TEST(RenderCommand, WritesPicturesAndCountersThatAgree) {
  TempDir dir;
  const Finished run =
      RunLinetree(Render("gap.textproto", {"--epsilon", "0.25", "-o", dir.File("a.exr"), "-o",
                                           dir.File("a.png"), "--stats", dir.File("a.json")}));
  ASSERT_EQ(run.exit_status, 0) << run.err;
  EXPECT_EQ(run.err, "");
  EXPECT_THAT(run.out, HasSubstr("hit rate"));
  EXPECT_THAT(dir.Names(), UnorderedElementsAre("a.exr", "a.png", "a.json"));

  const absl::StatusOr<Frame> frame = ReadExr(dir.File("a.exr"));
  ASSERT_EQ(frame.status(), absl::OkStatus());
  EXPECT_EQ(frame->width, 40);
  EXPECT_EQ(frame->height, 30);
  EXPECT_EQ(frame->camera.name, "front");
  EXPECT_EQ(frame->max_relative_error, 0.25);
  EXPECT_EQ(ReadPng(dir.File("a.png"))->rgb, PaintLayer(*frame, Layer::kBeauty).rgb);

  const nlohmann::json json = ReadJson(dir.File("a.json"));
  EXPECT_EQ(json["pixels"], 1200);
  EXPECT_EQ(
      json["interpolated"].get<int>() + json["traced"].get<int>() + json["background"].get<int>(),
      1200);
  const auto count = [&frame](Source source) {
    return std::count(frame->source.begin(), frame->source.end(), source);
  };
  EXPECT_EQ(json["interpolated"], count(Source::kInterpolated));
  EXPECT_EQ(json["replayed"], count(Source::kReplayed));
  EXPECT_EQ(json["residual"], count(Source::kResidual));
  EXPECT_EQ(json["traced"],
            count(Source::kTraced) + count(Source::kReplayed) + count(Source::kResidual));
  EXPECT_EQ(json["background"], count(Source::kBackground));
  for (size_t v = 0; v < kVerdictCount; ++v) {
    EXPECT_EQ(json["verdicts"][std::string(kVerdictNames[v])],
              std::count(frame->verdict.begin(), frame->verdict.end(), static_cast<Verdict>(v)))
        << kVerdictNames[v];
  }
  EXPECT_EQ(json["intersect"], json["base_intersect"].get<int>() + json["ip_intersect"].get<int>());
  EXPECT_EQ(json["scene_version"], frame->scene_version);
}

TEST(RenderCommand, LayersOfAPngAreThoseOfTheExr) {
  TempDir dir;
  for (size_t i = 0; i < kLayerNames.size(); ++i) {
    const std::string layer(kLayerNames[i]);
    ASSERT_EQ(RunLinetree(Render("gap.textproto", {"--layer", layer, "-o", dir.File("a.exr"), "-o",
                                                   dir.File("a.png")}))
                  .exit_status,
              0);
    EXPECT_EQ(ReadPng(dir.File("a.png"))->rgb,
              PaintLayer(*ReadExr(dir.File("a.exr")), static_cast<Layer>(i)).rgb)
        << layer;
  }
}

TEST(RenderCommand, RepeatedFramesAreAllCounted) {
  TempDir dir;
  const Finished run = RunLinetree(
      Render("face.textproto", {"--frames", "3", "--quiet", "--stats", dir.File("a.json")}));
  ASSERT_EQ(run.exit_status, 0) << run.err;
  EXPECT_EQ(run.out, "");
  const nlohmann::json json = ReadJson(dir.File("a.json"));
  ASSERT_EQ(json["frames"].size(), 3u);
  EXPECT_GT(json["frames"][0]["cells_tried"], 0);
  EXPECT_LE(json["frames"][2]["cells_tried"], json["frames"][0]["cells_tried"]);
}

TEST(RenderCommand, ClassicalTracesEverything) {
  TempDir dir;
  ASSERT_EQ(
      RunLinetree(Render("peak.textproto", {"--mode", "classical", "--stats", dir.File("a.json")}))
          .exit_status,
      0);
  const nlohmann::json json = ReadJson(dir.File("a.json"));
  EXPECT_EQ(json["interpolated"], 0);
  EXPECT_EQ(json["cells_tried"], 0);
  EXPECT_GT(json["traced"], 0);
}

TEST(RenderCommand, PixelsHaveSeveralSamples) {
  TempDir dir;
  const auto render = [&](std::vector<std::string> flags) {
    flags.insert(flags.end(), {"--stats", dir.File("a.json"), "-o", dir.File("a.exr")});
    const Finished run = RunLinetree(Render("gap.textproto", flags));
    EXPECT_EQ(run.exit_status, 0) << run.err;
    return ReadExr(dir.File("a.exr"))->radiance;
  };
  const PixelLayer<float> one = render({"--lanes", "simd"});
  const PixelLayer<float> nine = render({"--lanes", "simd", "--samples", "9"});
  EXPECT_NE(one, nine);
  const nlohmann::json json = ReadJson(dir.File("a.json"));
  const auto pixels = json["width"].get<int>() * json["height"].get<int>();
  EXPECT_EQ(json["pixels"], 9 * pixels);
  EXPECT_EQ(json["samples"], 9);
  const std::vector<std::string> jittered = {"--samples",     "9", "--sampling", "jittered",
                                             "--sample-seed", "4"};
  EXPECT_EQ(render(jittered), render(jittered));
  EXPECT_NE(render(jittered), nine);
  for (const char* samples : {"0", "65", "x"}) {
    const Finished run = RunLinetree(Render("gap.textproto", {"--samples", samples}));
    EXPECT_EQ(run.exit_status, 2);
    EXPECT_THAT(run.err, HasSubstr("--samples"));
  }
}

TEST(RenderCommand, ExplainsWhatWasLeftOut) {
  const Finished run =
      RunLinetree(Render("many_lights.textproto", {"--lanes", "simd", "--explain"}));
  ASSERT_EQ(run.exit_status, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("diffuse sums"));
  EXPECT_THAT(run.out, HasSubstr("decision(s): "));
  EXPECT_THAT(run.out, HasSubstr("floor"));
  const Finished scalar = RunLinetree(Render("gap.textproto", {"--explain"}));
  EXPECT_EQ(scalar.exit_status, 1);
  EXPECT_THAT(scalar.err, HasSubstr("--explain: expected --lanes simd"));
}

TEST(RenderCommand, TheViewCanBeGiven) {
  TempDir dir;
  ASSERT_EQ(RunLinetree(Render("gap.textproto", {"--eye", "-1,2,6", "--look-at", "0,.5,0", "--up",
                                                 "0,0,1", "--fov", "30", "-o", dir.File("a.exr")}))
                .exit_status,
            0);
  EXPECT_EQ(ReadExr(dir.File("a.exr"))->camera,
            (Camera{"", {-1, 2, 6}, {0, 0.5, 0}, {0, 0, 1}, 30}));
}

TEST(RenderCommand, AnswersDoNotDependOnTheNumberOfThreads) {
  TempDir dir;
  for (const char* threads : {"1", "3"}) {
    ASSERT_EQ(RunLinetree(Render("room.textproto", {"--threads", threads, "-o",
                                                    dir.File(std::string(threads) + ".exr")}))
                  .exit_status,
              0);
  }
  EXPECT_EQ(ReadExr(dir.File("1.exr"))->radiance, ReadExr(dir.File("3.exr"))->radiance);
}

// Bad input: one line that names the culprit, status 1, and nothing written.
void ExpectFailure(const std::vector<std::string>& arguments, const std::string& part) {
  const Finished run = RunLinetree(arguments);
  EXPECT_EQ(run.exit_status, 1) << part;
  EXPECT_THAT(run.err, StartsWith("linetree: "));
  EXPECT_THAT(run.err, HasSubstr(part));
  EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
}

TEST(RenderCommand, BadInputIsNamed) {
  TempDir dir;
  ExpectFailure({"render", "--local", "--scene", dir.File("none.nff")}, "none.nff: no such file");
  std::ofstream(dir.File("bad.textproto")) << "objects { sphere { radios: 1 } }";
  ExpectFailure({"render", "--local", "--scene", dir.File("bad.textproto")},
                "bad.textproto:1:26: ");
  ExpectFailure(Render("gap.textproto", {"--camera", "top"}), "no camera 'top'");
  ExpectFailure(Render("gap.textproto", {"--up", "0,0,0"}), "camera.up");
  ExpectFailure(Render("gap.textproto", {"--fov", "180"}), "camera.fov_deg");
  ExpectFailure(
      {"render", "--local", "--scene", SourceFile("scenes/gap.textproto"), "--width", "1000000"},
      "width");
}

TEST(RenderCommand, OutputThatCannotBeWrittenIsNamed) {
  TempDir dir;
  ExpectFailure(Render("gap.textproto", {"-o", dir.File("none/a.exr")}), "no folder");
  ExpectFailure(Render("gap.textproto", {"--stats", dir.File("none/a.json")}), "no folder");
  ExpectFailure(Render("gap.textproto", {"--stats", "/dev/full"}),
                "cannot write /dev/full: No space left on device");
  std::filesystem::create_directory(dir.path() / "a.png");
  ExpectFailure(Render("gap.textproto", {"-o", dir.File("a.png")}), "Is a directory");
  EXPECT_THAT(dir.Names(), ElementsAre("a.png"));
}

TEST(RenderCommand, NoServerIsSaid) {
  ExpectFailure(
      {"render", "--server", "127.0.0.1:1", "--connect-timeout", "0.1", "--scene", "room"},
      "127.0.0.1:1");
}

}  // namespace
}  // namespace linetree
