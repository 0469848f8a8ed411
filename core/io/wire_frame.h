// A frame as the stream of messages that carries it: tiles in row-major order or a file in parts,
// then the end.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "core/io/frame_codec.h"
#include "core/render/frame.h"
#include "linetree/v1/service.pb.h"

namespace linetree {

// Side of a tile in pixels; those on the right and lower rim are smaller.
inline constexpr int kWireTileSide = 64;

// No message of a frame is larger when it is serialized; its parts of files are a little smaller.
inline constexpr size_t kMaxChunkBytes = size_t{256} << 10;
inline constexpr size_t kFilePartBytes = kMaxChunkBytes - 1024;

inline constexpr int kMaxJpegQuality = 100;

// INVALID_ARGUMENT, naming the field, for an unknown codec, a quality out of range, and layers in a
// format that has none. `path` is a prefix as in wire.h.
absl::StatusOr<FrameFormat> FrameFormatFromWire(const v1::RenderFrameRequest& message,
                                                absl::string_view path);

// Cuts a frame into messages.
class FrameChunks {
 public:
  // Files are encoded here, which takes its time. INTERNAL when that fails.
  static absl::StatusOr<FrameChunks> Make(Frame frame, const FrameFormat& format);

  // Fills *chunk with the next message; false when the last one (FrameEnd) has been handed out.
  bool Next(v1::FrameChunk* chunk);

 private:
  FrameChunks(Frame frame, const FrameFormat& format) : frame_(std::move(frame)), format_(format) {}
  void DropLayers();
  bool AtEnd() const;
  void FillTile(v1::Tile* tile) const;
  void FillPart(v1::FilePart* part);
  void FillEnd(v1::FrameEnd* end) const;

  Frame frame_;  // without its pixels when there is a file
  FrameFormat format_;
  std::string file_;  // of codecs of files
  size_t sent_ = 0;   // of file_
  bool ended_ = false;
  int x_ = 0;  // of the next tile
  int y_ = 0;  // frame_.height when only the end is left
};

// What asks for the format: the request's codec, jpeg_quality and all_layers.
void FrameFormatToWire(const FrameFormat& format, v1::RenderFrameRequest* message);

// Puts a frame together again, from tiles of floats or halves, from an EXR file, or from a picture,
// which stays the file that it is. The sender is not trusted: what does not fit is DATA_LOSS.
class FrameAssembler {
 public:
  FrameAssembler(int width, int height, const FrameFormat& format);

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
  absl::Status AddPart(const v1::FilePart& part);
  // Of a file that is complete.
  absl::Status TakeFile();
  absl::Status AddEnd(const v1::FrameEnd& end);

  Frame frame_;
  FrameFormat format_;
  std::vector<bool> filled_;  // by pixel; empty for files
  size_t pixels_filled_ = 0;
  uint64_t file_bytes_ = 0;  // that the file is to have
  bool complete_ = false;
};

}  // namespace linetree
