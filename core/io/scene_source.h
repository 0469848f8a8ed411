// Errors about one field of a scene, in one form for every format.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "core/io/load_scene.h"

namespace linetree {

// "file:line:column: field.path: message", without the place when the scene came over the wire.
std::string FieldMessage(const SceneSource& source, absl::string_view field_path,
                         absl::string_view message);

// INVALID_ARGUMENT with FieldMessage.
absl::Status FieldError(const SceneSource& source, absl::string_view field_path,
                        absl::string_view message);

// RESOURCE_EXHAUSTED "expected at most `limit`, got `count`" when count > limit.
absl::Status CheckLimit(const SceneSource& source, absl::string_view field_path, uint64_t count,
                        uint64_t limit);

// Turns the error "field: message" of a maker or of ValidateCamera into an error about that field
// of `parent`, a field path. OK stays OK.
absl::Status InField(const SceneSource& source, absl::string_view parent,
                     const absl::Status& status);

}  // namespace linetree
