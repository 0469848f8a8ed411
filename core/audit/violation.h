// An answer that broke the promise, with everything that is needed to ask for it again.
#pragma once

#include <string>

#include "core/render/options.h"
#include "core/scene/camera.h"

namespace linetree {

struct Violation {
  std::string scene;  // whatever names it: family and seed, file, or name and version
  Ray ray;            // as it was asked
  RenderOptions options;
  bool from_frame = false;  // the answer was rounded to float
  // Where the answer is the mean of several rays: which (PixelText), and `ray` leads to the pixel's
  // centre.
  std::string pixel{};
  Rgb answer;
  Rgb classical;
  double error_over_allowed = 0;
};

// One line of `key=value`; coordinates and radiances as hexadecimal floats, so that nothing is
// lost.
std::string ToLine(const Violation& violation);

// One pixel of a frame with several samples, with everything that its rays depend on.
std::string PixelText(const Camera& camera, int width, int height, const Sampling& sampling,
                      size_t pixel);

// "0x1p+0,-0x1.8p-1,0x0p+0"
std::string HexText(const Vec3d& v);

}  // namespace linetree
