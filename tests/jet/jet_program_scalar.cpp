#include "tests/jet/jet_program-inl.h"

namespace linetree::test {

JetProgramOutput RunScalarJets(const JetProgramInput& input) {
  return scalar_jets::RunJetProgram(input);
}

}  // namespace linetree::test
