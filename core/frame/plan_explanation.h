// What a planner does about each object, and why; and what frames by packets leave out because the
// scene has no need of it. For people to read: nothing is decided here.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/cache/tree_store.h"
#include "core/frame/frame_plan.h"
#include "core/packet/packet_scene.h"

namespace linetree {

enum class PlanReason {
  kUnseen,     // no packet that counts lay on it yet: taken for a usual object
  kPays,       // its trees save enough of the work that was counted
  kGrowing,    // they would, once there are more cells
  kCostsMore,  // its trees cost more than they save, or save less than kLeastSaving
  kTooSmall,   // they would save, but not what planting them costs: too few points
  kAlways,     // CacheOptions::always_ask
};
// In words, for tables.
std::string_view WordsFor(PlanReason reason);

struct ObjectPlan {
  size_t object = 0;
  bool asked = false;  // else skipped
  PlanReason reason = PlanReason::kUnseen;
  uint32_t points = 0;  // shading points that were counted; older frames' count less
  // Work at one of them, in about ns (frame_plan.h), with the trees and without; 0 without points.
  double tree_work = 0, classical_work = 0;
  TreeSize trees;
};

// `trees`: of the surface trees by object, as many as the plan has.
std::vector<ObjectPlan> ExplainPlan(const FramePlan& plan, std::span<const TreeSize> trees);

struct FeatureNote {
  std::string feature;
  std::optional<size_t> count;  // objects, unless the feature says otherwise
  std::string what_frames_do;
};

// `sum_error`: what sums of diffuse light may be off by, epsilon without the packets' rounding.
std::vector<FeatureNote> ExplainFeatures(const PacketScene& scene, double sum_error);

}  // namespace linetree
