// What somebody knows about the rays of a path beyond its first hit, in place of searches of the
// whole scene. The tracer asks; the linetrees answer.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/math/box3.h"
#include "core/trace/hit.h"

namespace linetree {

// One ray of a path: the ray on which the first hit lies, or a reflected or transmitted one. A step
// stands for all rays of a cell at the same place in the path.
struct PathStep {
  // Where every one of the rays ends; kNoObject where that differs, or where they meet nothing.
  int32_t object = kNoObject;
  int32_t face = 0;
  Side side = Side::kOutside;
  // Whether the rays can meet nothing but the candidates.
  bool listed = false;
  // The steps of the rays that leave from where these end, as distances from this step; 0: unknown.
  int32_t reflected = 0;
  int32_t transmitted = 0;
  std::span<const int32_t> candidates{};  // ascending; may be empty: the rays leave the scene

  bool EndsAt(const Hit& hit) const {
    return object == hit.object && face == hit.face && side == hit.side;
  }
};

// Where rays inside a transparent solid may be, and what they can meet there.
struct SolidInterior {
  Box3 room;  // the solid's bounds, with some clearance
  // Ascending, the solid among them: nothing else has a crossing in the room, as the tracer
  // computes it, with a ray that starts in the room.
  std::vector<int32_t> candidates;
};

class PathLists {
 public:
  virtual ~PathLists() = default;

  // The step of a ray of unit direction that arrives at this hit, or null when nothing is known.
  // What it and the steps after it say must hold for the classical tracer's own arithmetic: the
  // tracer's answer may not change by a bit. Valid while this object lives.
  virtual const PathStep* Find(const Hit& hit, const Vec3d& direction) const = 0;

  // Null when nothing is known. Valid while this object lives.
  virtual const SolidInterior* Inside(int object) const {
    (void)object;
    return nullptr;
  }
};

}  // namespace linetree
