#include "client/command/error_sweep.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/command/local_client.h"
#include "core/io/wire.h"

namespace linetree {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(ErrorSweep, Medians) {
  EXPECT_EQ(Median({3}), 3);
  EXPECT_EQ(Median({9, 1, 5}), 5);
  EXPECT_EQ(Median({4, 1, 9, 2}), 3);
}

TEST(ErrorSweep, RowsOfASmallScene) {
  const auto file =
      ReadSceneFileChecked(std::string(LINETREE_SOURCE_DIR) + "/scenes/peak.textproto");
  ASSERT_EQ(file.status(), absl::OkStatus());
  LocalClient client(1, uint64_t{64} << 20);
  ErrorSweepOptions options;
  options.request.camera = file->scene->cameras[0];
  options.request.width = options.request.height = 48;
  options.request.options.judge = JudgeKind::kPaper;  // errs even in small pictures
  options.epsilons = {0, 0.5};
  options.repeats = 2;
  double share = 0;
  const auto rows =
      SweepErrors(client, *file, "sweep", options, [&share](double done) { share = done; });
  ASSERT_EQ(rows.status(), absl::OkStatus());
  ASSERT_EQ(rows->size(), 2u);
  EXPECT_EQ(share, 1);
  const ErrorSweepRow& exact = (*rows)[0];
  EXPECT_EQ(exact.epsilon, 0);
  EXPECT_EQ(exact.cold.max, 0);
  EXPECT_EQ(exact.warm.max, 0);
  EXPECT_EQ(exact.warm.pixels, 48u * 48);
  const ErrorSweepRow& loose = (*rows)[1];
  EXPECT_GT(loose.warm_success, 0);
  EXPECT_GE(loose.warm_success, loose.cold_success);
  EXPECT_GT(loose.warm.max, 0);
  EXPECT_GT(loose.classical_ms, 0);
  // What was loaded for the measurement is gone.
  EXPECT_THAT(*client.ListScenes(), IsEmpty());
}

TEST(ErrorSweep, CsvHasALineForEveryRow) {
  ErrorSweepRow row{.epsilon = 0.25, .classical_ms = 10, .cold_ms = 20, .warm_ms = 5};
  row.warm.max = 0.125;
  const std::string csv = ErrorSweepCsv({row, row});
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 3);
  EXPECT_THAT(csv, HasSubstr("epsilon,classical_ms,cold_ms,warm_ms,"));
  EXPECT_THAT(csv, HasSubstr("\n0.25,10.000,20.000,5.000,"));
  EXPECT_THAT(csv, HasSubstr(",0.125,"));
}

TEST(ErrorSweep, OnePlotEachForTimeSuccessAndError) {
  const std::vector<Plot> plots = ErrorSweepPlots({{.epsilon = 0.5}}, "room");
  ASSERT_EQ(plots.size(), 3u);
  EXPECT_THAT(plots[0].title, HasSubstr("run time"));
  EXPECT_TRUE(plots[2].y.logarithmic);
}

}  // namespace
}  // namespace linetree
