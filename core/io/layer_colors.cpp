#include "core/io/layer_colors.h"

#include <algorithm>
#include <cmath>

#include "core/math/check.h"

namespace linetree {
namespace {

// How bright a white pixel still is where its cell was certified: failures must stand out.
constexpr double kCertifiedDim = 0.45;
constexpr uint8_t kCertifiedCode = 115;  // kCertifiedDim * 255

Color8 BeautyColor(const Frame& frame, size_t pixel) {
  Color8 color{};
  for (size_t c = 0; c < 3; ++c) color[c] = SrgbCode(frame.radiance[3 * pixel + c] / frame.white);
  return color;
}

// Luminance with the weights of the sRGB primaries.
Color8 DimmedGrey(const Frame& frame, size_t pixel) {
  const float* rgb = &frame.radiance[3 * pixel];
  const double luminance = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
  const auto grey =
      static_cast<uint8_t>(std::lround(kCertifiedDim * SrgbCode(luminance / frame.white)));
  return {grey, grey, grey};
}

Color8 VerdictColor(const Frame& frame, size_t pixel) {
  const Verdict verdict = frame.verdict[pixel];
  if (frame.source[pixel] == Source::kBackground) return {0, 0, 0};
  if (verdict == Verdict::kCertified) return DimmedGrey(frame, pixel);
  return VerdictLegend()[static_cast<size_t>(verdict)].color;
}

// Neighbouring indices get hues that are far apart: steps of the golden ratio around the circle.
Color8 ObjectColor(int32_t object) {
  if (object < 0) return {0, 0, 0};
  const double turn = std::fmod(0.6180339887498949 * object, 1.0);
  const double value = 0.55 + 0.4 * std::fmod(0.7548776662466927 * object, 1.0);
  Color8 color{};
  for (size_t c = 0; c < 3; ++c) {
    const double hue = std::fmod(turn * 6 + 6 - 2 * static_cast<double>(c), 6.0);
    const double share = std::clamp(std::abs(hue - 3) - 1, 0.0, 1.0);
    color[c] = static_cast<uint8_t>(std::lround(255 * value * (0.25 + 0.75 * share)));
  }
  return color;
}

struct DepthRange {
  double near = std::numeric_limits<double>::infinity();
  double far = 0;
};

DepthRange RangeOf(const PixelLayer<float>& depth) {
  DepthRange range;
  for (const float d : depth) {
    if (!std::isfinite(d)) continue;
    range.near = std::min<double>(range.near, d);
    range.far = std::max<double>(range.far, d);
  }
  return range;
}

// From white (nearest) to a dark grey that is still not the background's black.
Color8 DepthColor(const DepthRange& range, float depth) {
  if (!std::isfinite(depth)) return {0, 0, 0};
  const double extent = range.far - range.near;
  const double share = extent > 0 ? (depth - range.near) / extent : 0;
  const auto grey = static_cast<uint8_t>(std::lround(255 - 215 * share));
  return {grey, grey, grey};
}

template <class ColorOf>
Picture8 Paint(const Frame& frame, const ColorOf& color_of) {
  Picture8 picture{frame.width, frame.height, {}};
  const size_t pixels = static_cast<size_t>(frame.width) * static_cast<size_t>(frame.height);
  picture.rgb.resize(3 * pixels);
  for (size_t i = 0; i < pixels; ++i) {
    const Color8 color = color_of(i);
    std::copy(color.begin(), color.end(), picture.rgb.begin() + static_cast<ptrdiff_t>(3 * i));
  }
  return picture;
}

}  // namespace

std::optional<Layer> FindLayer(std::string_view name) {
  const auto* found = std::find(kLayerNames.begin(), kLayerNames.end(), name);
  if (found == kLayerNames.end()) return std::nullopt;
  return static_cast<Layer>(found - kLayerNames.begin());
}

const std::array<LegendEntry, kVerdictCount>& VerdictLegend() {
  static constexpr std::array<LegendEntry, kVerdictCount> kLegend = {{
      {"untried", "grey", {128, 128, 128}},
      {"certified", "the picture, dimmed", {kCertifiedCode, kCertifiedCode, kCertifiedCode}},
      {"gap (silhouette)", "yellow", {255, 230, 0}},
      {"self shadow", "green", {0, 190, 60}},
      {"blocker", "red", {225, 30, 30}},
      {"funnel", "orange", {255, 140, 0}},
      {"peak (highlight)", "cyan", {0, 220, 230}},
      {"epsilon", "purple", {150, 50, 200}},
  }};
  return kLegend;
}

const std::array<LegendEntry, kSourceCount>& SourceLegend() {
  static constexpr std::array<LegendEntry, kSourceCount> kLegend = {{
      {"background", "black", {0, 0, 0}},
      {"interpolated", "blue", {60, 120, 220}},
      {"traced", "orange", {240, 150, 40}},
      {"replayed", "green", {70, 170, 90}},
      {"residual", "yellow", {235, 220, 90}},
  }};
  return kLegend;
}

uint8_t SrgbCode(double linear) {
  if (!(linear > 0)) return 0;
  if (linear >= 1) return 255;
  const double code =
      linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
  return static_cast<uint8_t>(std::lround(255 * code));
}

bool HasLayer(const Frame& frame, Layer layer) {
  const size_t pixels = static_cast<size_t>(frame.width) * static_cast<size_t>(frame.height);
  switch (layer) {
    case Layer::kBeauty:
      return frame.radiance.size() == 3 * pixels;
    case Layer::kVerdict:
      return frame.verdict.size() == pixels && frame.source.size() == pixels &&
             frame.radiance.size() == 3 * pixels;
    case Layer::kSource:
      return frame.source.size() == pixels;
    case Layer::kObject:
      return frame.object.size() == pixels;
    case Layer::kDepth:
      return frame.depth.size() == pixels;
  }
  return false;
}

Picture8 PaintLayer(const Frame& frame, Layer layer) {
  LT_CHECK(HasLayer(frame, layer));
  switch (layer) {
    case Layer::kVerdict:
      return Paint(frame, [&](size_t i) { return VerdictColor(frame, i); });
    case Layer::kSource:
      return Paint(frame, [&](size_t i) {
        return SourceLegend()[static_cast<size_t>(frame.source[i])].color;
      });
    case Layer::kObject:
      return Paint(frame, [&](size_t i) { return ObjectColor(frame.object[i]); });
    case Layer::kDepth: {
      const DepthRange range = RangeOf(frame.depth);
      return Paint(frame, [&](size_t i) { return DepthColor(range, frame.depth[i]); });
    }
    case Layer::kBeauty:
      break;
  }
  return Paint(frame, [&](size_t i) { return BeautyColor(frame, i); });
}

}  // namespace linetree
