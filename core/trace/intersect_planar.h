// Shapes bounded by planes: boxes, polyhedra, discs, convex polygons.
#pragma once

#include "core/trace/crossings.h"

namespace linetree {

// Cuts a chord by the half-space normal.(x - point) <= 0, along which the signed distance from the
// plane is distance + t slope; false when all of the line is outside.
template <class S>
bool CutByHalfSpace(const S& distance, const S& slope, int face, Chord<S>& chord) {
  if (slope < 0) {
    chord.Enter(-distance / slope, face);
  } else if (slope > 0) {
    chord.Leave(-distance / slope, face);
  } else if (distance > 0) {
    return false;
  }
  return true;
}

template <class S>
Crossings<S> LineCrossings(const BoxShape& shape, const Vec3<S>& origin, const Vec3<S>& direction) {
  const auto [p, q] = ToObject(shape.frame, origin, direction);
  Chord<S> chord;
  for (int i = 0; i < 3; ++i) {
    if (!CutByHalfSpace(S(-p[i] - S(1)), S(-q[i]), 2 * i, chord)) return {};
    if (!CutByHalfSpace(S(p[i] - S(1)), S(q[i]), 2 * i + 1, chord)) return {};
  }
  return chord.ToCrossings();
}

template <class S>
Crossing<S> ExitCrossing(const BoxShape& shape, const Vec3<S>& origin, const Vec3<S>& direction,
                         int face) {
  const auto [p, q] = ToObject(shape.frame, origin, direction);
  Chord<S> chord;
  for (int i = 0; i < 3; ++i) {
    if (q[i] < 0 && face != 2 * i) chord.Leave((S(-1) - p[i]) / q[i], 2 * i);
    if (q[i] > 0 && face != 2 * i + 1) chord.Leave((S(1) - p[i]) / q[i], 2 * i + 1);
  }
  return chord.Exit(face);
}

template <class S>
Crossings<S> LineCrossings(const PolyhedronShape& shape, const Vec3<S>& origin,
                           const Vec3<S>& direction) {
  Chord<S> chord;
  for (size_t i = 0; i < shape.faces.size(); ++i) {
    const Plane& plane = shape.faces[i];
    const S distance = SignedDistance(plane, origin);
    if (!CutByHalfSpace(distance, S(Dot(direction, plane.normal)), static_cast<int>(i), chord)) {
      return {};
    }
  }
  return chord.ToCrossings();
}

template <class S>
Crossing<S> ExitCrossing(const PolyhedronShape& shape, const Vec3<S>& origin,
                         const Vec3<S>& direction, int face) {
  Chord<S> chord;
  for (size_t i = 0; i < shape.faces.size(); ++i) {
    const Plane& plane = shape.faces[i];
    const S slope = Dot(direction, plane.normal);
    if (slope > 0 && static_cast<int>(i) != face) {
      chord.Leave(-SignedDistance(plane, origin) / slope, static_cast<int>(i));
    }
  }
  return chord.Exit(face);
}

template <class S>
Crossings<S> LineCrossings(const DiscShape& shape, const Vec3<S>& origin,
                           const Vec3<S>& direction) {
  Crossings<S> crossings;
  const S slope = Dot(direction, shape.plane.normal);
  if (slope == 0) return crossings;
  const S t = -SignedDistance(shape.plane, origin) / slope;
  const Vec3<S> r = shape.frame.object_from_world * (origin + direction * t - shape.frame.center);
  if (r.x * r.x + r.y * r.y <= 1) crossings.Add(t, 0, Side::kOutside);
  return crossings;
}

template <class S>
Crossings<S> LineCrossings(const PolygonShape& shape, const Vec3<S>& origin,
                           const Vec3<S>& direction) {
  Crossings<S> crossings;
  const S slope = Dot(direction, shape.plane.normal);
  if (slope == 0) return crossings;
  const S t = -SignedDistance(shape.plane, origin) / slope;
  const Vec3<S> point = origin + direction * t;
  for (const Plane& edge : shape.edges) {
    if (!(SignedDistance(edge, point) <= 0)) return crossings;
  }
  crossings.Add(t, 0, Side::kOutside);
  return crossings;
}

template <class S>
Crossings<S> LineCrossings(const TriangleShape& shape, const Vec3<S>& origin,
                           const Vec3<S>& direction) {
  return LineCrossings(shape.polygon, origin, direction);
}

}  // namespace linetree
