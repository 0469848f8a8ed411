#include "core/render/sample_blocks.h"

#include <algorithm>

#include "core/render/sample_mean.h"

namespace linetree {
namespace {

using Region = PacketTracer::Region;

constexpr int kTileSide = 4;

constexpr int kBlockTiles = kBlockPixels / kPacketLanes;

// Pixels a side whose samples are one block of the finer image: whole tiles of pixels, or parts of
// one. A tile of the finer image then lies in one tile of pixels.
int PixelsOf(int cells) {
  const int pixels = std::max(1, kBlockSide / cells);
  if (pixels < kTileSide) return pixels == 1 ? 1 : 2;
  return pixels / kTileSide * kTileSide;
}

// Part of a region, of at most `width` x `height`, that begins at (column, row) of it.
Region PartOf(const Region& whole, int column, int row, int width, int height) {
  return {whole.column + column, whole.row + row, std::min(width, whole.width - column),
          std::min(height, whole.height - row)};
}

template <class Body>
void ForParts(const Region& whole, int width, int height, const Body& body) {
  for (int row = 0; row < whole.height; row += height) {
    for (int column = 0; column < whole.width; column += width) {
      body(PartOf(whole, column, row, width, height));
    }
  }
}

class SampledBlock {
 public:
  SampledBlock(const SampledFrame& sampled, const Region& region, const RenderSamples& render,
               const OnceBlock* once, UseCounts& counts)
      : sampled_(sampled),
        samples_(sampled.samples),
        region_(region),
        render_(render),
        once_(once),
        counts_(counts) {}

  void Render() {
    ForParts(region_, PixelsOf(samples_.across()), PixelsOf(samples_.down()),
             [&](const Region& pixels) { RenderPixels(pixels); });
  }

 private:
  // Of the image's pixel, where its tile of pixels is among the region's, and its lane.
  struct TileLane {
    int tile, lane;
  };
  TileLane PlaceOf(int column, int row) const {
    const int x = column - region_.column, y = row - region_.row;
    const int across = (region_.width + kTileSide - 1) / kTileSide;
    return {y / kTileSide * across + x / kTileSide, y % kTileSide * kTileSide + x % kTileSide};
  }
  bool IsDone(int column, int row) const {
    if (once_ == nullptr) return false;
    const auto [tile, lane] = PlaceOf(column, row);
    return (once_->done[tile] >> lane & 1) != 0;
  }

  // The samples of these pixels at once.
  void RenderPixels(const Region& pixels) {
    const Region cells = {pixels.column * samples_.across(), pixels.row * samples_.down(),
                          pixels.width * samples_.across(), pixels.height * samples_.down()};
    Resize(cells);
    ForParts(cells, kBlockSide, kBlockSide,
             [&](const Region& block) { RenderBlock(block, cells); });
    for (int row = 0; row < pixels.height; ++row) {
      for (int column = 0; column < pixels.width; ++column) {
        if (IsDone(pixels.column + column, pixels.row + row)) continue;
        StorePixel(pixels, column, row);
      }
    }
  }

  // Those of a block's tiles with a sample of a pixel that is not done, and what they see.
  uint64_t FindTiles(const Region& block, SeenFace seen[kBlockTiles]) const {
    if (once_ == nullptr) return ~uint64_t{0};
    uint64_t wanted = 0;
    int tile = 0;
    ForParts(block, kTileSide, kTileSide, [&](const Region& part) {
      const int left = part.column / samples_.across(), top = part.row / samples_.down();
      const int right = (part.column + part.width - 1) / samples_.across();
      const int bottom = (part.row + part.height - 1) / samples_.down();
      bool is_done = true;
      for (int row = top; row <= bottom; ++row) {
        for (int column = left; column <= right; ++column) {
          is_done = is_done && IsDone(column, row);
        }
      }
      if (!is_done) wanted |= uint64_t{1} << tile;
      seen[tile++] = once_->seen[PlaceOf(left, top).tile];
    });
    return wanted;
  }

  // Samples of pixels that have been counted before and lie in the same tiles as others.
  void UncountDone(const Region& block, uint64_t tiles, const uint8_t* uses) {
    if (samples_.across() % kTileSide == 0 && samples_.down() % kTileSide == 0) return;
    int tile = 0;
    ForParts(block, kTileSide, kTileSide, [&](const Region& part) {
      for (int y = 0; y < part.height && (tiles >> tile & 1) != 0; ++y) {
        for (int x = 0; x < part.width; ++x) {
          const int column = (part.column + x) / samples_.across();
          const int row = (part.row + y) / samples_.down();
          if (IsDone(column, row)) --counts_.of[uses[tile * kPacketLanes + y * kTileSide + x]];
        }
      }
      ++tile;
    });
  }

  void Resize(const Region& cells) {
    fine_.width = cells.width;
    fine_.height = cells.height;
    const auto count = static_cast<size_t>(cells.width) * static_cast<size_t>(cells.height);
    fine_.radiance.resize(3 * count);
    fine_.object.resize(count);
    fine_.depth.resize(count);
    fine_.source.resize(count);
    fine_.verdict.resize(count);
  }

  void RenderBlock(const Region& block, const Region& cells) {
    SeenFace seen[kBlockTiles];
    const uint64_t tiles = FindTiles(block, seen);
    if (tiles == 0) return;
    const PixelTarget target = {fine_.radiance.data(), fine_.object.data(), fine_.depth.data(),
                                nullptr};
    BlockTask task = {
        sampled_.eye_rays,     block, sampled_.limits, static_cast<size_t>(cells.width), target,
        sampled_.sees_squares, tiles};
    task.samples = &samples_;
    task.left = cells.column;
    task.top = cells.row;
    if (once_ != nullptr) task.seen = seen;
    const uint8_t* uses = render_(task);
    StoreSources({block.column - cells.column, block.row - cells.row, block.width, block.height},
                 tiles, uses, sampled_.asked, fine_, counts_);
    if (once_ != nullptr) UncountDone(block, tiles, uses);
  }

  void StorePixel(const Region& pixels, int column, int row) {
    const auto at = [&](int x, int y) {
      return static_cast<size_t>(row * samples_.down() + y) * static_cast<size_t>(fine_.width) +
             static_cast<size_t>(column * samples_.across() + x);
    };
    const Rgb mean = MeanOfSamples(samples_, [&](int x, int y) {
      const float* radiance = &fine_.radiance[3 * at(x, y)];
      return Rgb{radiance[0], radiance[1], radiance[2]};
    });
    Frame& frame = sampled_.frame;
    const size_t p = static_cast<size_t>(pixels.row + row) * static_cast<size_t>(frame.width) +
                     static_cast<size_t>(pixels.column + column);
    for (int c = 0; c < 3; ++c) {
      frame.radiance[3 * p + static_cast<size_t>(c)] = static_cast<float>(mean[c]);
    }
    const ShownSample shown(samples_);
    const size_t from = at(shown.column, shown.row);
    frame.object[p] = fine_.object[from];
    frame.depth[p] = fine_.depth[from];
    frame.source[p] = fine_.source[from];
    frame.verdict[p] = fine_.verdict[from];
  }

  const SampledFrame& sampled_;
  const PixelSamples& samples_;
  const Region& region_;
  const RenderSamples& render_;
  const OnceBlock* const once_;
  UseCounts& counts_;
  Frame fine_;  // the samples' own
};

}  // namespace

void RenderSampledBlock(const SampledFrame& sampled, const Region& region,
                        const RenderSamples& render, const OnceBlock* once, UseCounts& counts) {
  SampledBlock(sampled, region, render, once, counts).Render();
}

}  // namespace linetree
