// Vectors of corner jets: the few operations that rays need. As with single jets, what sums and
// products give is loose, and giving it a name (JetVector) tightens it.
#if defined(LINETREE_CORE_JET_JET_VECTOR_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_JET_JET_VECTOR_INL_H_
#undef LINETREE_CORE_JET_JET_VECTOR_INL_H_
#else
#define LINETREE_CORE_JET_JET_VECTOR_INL_H_
#endif

#include "core/jet/jet_functions-inl.h"
#include "core/math/vec3.h"

LINETREE_BEFORE_JETS();
namespace linetree::LINETREE_JETS {

template <AnyJet J>
struct JetVectorOf {
  J x, y, z;

  template <AnyJet K>
  operator JetVectorOf<K>() const {  // NOLINT(google-explicit-constructor)
    return {x, y, z};
  }

  static JetVectorOf Constant(const Vec3d& v) {
    return {J::Constant(v.x), J::Constant(v.y), J::Constant(v.z)};
  }
};
template <size_t D>
using JetVector = JetVectorOf<CornerJet<D>>;
template <size_t D>
using LooseVector = JetVectorOf<LooseJet<D>>;

template <AnyJet A, AnyJet B>
LooseVector<A::D> operator+(const JetVectorOf<A>& a, const JetVectorOf<B>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <AnyJet J>
JetVectorOf<J> operator-(const JetVectorOf<J>& a) {
  return {-a.x, -a.y, -a.z};
}
template <AnyJet J>
JetVectorOf<J> operator-(const JetVectorOf<J>& a, const Vec3d& b) {
  return {a.x + -b.x, a.y + -b.y, a.z + -b.z};
}
template <AnyJet J>
JetVectorOf<J> operator*(const JetVectorOf<J>& a, double k) {
  return {a.x * k, a.y * k, a.z * k};
}
template <size_t D>
LooseVector<D> operator*(const JetVector<D>& a, const CornerJet<D>& k) {
  return {a.x * k, a.y * k, a.z * k};
}
template <AnyJet J>
JetVectorOf<J> operator*(const Vec3d& a, const J& k) {
  return {k * a.x, k * a.y, k * a.z};
}

template <size_t D>
LooseJet<D> Dot(const JetVector<D>& a, const JetVector<D>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
// Terms with a coefficient of 0 are left out, as most normals and frames have some; what is a
// single term then is as tight as its jet.
template <size_t D>
CornerJet<D> Dot(const JetVector<D>& a, const Vec3d& b) {
  const CornerJet<D>* jets[3];
  double by[3];
  size_t count = 0;
  const auto take = [&](const CornerJet<D>& jet, double coefficient) {
    if (coefficient == 0) return;
    jets[count] = &jet;
    by[count++] = coefficient;
  };
  take(a.x, b.x);
  take(a.y, b.y);
  take(a.z, b.z);
  if (count == 0) return CornerJet<D>::Constant(0);
  if (count == 1) return *jets[0] * by[0];
  LooseJet<D> sum = *jets[0] * by[0] + *jets[1] * by[1];
  if (count == 3) sum = sum + *jets[2] * by[2];
  return sum;
}
template <size_t D>
LooseJet<D> LengthSquared(const JetVector<D>& a) {
  return CornerJet<D>(Square(a.x) + Square(a.y)) + Square(a.z);
}
template <size_t D>
JetVector<D> operator*(const Mat3& m, const JetVector<D>& v) {
  return {Dot(v, m.row[0]), Dot(v, m.row[1]), Dot(v, m.row[2])};
}
// Transposed m times v.
template <size_t D>
JetVector<D> MultiplyTransposed(const Mat3& m, const JetVector<D>& v) {
  const auto column = [&](int i) { return Dot(v, Vec3d{m.row[0][i], m.row[1][i], m.row[2][i]}); };
  return {column(0), column(1), column(2)};
}

}  // namespace linetree::LINETREE_JETS
LINETREE_AFTER_JETS();

#endif
