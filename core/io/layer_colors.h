// What a layer of a frame looks like: 8-bit sRGB pictures.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "core/render/frame.h"

namespace linetree {

enum class Layer { kBeauty, kVerdict, kSource, kObject, kDepth };
inline constexpr std::array<std::string_view, 5> kLayerNames = {"beauty", "verdict", "source",
                                                                "object", "depth"};
std::optional<Layer> FindLayer(std::string_view name);

// Row-major, row 0 on top.
struct Picture8 {
  int width = 0;
  int height = 0;
  std::vector<uint8_t> rgb;  // 3 * width * height, sRGB
};

using Color8 = std::array<uint8_t, 3>;

// One line of a legend.
struct LegendEntry {
  std::string_view label;
  std::string_view color_name;
  Color8 color;
};

// The colour code of the paper's Color Plate 1, with colours of our own for what the plate does not
// show. Certified pixels show the picture, dimmed and grey; their entry is the brightest such grey.
const std::array<LegendEntry, kVerdictCount>& VerdictLegend();
// By Source.
const std::array<LegendEntry, kSourceCount>& SourceLegend();

// Linear value to its 8-bit sRGB code (IEC 61966-2-1); clamped to [0, 1], NaN is 0.
uint8_t SrgbCode(double linear);

//   beauty   radiance / frame.white
//   verdict  VerdictLegend; background black
//   source   SourceLegend
//   object   a colour per object; background black
//   depth    near is bright, over the range of the picture's own depths; background black
// Requires the layer to be there (frames may lack all but beauty).
Picture8 PaintLayer(const Frame& frame, Layer layer);
bool HasLayer(const Frame& frame, Layer layer);

}  // namespace linetree
