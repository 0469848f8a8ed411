#include "core/audit/cell_study.h"

#include <gtest/gtest.h>

namespace linetree {
namespace {

CellStudyOptions Small(SparseFamily family) {
  CellStudyOptions options;
  options.families = {family};
  options.scenes = 12;
  options.edges = {0.125, 0.03125};
  return options;
}

std::vector<CellStudyRow> Studied(const CellStudyOptions& options, int threads = 2) {
  WorkerPool pool(threads);
  return StudyCells(options, pool, [](double) {});
}

class CellStudyTest : public testing::TestWithParam<SparseFamily> {};

TEST_P(CellStudyTest, AnswersOfCertifiedCellsKeepTheirBound) {
  for (const CellStudyRow& row : Studied(Small(GetParam()))) {
    EXPECT_EQ(row.family, GetParam());
    EXPECT_GT(row.cells, 400u);
    EXPECT_GT(row.same_paths, row.cells / 10);
    EXPECT_GT(row.queries, 10 * row.same_paths);
    EXPECT_EQ(row.violations, 0u);
    EXPECT_EQ(row.replay_differences, 0u);
    EXPECT_GT(row.largest_error, 0.2);
    EXPECT_LE(row.largest_error, 1);
  }
}

TEST_P(CellStudyTest, EveryCellIsAcceptedOrHasAReason) {
  const auto rows = Studied(Small(GetParam()));
  for (const CellStudyRow& row : rows) {
    uint64_t doubted = 0;
    for (const uint64_t count : row.doubts) doubted += count;
    EXPECT_EQ(row.doubts[static_cast<size_t>(Doubt::kNone)], 0u);
    EXPECT_EQ(row.same_paths + doubted, row.cells);
    for (size_t i = 1; i < row.certified.size(); ++i) {
      EXPECT_LE(row.certified[i - 1], row.certified[i]);
      EXPECT_LE(row.paper[i - 1], row.paper[i]);
    }
    EXPECT_LE(row.certified.back(), row.same_paths);
    // Where the bound holds, samples are within it; most of what they show is certified.
    for (size_t i = 0; i < row.certified.size(); ++i) {
      EXPECT_GE(row.sampled[i], row.certified[i]);
      EXPECT_GE(row.sampled[i], row.sampled_isotopic[i]);
      EXPECT_GE(row.isotopic, row.sampled_isotopic[i]);
      EXPECT_LT(row.sampled[i], 2 * row.certified[i]);
    }
  }
  const auto share = [](const CellStudyRow& row) {
    return static_cast<double>(row.certified[0]) / static_cast<double>(row.cells);
  };
  EXPECT_LT(share(rows[0]), share(rows[1]));
}

TEST_P(CellStudyTest, ThreadsDoNotMatter) {
  const auto one = Studied(Small(GetParam()), 1), three = Studied(Small(GetParam()), 3);
  for (size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].certified, three[i].certified);
    EXPECT_EQ(one[i].paper, three[i].paper);
    EXPECT_EQ(one[i].doubts, three[i].doubts);
  }
}

INSTANTIATE_TEST_SUITE_P(Families, CellStudyTest,
                         testing::Values(SparseFamily::kEven, SparseFamily::kOpaque),
                         [](const auto& info) {
                           return std::string(kSparseFamilyNames[static_cast<size_t>(info.param)]);
                         });

}  // namespace
}  // namespace linetree
