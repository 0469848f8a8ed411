// Small hand-made frames for the tests of pictures.
#pragma once

#include <limits>

#include "core/render/frame.h"

namespace linetree {

// Every pixel has values of its own; pixel 0 is background, the others walk through all sources and
// verdicts.
inline Frame MakeFrame(int width, int height) {
  Frame frame;
  frame.width = width;
  frame.height = height;
  const int pixels = width * height;
  for (int i = 0; i < pixels; ++i) {
    for (int c = 0; c < 3; ++c) {
      frame.radiance.push_back(0.01f * static_cast<float>(3 * i + c) + 0x1p-30f);
    }
    const bool background = i == 0;
    frame.object.push_back(background ? -1 : i * 7);
    frame.source.push_back(background ? Source::kBackground : static_cast<Source>(1 + i % 2));
    frame.verdict.push_back(static_cast<Verdict>(background ? 0 : i % kVerdictCount));
    frame.depth.push_back(background ? std::numeric_limits<float>::infinity()
                                     : 1.5f + static_cast<float>(i));
  }
  frame.camera = {"side", {1, 2, 3.25}, {0, -1, 0.1}, {0, 0, 1}, 61.5};
  frame.max_relative_error = 0.0625;
  frame.white = 2.5;
  frame.scene_version = "0123456789abcdef0123456789abcdef";
  frame.stats.pixels = static_cast<uint64_t>(pixels);
  return frame;
}

}  // namespace linetree
