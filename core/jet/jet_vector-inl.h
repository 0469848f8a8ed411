// Vectors of corner jets: the few operations that rays need.
#include "core/jet/corner_jet-inl.h"
#include "core/math/vec3.h"

#ifndef LINETREE_CORE_JET_JET_VECTOR_INL_H_
#define LINETREE_CORE_JET_JET_VECTOR_INL_H_

namespace linetree::LINETREE_JETS {

template <size_t D>
struct JetVector {
  CornerJet<D> x, y, z;

  static JetVector Constant(const Vec3d& v) {
    using Jet = CornerJet<D>;
    return {Jet::Constant(v.x), Jet::Constant(v.y), Jet::Constant(v.z)};
  }
};

template <size_t D>
JetVector<D> operator+(const JetVector<D>& a, const JetVector<D>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <size_t D>
JetVector<D> operator-(const JetVector<D>& a) {
  return {-a.x, -a.y, -a.z};
}
template <size_t D>
JetVector<D> operator-(const JetVector<D>& a, const Vec3d& b) {
  return {a.x + -b.x, a.y + -b.y, a.z + -b.z};
}
template <size_t D>
JetVector<D> operator*(const JetVector<D>& a, const CornerJet<D>& k) {
  return {a.x * k, a.y * k, a.z * k};
}
template <size_t D>
JetVector<D> operator*(const JetVector<D>& a, double k) {
  return {a.x * k, a.y * k, a.z * k};
}
template <size_t D>
CornerJet<D> Dot(const JetVector<D>& a, const JetVector<D>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <size_t D>
CornerJet<D> Dot(const JetVector<D>& a, const Vec3d& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <size_t D>
CornerJet<D> LengthSquared(const JetVector<D>& a) {
  return Square(a.x) + Square(a.y) + Square(a.z);
}
template <size_t D>
JetVector<D> operator*(const Mat3& m, const JetVector<D>& v) {
  return {Dot(v, m.row[0]), Dot(v, m.row[1]), Dot(v, m.row[2])};
}
// Transposed m times v.
template <size_t D>
JetVector<D> MultiplyTransposed(const Mat3& m, const JetVector<D>& v) {
  const auto column = [&](int i) {
    return v.x * m.row[0][i] + v.y * m.row[1][i] + v.z * m.row[2][i];
  };
  return {column(0), column(1), column(2)};
}

}  // namespace linetree::LINETREE_JETS

#endif
