// Counters of a frame as JSON: what --stats writes.
#pragma once

#include <nlohmann/json.hpp>

#include "core/render/frame.h"

namespace linetree {

// Keys are the field names of FrameStats in service.proto, with verdicts as an object by name.
// intersect = base_intersect + ip_intersect, likewise shade; rays are those of both kinds of work.
nlohmann::json StatsJson(const FrameStats& stats, int width, int height);

// The share of the pixels that hit something and were answered by interpolation, in [0, 1]; 0 when
// nothing was hit.
double HitRate(const FrameStats& stats);

// Share of the shadow rays that were answered without a search of the scene; 0 when there are none.
double ListedShare(const FrameStats& stats);

// Finite numbers as they are, others as null: JSON knows no infinity.
nlohmann::json JsonNumber(double value);

}  // namespace linetree
