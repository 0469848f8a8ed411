// Vectors and 3x3 matrices over any scalar. The tracer is written once for every scalar S (double,
// wider types, later bounds), so these are too; GLM, which serves the scene's transforms, refuses
// scalars that are not built-in floating point.
//
// Mixed operations take double as the scene's scalar: Vec3<S> op Vec3<double> is Vec3<S>.
#pragma once

#include <array>
#include <cmath>

namespace linetree {

template <class S>
struct Vec3 {
  S x{}, y{}, z{};

  S& operator[](int i) { return i == 0 ? x : i == 1 ? y : z; }
  const S& operator[](int i) const { return i == 0 ? x : i == 1 ? y : z; }
  bool operator==(const Vec3&) const = default;
};
using Vec3d = Vec3<double>;

template <class A, class B>
auto operator+(const Vec3<A>& a, const Vec3<B>& b) -> Vec3<decltype(a.x + b.x)> {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class A, class B>
auto operator-(const Vec3<A>& a, const Vec3<B>& b) -> Vec3<decltype(a.x - b.x)> {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class A>
Vec3<A> operator-(const Vec3<A>& a) {
  return {-a.x, -a.y, -a.z};
}
template <class A, class B>
auto operator*(const Vec3<A>& a, const B& k) -> Vec3<decltype(a.x * k)> {
  return {a.x * k, a.y * k, a.z * k};
}
template <class A, class B>
auto Dot(const Vec3<A>& a, const Vec3<B>& b) -> decltype(a.x * b.x) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class A, class B>
auto Cross(const Vec3<A>& a, const Vec3<B>& b) -> Vec3<decltype(a.x * b.x)> {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class A>
A LengthSquared(const Vec3<A>& a) {
  return Dot(a, a);
}
template <class A>
A Length(const Vec3<A>& a) {
  using std::sqrt;
  return sqrt(Dot(a, a));
}
// Undefined for the zero vector.
template <class A>
Vec3<A> Normalized(const Vec3<A>& a) {
  return a * (A(1) / Length(a));
}
template <class A, class B>
Vec3<A> CastVec3(const Vec3<B>& b) {
  return {A(b.x), A(b.y), A(b.z)};
}
inline bool IsFinite(const Vec3d& a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

// Rounding of the above in double, for what neither overflows nor underflows; u = 2^-53.
// Dot: absolute, relative to |a.x b.x| + |a.y b.y| + |a.z b.z|: a product and two sums, 3 u; the
// fourth covers what is of second order.
inline constexpr double kDotRounding = 4 * 0x1p-53;
// Cross, per component, relative to the sum of its two products: 2 u, and a third for second order.
inline constexpr double kCrossRounding = 3 * 0x1p-53;
// Normalized, per component, relative: half of a sum of squares' 3 u, and one u each for the root,
// the reciprocal and the product, 4.5 u.
inline constexpr double kNormalizedRounding = 5 * 0x1p-53;

// Rows of a 3x3 matrix.
struct Mat3 {
  std::array<Vec3d, 3> row{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};
  bool operator==(const Mat3&) const = default;
};
template <class S>
Vec3<S> operator*(const Mat3& m, const Vec3<S>& v) {
  return {Dot(v, m.row[0]), Dot(v, m.row[1]), Dot(v, m.row[2])};
}
template <class S>
Vec3<S> MultiplyTransposed(const Mat3& m, const Vec3<S>& v) {
  return {v.x * m.row[0].x + v.y * m.row[1].x + v.z * m.row[2].x,
          v.x * m.row[0].y + v.y * m.row[1].y + v.z * m.row[2].y,
          v.x * m.row[0].z + v.y * m.row[1].z + v.z * m.row[2].z};
}

}  // namespace linetree
