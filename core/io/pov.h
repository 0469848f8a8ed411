// Scenes for POV-Ray 3.7, which computes the same model: an independent check of the tracer.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "core/scene/scene.h"
#include "core/trace/tracer.h"

namespace linetree {

// A POV-Ray file that renders, at width x height, what the tracer with these limits sees through
// `camera`. Render it with
//   povray +Iscene.pov +Opicture.ppm +FP16 File_Gamma=1.0 Dither=off +WW +HH -A -D -V
// UNIMPLEMENTED when a material cannot be expressed; the message lists every such material with the
// reason. Differences that remain: POV-Ray offsets shadow rays by 1e-3, does not count a ray
// through a surface without refraction as a bounce, and stops a transmitted branch where the grey
// value of transmit is below min_weight, whatever the path's weight.
absl::StatusOr<std::string> WritePov(const Scene& scene, const Camera& camera, int width,
                                     int height, const PathLimits& limits);

}  // namespace linetree
