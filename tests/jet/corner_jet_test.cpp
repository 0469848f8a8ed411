// Inclusion: whatever a jet says of value, derivatives, corners and interpolation error is true.
#include <gtest/gtest.h>

#include "core/jet/jet_functions-inl.h"
#include "tests/jet/jet_check.h"
#include "tests/support/sanitizer_share.h"

namespace linetree::test {
namespace {

template <class T>
class CornerJetTest : public testing::Test {};

template <size_t N>
struct Dimension {
  static constexpr size_t kD = N;
};
using Dimensions = testing::Types<Dimension<2>, Dimension<4>>;
TYPED_TEST_SUITE(CornerJetTest, Dimensions);

constexpr int kRounds = 100 / kSanitizerShare;

// fn(random, box, polynomials a and b of the given size).
template <size_t D, class Fn>
void ForPolynomials(uint64_t seed, std::initializer_list<double> scales, Fn&& fn) {
  Random random(seed);
  for (const double scale : scales) {
    for (int i = 0; i < kRounds; ++i) {
      const Box<D> box = RandomBox<D>(random, random.LogUniform(1e-4, 1));
      const RandomPolynomial<D> a(random, scale), b(random, scale);
      fn(random, box, a, b);
      if (testing::Test::HasFatalFailure()) return;
    }
  }
}

// a raised so that its jet's range begins at `share` of its size, which the function f needs.
template <size_t D>
double LiftOf(const Box<D>& box, const RandomPolynomial<D>& a, double share) {
  const Jet<D> jet = a(box.Jets());
  return -jet.lo() + share * jet.v.Magnitude();
}
double AnyShare(Random& random) {
  return random.Below(3) == 0 ? random.LogUniform(1e-7, 1e-3) : random.Uniform(0.01, 3);
}

TYPED_TEST(CornerJetTest, Variables) {
  constexpr size_t kD = TypeParam::kD;
  Random random(1);
  for (int i = 0; i < kRounds; ++i) {
    const Box<kD> box = RandomBox<kD>(random, random.LogUniform(1e-9, 1));
    for (size_t axis = 0; axis < kD; ++axis) {
      ExpectTrue<kD>(
          box, [&](const auto& x) { return x[axis]; }, random);
    }
  }
}

TYPED_TEST(CornerJetTest, SumsAndScales) {
  constexpr size_t kD = TypeParam::kD;
  ForPolynomials<kD>(2, {1, 1e-100, 1e100},
                     [](Random& random, const auto& box, const auto& a, const auto& b) {
                       const double c = random.Uniform(-2, 2);
                       ExpectTrue<kD>(box, a, random);
                       ExpectTrue<kD>(
                           box, [&](const auto& x) { return a(x) + b(x); }, random);
                       ExpectTrue<kD>(
                           box, [&](const auto& x) { return a(x) - b(x); }, random);
                       ExpectTrue<kD>(
                           box, [&](const auto& x) { return -a(x); }, random);
                       ExpectTrue<kD>(
                           box, [&](const auto& x) { return a(x) * c; }, random);
                       ExpectTrue<kD>(
                           box, [&](const auto& x) { return a(x) + c; }, random);
                       // What cancels to rounding, and what is denormal.
                       ExpectTrue<kD>(
                           box, [&](const auto& x) { return (a(x) + b(x)) - b(x); }, random);
                       ExpectTrue<kD>(
                           box, [&](const auto& x) { return a(x) * 1e-160 * 1e-160; }, random);
                     });
}

TYPED_TEST(CornerJetTest, Products) {
  constexpr size_t kD = TypeParam::kD;
  ForPolynomials<kD>(
      3, {1, 1e-70, 1e70, 1e-160},
      [](Random& random, const auto& box, const auto& a, const auto& b) {
        ExpectTrue<kD>(
            box, [&]<class T>(const std::array<T, kD>& x) -> T { return a(x) * b(x); }, random);
        ExpectTrue<kD>(
            box, [&]<class T>(const std::array<T, kD>& x) -> T { return Square(a(x)); }, random);
        // The two sides of (a + b)(a - b) = a^2 - b^2 differ in nothing but how wide they are.
        ExpectTrue<kD>(
            box,
            [&]<class T>(const std::array<T, kD>& x) -> T {
              const T p = a(x), q = b(x), sum = p + q, difference = p - q;
              return sum * difference - (Square(p) - Square(q));
            },
            random);
      });
}

TYPED_TEST(CornerJetTest, Inverses) {
  constexpr size_t kD = TypeParam::kD;
  ForPolynomials<kD>(4, {1, 1e-40, 1e40},
                     [](Random& random, const auto& box, const auto& a, const auto& b) {
                       const double lift = LiftOf<kD>(box, a, AnyShare(random));
                       const double sign = random.Below(2) == 0 ? 1 : -1;
                       ExpectTrue<kD>(
                           box,
                           [&]<class T>(const std::array<T, kD>& x) -> T {
                             return Inverse(T((a(x) + lift) * sign));
                           },
                           random);
                       ExpectTrue<kD>(
                           box,
                           [&]<class T>(const std::array<T, kD>& x) -> T {
                             return b(x) * Inverse(T((a(x) + lift) * sign));
                           },
                           random);
                     });
}

TYPED_TEST(CornerJetTest, Roots) {
  constexpr size_t kD = TypeParam::kD;
  ForPolynomials<kD>(
      5, {1, 1e-50, 1e50}, [](Random& random, const auto& box, const auto& a, const auto&) {
        const double lift = LiftOf<kD>(box, a, AnyShare(random));
        ExpectTrue<kD>(
            box,
            [&]<class T>(const std::array<T, kD>& x) -> T { return SquareRoot(T(a(x) + lift)); },
            random);
        ExpectTrue<kD>(
            box,
            [&]<class T>(const std::array<T, kD>& x) -> T {
              return InverseSquareRoot(T(a(x) + lift));
            },
            random);
      });
}

// The truth is powl, in 64 bits.
constexpr double kPowlError = 0x1p-58;
TYPED_TEST(CornerJetTest, Powers) {
  constexpr size_t kD = TypeParam::kD;
  ForPolynomials<kD>(6, {1}, [](Random& random, const auto& box, const auto& a, const auto&) {
    const double lift = LiftOf<kD>(box, a, AnyShare(random));
    // Highlights: in [0, 1], at times up to it.
    const double shrink =
        (random.Below(2) == 0 ? 1 : random.Uniform(0.5, 1)) / Jet<kD>(a(box.Jets()) + lift).hi();
    for (const double p : {0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 10.0, 33.3, 160.0, 1000.0}) {
      ExpectTrue<kD>(
          box,
          [&]<class T>(const std::array<T, kD>& x) -> T {
            return Power(T((a(x) + lift) * shrink), p);
          },
          random, kPowlError, 20);
    }
  });
}

// Long chains, as hits and shading make them.
TYPED_TEST(CornerJetTest, Chains) {
  constexpr size_t kD = TypeParam::kD;
  ForPolynomials<kD>(7, {1, 1e-12, 1e12},
                     [](Random& random, const auto& box, const auto& a, const auto& b) {
                       ExpectTrue<kD>(
                           box,
                           [&]<class T>(const std::array<T, kD>& x) -> T {
                             const T p = a(x), q = b(x);
                             const T length = Square(p) + Square(q) + T(x[0] * x[1] + 2.0);
                             const T inverse = InverseSquareRoot(length);
                             const T cosine = p * inverse;
                             return cosine * q + Square(cosine) - inverse;
                           },
                           random);
                     });
}

TYPED_TEST(CornerJetTest, Assumptions) {
  constexpr size_t kD = TypeParam::kD;
  ForPolynomials<kD>(8, {1}, [](Random& random, const auto& box, const auto& a, const auto&) {
    // -(a^2): the square is known not to be negative, which its own range need not say.
    Jet<kD> square = a(box.Jets()) * a(box.Jets());
    square.AssumeWithin(0, 1e9);
    EXPECT_GE(square.lo(), 0);
    // Concave by construction.
    std::array<double, kD> weights;
    for (double& w : weights) w = random.Uniform(0, 3);
    const auto concave = [&]<class T>(const std::array<T, kD>& x) -> T {
      T sum = x[0] * 0.5 + 1.0;
      for (size_t i = 0; i < kD; ++i) sum = sum - Square(x[i]) * weights[i];
      return sum;
    };
    Jet<kD> bowl = concave(box.Jets());
    bowl.AssumeConcave();
    for (const Point<kD>& u : Samples<kD>(random, 20)) {
      ASSERT_EQ(Complaint<kD>(square, Square(a(box.At(u))), u), "");
      ASSERT_EQ(Complaint<kD>(bowl, concave(box.At(u)), u), "");
    }
    // Concave: nothing of it lies below the lowest corner.
    const auto corners = CornersOf<kD>(bowl);
    const double lowest = *std::min_element(corners.begin(), corners.end());
    EXPECT_GE(bowl.lo(), lowest - 2 * bowl.slack - 4 * kOutward * std::abs(lowest));
  });
}

}  // namespace
}  // namespace linetree::test
