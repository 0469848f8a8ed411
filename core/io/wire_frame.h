// A frame as the stream of messages that carries it: tiles in row-major order, then the end.
#pragma once

#include <vector>

#include "absl/status/status.h"
#include "core/render/frame.h"
#include "linetree/v1/service.pb.h"

namespace linetree {

// Side of a tile in pixels; those on the right and lower rim are smaller.
inline constexpr int kWireTileSide = 64;

// Cuts a frame into messages.
class FrameChunks {
 public:
  FrameChunks(Frame frame, bool all_layers) : frame_(std::move(frame)), all_layers_(all_layers) {}

  // Fills *chunk with the next message; false when the last one (FrameEnd) has been handed out.
  bool Next(v1::FrameChunk* chunk);

 private:
  void FillTile(v1::Tile* tile) const;
  void FillEnd(v1::FrameEnd* end) const;

  Frame frame_;
  bool all_layers_;
  bool ended_ = false;
  int x_ = 0;  // of the next tile
  int y_ = 0;  // frame_.height when only the end is left
};

// Puts a frame together again. The sender is not trusted: what does not fit is DATA_LOSS.
class FrameAssembler {
 public:
  FrameAssembler(int width, int height, bool all_layers);

  absl::Status Add(const v1::FrameChunk& chunk);

  // Whether FrameEnd has come, which only a complete frame may have.
  bool complete() const { return complete_; }
  double share_done() const;
  // Requires complete().
  Frame Take();

 private:
  absl::Status CheckTile(const v1::Tile& tile) const;
  absl::Status AddTile(const v1::Tile& tile);
  // Pixels of the tile's row that starts at its pixel `from` to the frame's pixels from `to` on.
  void CopyRow(const v1::Tile& tile, size_t from, size_t to);
  absl::Status AddEnd(const v1::FrameEnd& end);

  Frame frame_;
  bool all_layers_;
  std::vector<bool> filled_;  // by pixel
  size_t pixels_filled_ = 0;
  bool complete_ = false;
};

}  // namespace linetree
