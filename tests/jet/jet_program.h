// What every operation on jets gives, in two instances: with SIMD and without.
#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

namespace linetree::test {

struct JetProgramInput {
  int dimension = 4;
  double constant = 1;
  std::array<std::array<double, 12>, 2> numbers;
};
// An operation, and all the numbers of the jet that it gave.
using JetProgramOutput = std::vector<std::pair<std::string, std::vector<double>>>;

JetProgramOutput RunScalarJets(const JetProgramInput& input);
JetProgramOutput RunSimdJets(const JetProgramInput& input);

}  // namespace linetree::test
