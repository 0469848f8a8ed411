// Changes of a scene's message: what UpdateScene asks for.
#pragma once

#include <google/protobuf/repeated_ptr_field.h>

#include "absl/status/status.h"
#include "core/render/answer_rays.h"
#include "linetree/v1/service.pb.h"

namespace linetree {

// Makes all edits, one after the other. INVALID_ARGUMENT ("edits[2].move_object.object.name: what
// was expected, what was found") for what names nothing or more than one thing; the scene is then
// half edited. What the edits put into the scene is for BuildScene to validate.
// CANCELLED between two edits when `cancel` says so.
absl::Status ApplyEdits(const google::protobuf::RepeatedPtrField<v1::SceneEdit>& edits,
                        v1::Scene& scene, const CancelToken* cancel = nullptr);

}  // namespace linetree
