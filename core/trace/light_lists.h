// What somebody knows about the way from a piece of surface to a light, in place of a search of the
// whole scene. The tracer asks; the surface trees answer. The object that the surface belongs to is
// left out: from the outside it is never in between, from the inside the tracer looks at it itself.
#pragma once

#include <cstdint>
#include <span>

#include "core/trace/hit.h"

namespace linetree {

enum class LightKnowledge : uint8_t {
  kUnknown,  // search the scene
  kOn,       // nothing is in between, for every point of the piece
  kOff,      // `occluder`, which is opaque, is in between for every point of the piece
  kListed,   // only the listed objects may be in between
};

// One light as seen from a piece of surface.
struct LightList {
  LightKnowledge knowledge = LightKnowledge::kUnknown;
  int32_t occluder = kNoObject;           // kOff
  std::span<const int32_t> candidates{};  // kListed: at least one, ascending
};

class LightLists {
 public:
  virtual ~LightLists() = default;

  // One entry for every light of the scene, or null when nothing is known at this hit. What it says
  // must hold for the classical tracer's own arithmetic: the tracer's answer may not change by a
  // bit. Valid while this object lives.
  virtual const LightList* Find(const Hit& hit) const = 0;
};

}  // namespace linetree
