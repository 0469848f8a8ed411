// Fixed numbers of doubles that are worked on together: the lanes of corner jets.
//
// Files named -inl.h are compiled once for every instruction set. A source that defines
// LINETREE_SIMD_JETS and includes hwy/foreach_target.h compiles them for all targets of Google
// Highway, each in that target's own namespace; every other source gets the plain scalar twin. Both
// do the same operations in the same order, without contraction, so that their results are equal
// (but for the sign of zeros). All that an -inl.h file defines lives in LINETREE_JETS, between
// LINETREE_BEFORE_JETS() and LINETREE_AFTER_JETS(); what it includes besides is included before.
#if defined(LINETREE_SIMD_JETS)

#include "hwy/highway.h"
#undef LINETREE_JETS
#define LINETREE_JETS HWY_NAMESPACE
#define LINETREE_BEFORE_JETS() HWY_BEFORE_NAMESPACE()
#define LINETREE_AFTER_JETS() HWY_AFTER_NAMESPACE()
#if HWY_TARGET == HWY_SCALAR
#include "core/jet/scalar_pack-inl.h"
#else
#include "core/jet/simd_pack-inl.h"
#endif

#else

#undef LINETREE_JETS
#define LINETREE_JETS scalar_jets
#define LINETREE_BEFORE_JETS() static_assert(true)
#define LINETREE_AFTER_JETS() static_assert(true)
#include "core/jet/scalar_pack-inl.h"

#endif
