// Where a line o + t d crosses the surface of one convex object: at most twice. The building blocks
// of core/trace/intersect.h.
#pragma once

#include <limits>

#include "core/math/vec3.h"
#include "core/scene/shape.h"
#include "core/trace/hit.h"

namespace linetree {

template <class S>
struct Crossing {
  S t{};
  int face = 0;
  Side side = Side::kOutside;  // the side from which the line comes
  bool first_on_line = false;  // no other crossing of the object has a smaller t, positive or not
};

// In order of t.
template <class S>
struct Crossings {
  int count = 0;
  Crossing<S> at[2];

  // The next crossing of a whole line.
  void Add(const S& t, int face, Side side) {
    at[count] = {t, face, side, count == 0};
    ++count;
  }
  // Any crossing.
  void Append(const Crossing<S>& crossing) { at[count++] = crossing; }
  const Crossing<S>* begin() const { return at; }
  const Crossing<S>* end() const { return at + count; }
};

// A line in an object's own frame; t is the same in both frames.
template <class S>
struct ObjectLine {
  Vec3<S> p, q;
};
template <class S>
ObjectLine<S> ToObject(const AffineFrame& frame, const Vec3<S>& origin, const Vec3<S>& direction) {
  return {frame.object_from_world * (origin - frame.center), frame.object_from_world * direction};
}

// The part of a line inside a convex solid, as the intersection of the parts inside its bounding
// surfaces. Of surfaces that are met at the same t the one named first counts.
template <class S>
struct Chord {
  static constexpr S kInf = std::numeric_limits<S>::infinity();

  S in = -kInf, out = kInf;
  int in_face = -1, out_face = -1;

  void Enter(const S& t, int face) {
    if (t > in) {
      in = t;
      in_face = face;
    }
  }
  void Leave(const S& t, int face) {
    if (t < out) {
      out = t;
      out_face = face;
    }
  }

  Crossings<S> ToCrossings() const {
    Crossings<S> crossings;
    if (in_face < 0 || out_face < 0 || !(in <= out)) return crossings;
    crossings.Add(in, in_face, Side::kOutside);
    crossings.Add(out, out_face, Side::kInside);
    return crossings;
  }

  // For a line that starts inside, on start_face, at t = 0: a convex solid is always left again.
  // When rounding puts the exit behind the start, or finds none at all (the line grazes), it is at
  // once.
  Crossing<S> Exit(int start_face) const {
    if (out_face < 0) return {S(0), start_face, Side::kInside};
    return {out > 0 ? out : S(0), out_face, Side::kInside};
  }
};

}  // namespace linetree
