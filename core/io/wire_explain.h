// Explanations of frames by packets as they go over the wire (service.proto).
#pragma once

#include "core/render/scene_host.h"
#include "linetree/v1/service.pb.h"

namespace linetree {

// Objects that are listed at most, and unless the request says otherwise.
inline constexpr uint32_t kMostExplained = 10'000;
inline constexpr uint32_t kUsualExplained = 100;

// What the request asks of the host of its scene, or INVALID_ARGUMENT for the field that is out of
// range.
absl::StatusOr<v1::ExplainReply> ExplainToWire(const v1::ExplainRequest& request,
                                               double default_error, const SceneHost& host);
// At most so many objects, those with the most points first.
v1::ExplainReply ExplanationToWire(const Scene& scene, const SceneHost::Explanation& explanation,
                                   uint32_t max_objects);

// In words, for tables; UNSEEN's for reasons that this version does not know.
std::string_view WordsFor(v1::PlanReason reason);

}  // namespace linetree
