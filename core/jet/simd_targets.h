// Which of Highway's targets are compiled for. Included before anything of Highway's.
//
// Those left out have no wider vectors of doubles than the next one down: SSSE3 as SSE4, AVX3_DL as
// AVX3. Scalable vectors (SVE, RVV) can't be members of a pack. LINETREE_FEW_TARGETS leaves one
// that is wide, and the baseline: where the time of compiling counts more than that of running;
// LINETREE_WIDEST_TARGET the widest of x86 and the baseline: for whoever measures while he edits.
#pragma once

#define LINETREE_USELESS_TARGETS \
  (HWY_SSSE3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#ifdef LINETREE_FEW_TARGETS
#define HWY_DISABLED_TARGETS (LINETREE_USELESS_TARGETS | HWY_SSE4 | HWY_AVX3)
#elif defined(LINETREE_WIDEST_TARGET)
#define HWY_DISABLED_TARGETS (LINETREE_USELESS_TARGETS | HWY_SSE4 | HWY_AVX2)
#else
#define HWY_DISABLED_TARGETS LINETREE_USELESS_TARGETS
#endif
