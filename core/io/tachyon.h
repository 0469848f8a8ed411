// Scenes for Tachyon 0.99: a peer to measure speed against, with a simpler model of light.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/scene/scene.h"
#include "core/trace/tracer.h"

namespace linetree {

struct TachyonScene {
  std::string text;
  // What Tachyon's picture of this scene shows otherwise than the tracer's, each in words.
  std::vector<std::string> differences;
};

// A file in Tachyon's text format that renders, at width x height, what the tracer with these
// limits sees through `camera`, as nearly as Tachyon's shading allows. Render it with
//   tachyon scene.dat -format PPM48 -o picture.ppm
// whose values are linear, clipped at 1. Everything but what `differences` names agrees but for
// Tachyon's constants: light that falls in at a cosine below 1/512 is not counted, and rays start
// (and shadows end) at a distance of 1e-4. UNIMPLEMENTED where a light falls off with another power
// of the distance than 1 or 2. Tachyon itself crashes on a scene that lies in one plane.
absl::StatusOr<TachyonScene> WriteTachyon(const Scene& scene, const Camera& camera, int width,
                                          int height, const PathLimits& limits);

}  // namespace linetree
