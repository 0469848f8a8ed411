// How fast a bundle's hits with a quadric move and turn, from the surface itself.
//
// A line p + q t meets a surface F(m) = 0 at m = p + q t. Write g for half the gradient of F at m
// and M for half its second derivative, which for a quadric is one constant form. Along axis i of
// the cell, F(m(u)) = 0 says once and twice differentiated
//   g.m_i = 0,   g.m_ii + M(m_i, m_i) = 0,   where
//   m_i = (p_i + q_i t) + q t_i,   m_ii = (p_ii + q_ii t + 2 q_i t_i) + q t_ii,
// so that, with e_i and e_ii for what is in brackets,
//   t_i = -g.e_i / g.q,   t_ii = -(M(m_i, m_i) + g.e_ii) / g.q.
// Here every range is used once or twice, and those of e_i are narrow: along most axes the p and q
// of charts have constant slopes. The chain rule through t = (-b - root) / a uses b and a, and what
// they have in common, many times over.
#if defined(LINETREE_CORE_CERTIFY_SURFACE_TANGENTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_CERTIFY_SURFACE_TANGENTS_INL_H_
#undef LINETREE_CORE_CERTIFY_SURFACE_TANGENTS_INL_H_
#else
#define LINETREE_CORE_CERTIFY_SURFACE_TANGENTS_INL_H_
#endif

#include "core/jet/jet_vector-inl.h"

LINETREE_BEFORE_JETS();
namespace linetree::LINETREE_JETS {

// x^2 + y^2 + z_square z^2 and lower terms, at the hits of a bundle.
struct QuadricAt {
  Interval gradient[3];  // half of it
  double z_square = 1;
  Interval slope;  // gradient.q, which keeps off 0
};

// Narrows the derivatives of t and of m = p + q t.
template <size_t D>
void TightenOnSurface(const JetVector<D>& p, const JetVector<D>& q, const QuadricAt& at,
                      CornerJet<D>& t, JetVector<D>& m) {
  using Lanes = IntervalPack<D>;
  const CornerJet<D>* ps[3] = {&p.x, &p.y, &p.z};
  const CornerJet<D>* qs[3] = {&q.x, &q.y, &q.z};
  CornerJet<D>* ms[3] = {&m.x, &m.y, &m.z};
  const auto times = [](const Interval& f, const Lanes& g) {
    return NearProduct(Lanes::All(f), g);
  };
  const auto gradient_times = [&](const Lanes(&v)[3]) {
    return SumOfNear(times(at.gradient[0], v[0]), times(at.gradient[1], v[1]),
                     times(at.gradient[2], v[2]));
  };
  const Interval over = -Inverse(at.slope);
  Lanes e[3], tangents[3], squares[3];
  for (size_t i = 0; i < 3; ++i) e[i] = SumOfNear(ps[i]->d(), times(t.v, qs[i]->d()));
  const Lanes first = Meet(t.d(), over * gradient_times(e));
  for (size_t i = 0; i < 3; ++i) {
    tangents[i] = Meet(ms[i]->d(), SumOfNear(e[i], times(qs[i]->v, first)));
    squares[i] = Square(tangents[i]);
    const Lanes mixed = NearProduct(qs[i]->d(), first);
    e[i] = SumOfNear(ps[i]->s(), times(t.v, qs[i]->s()),
                     Lanes{mixed.lo + mixed.lo, mixed.hi + mixed.hi});
  }
  const double z = at.z_square;
  const Lanes form = SumOfNear(squares[0], squares[1], times({z, z}, squares[2]));
  t.AssumeDerivatives(first, over * (form + gradient_times(e)));
  for (size_t i = 0; i < 3; ++i) {
    ms[i]->AssumeDerivatives(tangents[i], SumOfNear(e[i], times(qs[i]->v, t.s())));
  }
}

}  // namespace linetree::LINETREE_JETS
LINETREE_AFTER_JETS();

#endif
