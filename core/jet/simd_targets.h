// Which of Highway's targets jets are compiled for. Included before anything of Highway's.
//
// Those left out have no wider vectors of doubles than the next one down: SSSE3 as SSE4, AVX3_DL as
// AVX3. Scalable vectors (SVE, RVV) can't be members of a pack.
#pragma once

#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
