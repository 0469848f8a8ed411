// One of every operation on jets, with all numbers that come out of it: compiled for every target,
// to be compared.
#if defined(LINETREE_TESTS_JET_JET_PROGRAM_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_TESTS_JET_JET_PROGRAM_INL_H_
#undef LINETREE_TESTS_JET_JET_PROGRAM_INL_H_
#else
#define LINETREE_TESTS_JET_JET_PROGRAM_INL_H_
#endif

#include <array>

#include "core/jet/jet_vector-inl.h"
#include "tests/jet/jet_program.h"

LINETREE_BEFORE_JETS();
namespace linetree::LINETREE_JETS {

template <size_t D>
class JetProgram {
 public:
  using Jet = CornerJet<D>;
  using Loose = LooseJet<D>;

  explicit JetProgram(const test::JetProgramInput& input) : input_(input) {}

  test::JetProgramOutput Run() {
    const Jet a = Input(0), b = Input(1);
    Note("a", a);
    Note("loose a + b", Loose(a + b));
    Note("a + b", Jet(a + b));
    Note("a - b", Jet(a - b));
    Note("-a", -a);
    Note("a + c", a + input_.constant);
    Note("a * c", a * input_.constant);
    Note("loose a * b", Loose(a * b));
    Note("a * b", Jet(a * b));
    Note("a * b - b * b + a", Jet(a * b - b * b + a));
    Note("a^2", Jet(Square(a)));
    const Jet positive = a + (a.v.Magnitude() * 1.5);
    Note("1 / a", Inverse(positive));
    Note("sqrt a", SquareRoot(positive));
    Note("1 / sqrt a", InverseSquareRoot(positive));
    for (const double p : {0.5, 1.5, 2.0, 7.25, 80.0}) {
      Note("a^p", Power(positive * (1 / positive.hi()), p));
    }
    Jet concave = a;
    concave.AssumeConcave();
    Note("concave a", concave);
    const JetVector<D> u{a, b, positive}, w{b, positive, a};
    Note("u.w", Jet(Dot(u, w)));
    Note("|u|^2", Jet(LengthSquared(u)));
    Note("u.constant", Jet(Dot(u, Vec3d{0, input_.constant, -1})));
    const JetVector<D> sum = u + w * a;
    for (const Jet* x : {&sum.x, &sum.y, &sum.z}) Note("u + w a", *x);
    return std::move(output_);
  }

 private:
  Jet Input(size_t which) const {
    const auto part = [&](size_t from) {
      std::array<double, D> x;
      for (size_t i = 0; i < D; ++i) x[i] = input_.numbers[which][from + i];
      return x;
    };
    const Jet f = Jet::Affine(input_.constant, part(0), part(4), part(8));
    const Jet square = Square(f);
    return square + square * f * input_.constant;
  }

  template <class J>
  void Note(const char* what, const J& jet) {
    std::vector<double> numbers{
        jet.v.lo,        jet.v.hi,          jet.slack,         jet.InterpolationError(),
        jet.Variation(), jet.ExcessOverQ(), jet.ExcessUnderQ()};
    const auto append = [&](const auto& pack, size_t count) {
      double lanes[16];
      pack.Store(lanes);
      numbers.insert(numbers.end(), lanes, lanes + count);
    };
    append(jet.ds.lo, 2 * D);
    append(jet.ds.hi, 2 * D);
    append(jet.k, J::kCorners);
    output_.push_back({what, std::move(numbers)});
  }

  const test::JetProgramInput& input_;
  test::JetProgramOutput output_;
};

inline test::JetProgramOutput RunJetProgram(const test::JetProgramInput& input) {
  return input.dimension == 2 ? JetProgram<2>(input).Run() : JetProgram<4>(input).Run();
}

}  // namespace linetree::LINETREE_JETS
LINETREE_AFTER_JETS();

#endif
