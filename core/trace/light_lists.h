// What somebody knows about the way from a piece of surface to a light, in place of a search of the
// whole scene. The tracer asks; the surface trees answer. The object that the surface belongs to is
// left out: from the outside it is never in between, from the inside the tracer looks at it itself.
#pragma once

#include <cstdint>
#include <span>

#include "core/math/rgb.h"
#include "core/trace/hit.h"
#include "core/trace/shadow_function.h"

namespace linetree {

enum class LightKnowledge : uint8_t {
  kUnknown,  // search the scene
  kOn,       // nothing is in between, for every point of the piece
  kOff,      // `occluder`, which is opaque, is in between for every point of the piece
  kListed,   // only the listed objects may be in between
  // The whole piece faces away, so that nobody asks but for a grazing ray whose normal rounding has
  // turned: search the scene.
  kFacingAway,
};

// Whether somebody who knows this need not search the scene.
inline bool SparesSearch(LightKnowledge knowledge) {
  return knowledge != LightKnowledge::kUnknown && knowledge != LightKnowledge::kFacingAway;
}

// One light as seen from a piece of surface.
struct LightList {
  LightKnowledge knowledge = LightKnowledge::kUnknown;
  bool summed = false;                    // kOn: its diffuse light is part of KnownLights::diffuse
  int32_t occluder = kNoObject;           // kOff
  std::span<const int32_t> candidates{};  // kListed: at least one, ascending

  // Whether smaller pieces need not be looked at.
  bool IsDecided() const {
    return knowledge != LightKnowledge::kUnknown && knowledge != LightKnowledge::kListed;
  }
};

// What is known at one hit.
struct KnownLights {
  // One entry for every light of the scene, or null when nothing is known.
  const LightList* lists = nullptr;
  // Null, or functions for the candidates of all lists, and the hit's coordinates in them.
  const CellShadows* shadows = nullptr;
  float s = 0, t = 0;
  // Whether `diffuse` may stand for the diffuse terms of all lights that are `summed`: the sum of
  // E_l (n.l) of those that the facing side sees, within the relative error of the request.
  bool has_diffuse = false;
  Rgb diffuse;
};

class LightLists {
 public:
  virtual ~LightLists() = default;

  // What the lists say must hold for the classical tracer's own arithmetic: without `diffuse` the
  // tracer's answer may not change by a bit. Valid while this object lives.
  virtual KnownLights Find(const Hit& hit) const = 0;
};

}  // namespace linetree
