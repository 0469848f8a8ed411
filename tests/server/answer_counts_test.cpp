#include "server/answer_counts.h"

#include <google/protobuf/util/message_differencer.h>

#include "core/io/wire.h"
#include "tests/server/running_server.h"

namespace linetree {
namespace {

using Reply = v1::GetStatsReply;

uint64_t SumOf(const google::protobuf::Map<std::string, uint64_t>& counts) {
  uint64_t sum = 0;
  for (const auto& [name, count] : counts) sum += count;
  return sum;
}

// That the counts of a scene add up in every way that service.proto promises.
void ExpectSums(const Reply::SceneStats& scene) {
  uint64_t of_objects = 0;
  std::map<std::string, uint64_t> sources;
  for (const auto& object : scene.objects()) {
    const auto& answers = object.answers();
    EXPECT_EQ(SumOf(answers.sources()), answers.answers()) << object.name();
    EXPECT_EQ(SumOf(answers.verdicts()), answers.answers()) << object.name();
    EXPECT_FALSE(answers.sources().contains("background")) << object.name();
    of_objects += answers.answers();
    for (const auto& [name, count] : answers.sources()) sources[name] += count;
  }
  const auto& all = scene.answers();
  uint64_t background = 0;
  if (all.sources().contains("background")) background = all.sources().at("background");
  EXPECT_EQ(of_objects + background, all.answers());
  EXPECT_EQ(SumOf(all.sources()), all.answers());
  EXPECT_EQ(SumOf(all.verdicts()), all.answers());
  for (const auto& [name, count] : sources) EXPECT_EQ(count, all.sources().at(name)) << name;
}

TEST(AnswerCountsTest, RunsAreCountedAsSinglePixelsAre) {
  const std::vector<int32_t> object = {-1, -1, 3, 3, 3, 0, 3, -1};
  const std::vector<Source> source = {
      Source::kBackground, Source::kBackground,   Source::kTraced, Source::kTraced,
      Source::kReplayed,   Source::kInterpolated, Source::kTraced, Source::kBackground};
  const std::vector<Verdict> verdict = {Verdict::kUntried, Verdict::kUntried,   Verdict::kGap,
                                        Verdict::kBlocker, Verdict::kCertified, Verdict::kCertified,
                                        Verdict::kGap,     Verdict::kUntried};
  AnswerCounts whole, single;
  whole.Add(object, source, verdict);
  for (size_t i = 0; i < object.size(); ++i) {
    single.Add(std::span(&object[i], 1), std::span(&source[i], 1), std::span(&verdict[i], 1));
  }
  EXPECT_EQ(whole.values(), single.values());
  const AnswerCounts::Counts three = whole.values().at(3);
  EXPECT_EQ(three.sources, (std::array<uint64_t, kSourceCount>{0, 0, 3, 1, 0}));
  EXPECT_EQ(three.verdicts[static_cast<size_t>(Verdict::kGap)], 2u);
  EXPECT_EQ(whole.values().at(-1).sources[0], 3u);
  AnswerCounts::Counts sum;
  for (const auto& [index, counts] : whole.values()) sum += counts;
  EXPECT_EQ(whole.sum(), sum);
  EXPECT_EQ(single.sum(), sum);
}

// What metrics show without a look at cells and objects is what GetStats finds by looking.
TEST(AnswerCountsTest, SumsThatAreKeptAreThoseOfALookAtAll) {
  test::RunningServer running;
  Backend& backend = running.server().backend();
  FrameRequest request;
  request.width = request.height = 64;
  for (const auto judge : {JudgeKind::kCertified, JudgeKind::kPaper}) {
    request.options.judge = judge;
    for (int frame = 0; frame < 3; ++frame) {
      ASSERT_TRUE(running.client().RenderFrame("ball", request, "front", {}, nullptr).ok());
    }
  }
  const Reply looked = *backend.GetStats({});
  Reply::SceneStats scene = looked.scenes(0);
  ExpectSums(scene);
  uint64_t cells = 0;
  for (const auto& object : scene.objects()) cells += SumOf(object.cells());
  EXPECT_GT(cells, 0u);
  EXPECT_EQ(cells, scene.cells()) << "the sum that is kept, and the cells one by one";
  scene.clear_objects();
  const Reply kept = backend.GetSums();
  EXPECT_EQ(kept.scenes(0).SerializeAsString().size(), scene.SerializeAsString().size());
  EXPECT_TRUE(google::protobuf::util::MessageDifferencer::Equals(kept.scenes(0), scene));
  EXPECT_EQ(kept.memory_budget_bytes(), looked.memory_budget_bytes());
}

TEST(AnswerCountsTest, SumsAreExactOverFramesAndRays) {
  test::RunningServer running;
  FrameRequest request;
  request.width = 60;
  request.height = 40;
  uint64_t answers = 0;
  for (const Lanes lanes : {Lanes::kScalar, Lanes::kSimd}) {
    for (const Mode mode : {Mode::kCached, Mode::kCached, Mode::kClassical}) {
      request.options.lanes = lanes;
      request.options.mode = mode;
      ASSERT_TRUE(running.client().RenderFrame("ball", request, "front", {}, nullptr).ok());
      answers += 60 * 40;
    }
  }
  const std::vector<Ray> rays(500, Ray{{0, 3, 8}, {0, -0.3, -1}});
  ASSERT_TRUE(running.client().TraceRays("ball", rays, {}).ok());
  answers += 500;
  const auto stats = running.client().GetStats("ball");
  ASSERT_TRUE(stats.ok()) << stats.status();
  const Reply::SceneStats& scene = stats->scenes(0);
  ExpectSums(scene);
  EXPECT_EQ(scene.answers().answers(), answers);
  // One sample a pixel: the same answers as in the totals, by every source.
  const FrameStats totals = FrameStatsFromWire(scene.totals());
  EXPECT_EQ(totals.pixels, answers);
  const auto& sources = scene.answers().sources();
  EXPECT_EQ(sources.at("background"), totals.background);
  EXPECT_EQ(answers - totals.background - totals.traced, totals.interpolated);
  EXPECT_EQ(sources.at("replayed"), totals.replayed);
  for (size_t v = 0; v < kVerdictCount; ++v) {
    const auto found = scene.answers().verdicts().find(std::string(kVerdictNames[v]));
    EXPECT_EQ(found == scene.answers().verdicts().end() ? 0 : found->second, totals.verdicts[v])
        << kVerdictNames[v];
  }
  EXPECT_EQ(scene.objects_size(), 2);
}

}  // namespace
}  // namespace linetree
