#include "client/command/paper_tables.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace linetree {
namespace {

using ::testing::HasSubstr;

const std::string kScenes = std::string(LINETREE_SOURCE_DIR) + "/scenes";
const std::vector<std::string> kFrames = {"frame1", "frame2", "frame3", "frame4", "frame5"};

Sequence Measure(const SequenceSpec& spec) {
  WorkerPool pool(2);
  auto sequence = MeasureSequence(spec, kFrames, PaperBenchOptions{}, pool);
  EXPECT_EQ(sequence.status(), absl::OkStatus());
  return *std::move(sequence);
}

// What the project sets out to reach at epsilon 0.25; counts do not depend on the machine.
void ExpectReached(const Sequence& sequence, double success, double first_intersect,
                   double first_shade, double warm_intersect, double warm_shade) {
  ASSERT_EQ(sequence.rows.size(), kFrames.size());
  for (size_t i = 0; i < sequence.rows.size(); ++i) {
    const PaperRow& row = sequence.rows[i].row;
    EXPECT_GE(row.success, success) << row.label;
    EXPECT_LE(row.intersect.Ratio(), i == 0 ? first_intersect : warm_intersect) << row.label;
    EXPECT_LE(row.shade.Ratio(), i == 0 ? first_shade : warm_shade) << row.label;
    EXPECT_EQ(sequence.rows[i].error.beyond, 0u) << row.label;
  }
}

TEST(PaperTables, RoomReachesItsTargets) {
  const Sequence room = Measure(PaperSequences(kScenes)[2]);
  EXPECT_THAT(room.spec.title, HasSubstr("room, epsilon 0.25"));
  ExpectReached(room, 0.77, 1.25, 1.05, 0.58, 0.42);
}

TEST(PaperTables, FaceReachesItsTargets) {
  const Sequence face = Measure(PaperSequences(kScenes)[0]);
  EXPECT_THAT(face.spec.title, HasSubstr("face, epsilon 0.25"));
  ExpectReached(face, 0.70, 1.25, 1.05, 0.65, 0.45);
}

TEST(PaperTables, PrintedFiguresStandBesideMeasuredOnes) {
  Sequence sequence{PaperSequences(kScenes)[0], {}};
  MeasuredRow row;
  row.row = {"frame1", {1, 2, 6, 0}, {3, 4, 7, 0}, 0.5};
  sequence.rows.push_back(row);
  const std::string text = SequenceText(sequence);
  EXPECT_THAT(text, HasSubstr("0.50"));  // (1 + 2) / 6
  EXPECT_THAT(text, HasSubstr("1.06"));  // as printed, though 492 / 466 rounds to it too
  EXPECT_THAT(text, HasSubstr("70 %"));
  const nlohmann::json json = SequenceJson(sequence);
  EXPECT_EQ(json["rows"][0]["measured"]["intersect_thousands"]["ratio"], 0.5);
  EXPECT_EQ(json["rows"][0]["printed"]["shade_thousands"]["classical"], 159);
}

TEST(PaperTables, AMissingCameraIsNamed) {
  WorkerPool pool(1);
  const auto sequence =
      MeasureSequence(PaperSequences(kScenes)[0], {"frame9"}, PaperBenchOptions{}, pool);
  EXPECT_EQ(sequence.status().code(), absl::StatusCode::kNotFound);
  EXPECT_THAT(std::string(sequence.status().message()), HasSubstr("frame9"));
}

}  // namespace
}  // namespace linetree
