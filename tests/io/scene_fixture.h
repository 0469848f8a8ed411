// A valid scene in text with places to break it, for tests of the rules.
#pragma once

#include <string>

#include "absl/strings/str_cat.h"
#include "core/io/load_scene.h"

namespace linetree {

// A scene of one material "m", and `text` after it.
inline std::string WithMaterial(const std::string& text) {
  return absl::StrCat("materials { name: \"m\" diffuse { r: 0.5 g: 0.5 b: 0.5 } }\n", text);
}

// A scene with one object: line 2, its shape starts in column 25.
inline std::string WithShape(const std::string& shape) {
  return WithMaterial(absl::StrCat("objects { material: \"m\" ", shape, " }\n"));
}

inline absl::StatusOr<std::shared_ptr<const Scene>> BuildText(const std::string& text,
                                                              const SceneLimits& limits = {}) {
  auto source = ParseSceneText(text, "s.textproto", limits);
  if (!source.ok()) return source.status();
  return BuildScene(**source, limits);
}

inline absl::StatusOr<std::shared_ptr<const Scene>> BuildNff(const std::string& text,
                                                             const SceneLimits& limits = {}) {
  auto source = ParseNff(text, "s.nff", limits);
  if (!source.ok()) return source.status();
  return BuildScene(**source, limits);
}

}  // namespace linetree
