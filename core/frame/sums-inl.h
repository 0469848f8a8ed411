// Sums of diffuse light (DiffuseSum::At), sixteen points at a time, in float. What that rounds is
// part of every sum's spread.
#if defined(LINETREE_CORE_FRAME_SUMS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_FRAME_SUMS_INL_H_
#undef LINETREE_CORE_FRAME_SUMS_INL_H_
#else
#define LINETREE_CORE_FRAME_SUMS_INL_H_
#endif

#include "core/packet/lanes-inl.h"
#include "core/tree/diffuse_sum.h"

HWY_BEFORE_NAMESPACE();
namespace linetree::HWY_NAMESPACE {

// Lagrange's, for nodes at 0, 1/3, 2/3, 1.
HWY_INLINE void CubicWeights(const Floats& x, Floats weight[4]) {
  const Floats a = x * Floats::All(3), b = a - Floats::All(1), c = a - Floats::All(2),
               d = a - Floats::All(3);
  const Floats ab = a * b, cd = c * d;
  weight[0] = b * cd * Floats::All(-1.0f / 6);
  weight[1] = a * cd * Floats::All(0.5f);
  weight[2] = ab * d * Floats::All(-0.5f);
  weight[3] = ab * c * Floats::All(1.0f / 6);
}

// s, t in [0, 1] over the cell.
HWY_INLINE void SumAt(const DiffuseSum& sum, const Floats& s, const Floats& t, Floats out[3]) {
  Floats along_s[4], along_t[4];
  if (sum.nodes == 2) {
    along_s[0] = Floats::All(1) - s;
    along_s[1] = s;
    along_t[0] = Floats::All(1) - t;
    along_t[1] = t;
  } else {
    CubicWeights(s, along_s);
    CubicWeights(t, along_t);
  }
  for (size_t c = 0; c < 3; ++c) {
    Floats total = Floats::All(0);
    for (int j = 0; j < sum.nodes; ++j) {
      const auto* row = &sum.value[static_cast<size_t>(j * sum.nodes)];
      Floats line = along_s[0] * Floats::All(row[0][c]);
      for (int i = 1; i < sum.nodes; ++i) {
        line = MulAdd(along_s[i], Floats::All(row[i][c]), line);
      }
      total = MulAdd(along_t[j], line, total);
    }
    out[c] = total;
  }
}

}  // namespace linetree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
