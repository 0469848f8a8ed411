#include "core/jet/interval.h"
#include "core/jet/simd_targets.h"
#include "core/math/vec3.h"
#include "tests/jet/jet_program.h"

#define LINETREE_SIMD_JETS
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/jet/jet_program_simd.cpp"
#include "hwy/foreach_target.h"
// After foreach_target.h.
#include "hwy/highway.h"
#include "tests/jet/jet_program-inl.h"

#if HWY_ONCE
namespace linetree {

HWY_EXPORT(RunJetProgram);

test::JetProgramOutput test::RunSimdJets(const JetProgramInput& input) {
  return HWY_DYNAMIC_DISPATCH(RunJetProgram)(input);
}

}  // namespace linetree
#endif
