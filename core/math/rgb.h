// Linear RGB: radiance, or a coefficient per channel.
#pragma once

#include <algorithm>

namespace linetree {

template <class S>
struct RgbOf {
  S r{}, g{}, b{};

  S& operator[](int i) { return i == 0 ? r : i == 1 ? g : b; }
  const S& operator[](int i) const { return i == 0 ? r : i == 1 ? g : b; }
  bool operator==(const RgbOf&) const = default;
  RgbOf& operator+=(const RgbOf& o) {
    r += o.r;
    g += o.g;
    b += o.b;
    return *this;
  }
};
using Rgb = RgbOf<double>;

template <class A, class B>
auto operator+(const RgbOf<A>& a, const RgbOf<B>& b) -> RgbOf<decltype(a.r + b.r)> {
  return {a.r + b.r, a.g + b.g, a.b + b.b};
}
template <class A, class B>
auto operator*(const RgbOf<A>& a, const RgbOf<B>& b) -> RgbOf<decltype(a.r * b.r)> {
  return {a.r * b.r, a.g * b.g, a.b * b.b};
}
template <class A, class B>
auto Scaled(const RgbOf<A>& a, const B& k) -> RgbOf<decltype(a.r * k)> {
  return {a.r * k, a.g * k, a.b * k};
}
inline double MaxChannel(const Rgb& a) { return std::max({a.r, a.g, a.b}); }
inline bool IsBlack(const Rgb& a) { return a.r == 0 && a.g == 0 && a.b == 0; }

}  // namespace linetree
