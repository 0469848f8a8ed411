#include <gtest/gtest.h>

#include "core/tree/light_certifier.h"

namespace linetree {
namespace {

// A cell under so many lights that are on and so many that one candidate each leaves open, which
// has a function where `pieces` is positive.
CellLights CellUnder(size_t on, size_t open, uint8_t pieces) {
  CellLights cell;
  cell.objects.assign(open, 7);
  cell.functions.assign(open, ShadowFunction{.pieces = pieces});
  cell.lights.assign(on, LightList{.knowledge = LightKnowledge::kOn});
  for (size_t i = 0; i < open; ++i) {
    cell.lights.push_back({.knowledge = LightKnowledge::kListed,
                           .candidates = std::span(cell.objects).subspan(i, 1)});
  }
  return cell;
}

double PatienceOf(CellLights cell) {
  cell.Weigh();
  return cell.Patience();
}

TEST(LightTasks, WhatHasToBeTestedIsDividedAtOnce) {
  EXPECT_EQ(PatienceOf(CellUnder(3, 2, 0)), 1);
  CellLights without = CellUnder(3, 2, 1);
  without.functions.clear();
  EXPECT_EQ(PatienceOf(std::move(without)), 1);
  CellLights unknown = CellUnder(3, 2, 1);
  unknown.lights[0].knowledge = LightKnowledge::kUnknown;
  EXPECT_EQ(PatienceOf(std::move(unknown)), 1);
  CellLights partly = CellUnder(3, 2, 1);
  partly.functions.back().pieces = 0;
  EXPECT_EQ(PatienceOf(std::move(partly)), 1) << "one function is missing";
}

// The more lights a division could decide, the sooner; the more of them are certified in vain, the
// later.
TEST(LightTasks, WhatFunctionsAnswerIsWorthFewerCells) {
  double last = Box3::kInf;
  for (const size_t open : {1, 2, 8, 64}) {
    const double patience = PatienceOf(CellUnder(3, open, 1));
    EXPECT_LT(patience, last);
    EXPECT_GT(patience, 1);
    EXPECT_GT(PatienceOf(CellUnder(40, open, 1)), patience);
    last = patience;
  }
  EXPECT_LT(PatienceOf(CellUnder(3, 1, 1)), 8) << "it is divided in the end";
  CellLights unsummed = CellUnder(3, 1, 1);
  unsummed.unsummed = 12;
  EXPECT_LT(PatienceOf(std::move(unsummed)), PatienceOf(CellUnder(3, 1, 1))) << "sums gain as well";
}

}  // namespace
}  // namespace linetree
