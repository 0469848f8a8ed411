// How smooth the light of a lamp is that fades with distance: a bound on the fourth derivative, as
// cubic interpolation over planar cells needs it.
//
// On a plane such a lamp throws E h f, h its constant height and f = F / d, F = 2 / (1 + (d/D)^p)
// its fall-off at the distance d. Along a line, where s runs and t is the way from the foot of the
// perpendicular, q = d^2 has q' = 2 t, q'' = 2, so that
//   f'''' = 16 t^4 g4 + 48 t^2 g3 + 12 g2,   gn the derivatives of f with respect to q.
// With th = q d/dq, q^n gn = th (th - 1) ... (th - n + 1) f. Let c = 1 / (1 + (d/D)^p) and r = 1 -
// c. Then f = 2 q^(-1/2) c and th c = -a c r, th r = a c r, a = p / 2, from which
//   q^n gn = f u_n,  u_0 = 1,  u_(n+1) = a r ((1 - r) u_n' - u_n) - (n + 1/2) u_n,
// polynomials in r. So with v = t^2 / q in [0, 1],
//   f'''' = P(r, v) f / d^4,   P = 16 v^2 u_4 + 48 v u_3 + 12 u_2.
// P is bounded by its Bernstein coefficients over the r of a cell and halves of v. Without fading
// (r = 0) that is 24, the largest value of 24 P_4, Legendre's polynomial.
#pragma once

#include "core/scene/light.h"

namespace linetree {

// Of f = F / d along any line on which d is between `nearest` and `farthest`, both positive.
struct FadingBound {
  double most = 0, least = 0;  // of f
  double fourth = 0;           // of |f''''|
  // Of |d f' / f|, by which relative errors of d grow.
  double slope = 0;
};
FadingBound BoundFading(const Light& light, double nearest, double farthest);

}  // namespace linetree
