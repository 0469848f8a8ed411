// The scene version.
#pragma once

#include "core/scene/scene.h"

namespace linetree {

// Hash (XXH3, 128 bits) of everything in a built scene but its description and version: two scenes
// of one version answer every request alike. It depends on what was read, not on how it was
// written: white space, comments, the order of fields and the file format do not count.
SceneVersion VersionOf(const Scene& scene);

}  // namespace linetree
