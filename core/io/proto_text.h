// Protobuf text with positions: errors say where in the file.
#pragma once

#include <google/protobuf/message.h>

#include <string>
#include <string_view>

#include "absl/status/status.h"

namespace linetree {

// Parses `text` into *message. INVALID_ARGUMENT "file:line:column: what was expected", the first
// error only.
absl::Status ParseProtoText(const std::string& text, const std::string& file_name,
                            google::protobuf::Message* message);

// Where in `text`, which must parse as a message of the type of `prototype`, the deepest part of
// `field_path` ("keyframes[3].camera.eye") stands: "file:line:column", or the file's name when no
// part of the path does. Parses again: positions cost several times the memory of the message, and
// only errors ask for them.
std::string WhereInProtoText(const std::string& text, const std::string& file_name,
                             const google::protobuf::Message& prototype,
                             std::string_view field_path);

}  // namespace linetree
