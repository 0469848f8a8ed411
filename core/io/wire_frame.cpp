#include "core/io/wire_frame.h"

#include <Imath/half.h>

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "core/io/exr.h"
#include "core/io/wire.h"
#include "core/math/check.h"

namespace linetree {
namespace {

// What a file holds beside its pixels, at most: headers, attributes, tables of lines.
constexpr uint64_t kMaxFileHeaderBytes = uint64_t{1} << 20;

// Index of the first pixel of row `row` of the tile within the frame.
size_t RowStart(const v1::Tile& tile, int row, int frame_width) {
  return (tile.y() + static_cast<size_t>(row)) * static_cast<size_t>(frame_width) + tile.x();
}

template <class Values, class Value>
void AppendRow(const PixelLayer<Value>& layer, size_t start, size_t count, Values* out) {
  const auto first = layer.begin() + static_cast<std::ptrdiff_t>(start);
  out->Add(first, first + static_cast<std::ptrdiff_t>(count));
}

template <class Value>
void AppendBytes(const PixelLayer<Value>& layer, size_t start, size_t count, std::string* out) {
  for (size_t i = start; i < start + count; ++i) out->push_back(static_cast<char>(layer[i]));
}

void AppendHalves(const PixelLayer<float>& layer, size_t start, size_t count, std::string* out) {
  for (size_t i = start; i < start + count; ++i) {
    const uint16_t bits = Imath::half(layer[i]).bits();
    out->push_back(static_cast<char>(bits & 0xff));
    out->push_back(static_cast<char>(bits >> 8));
  }
}

float HalfAt(const std::string& bytes, size_t index) {
  const auto byte = [&](size_t i) { return static_cast<unsigned>(bytes[i] & 0xff); };
  Imath::half half;
  half.setBits(static_cast<uint16_t>(byte(2 * index) | byte(2 * index + 1) << 8));
  return half;
}

bool AllBelow(const std::string& bytes, int limit) {
  return std::all_of(bytes.begin(), bytes.end(),
                     [limit](char c) { return static_cast<unsigned char>(c) < limit; });
}

}  // namespace

absl::StatusOr<FrameFormat> FrameFormatFromWire(const v1::RenderFrameRequest& message,
                                                absl::string_view path) {
  static_assert(v1::CODEC_JPEG == static_cast<int>(FrameCodec::kJpeg) + 1);
  if (!v1::Codec_IsValid(message.codec())) {
    return absl::InvalidArgumentError(
        absl::StrCat(path, "codec: expected one of the values in service.proto, got ",
                     static_cast<int>(message.codec())));
  }
  FrameFormat format{.all_layers = message.all_layers()};
  if (message.codec() != v1::CODEC_UNSPECIFIED) {
    format.codec = static_cast<FrameCodec>(message.codec() - 1);
  }
  if (message.jpeg_quality() > kMaxJpegQuality) {
    return absl::InvalidArgumentError(absl::StrCat(path, "jpeg_quality: expected at most ",
                                                   kMaxJpegQuality, ", got ",
                                                   message.jpeg_quality()));
  }
  if (message.jpeg_quality() > 0) format.jpeg_quality = static_cast<int>(message.jpeg_quality());
  if (format.all_layers && !HoldsLayers(format.codec)) {
    return absl::InvalidArgumentError(
        absl::StrCat(path, "all_layers: expected a codec that holds layers, not ",
                     v1::Codec_Name(message.codec())));
  }
  return format;
}

void FrameFormatToWire(const FrameFormat& format, v1::RenderFrameRequest* message) {
  message->set_all_layers(format.all_layers);
  message->set_codec(static_cast<v1::Codec>(static_cast<int>(format.codec) + 1));
  if (format.codec != FrameCodec::kJpeg) return;
  message->set_jpeg_quality(static_cast<uint32_t>(format.jpeg_quality));
}

absl::StatusOr<FrameChunks> FrameChunks::Make(Frame frame, const FrameFormat& format) {
  FrameChunks chunks(std::move(frame), format);
  if (!format.all_layers) chunks.DropLayers();
  if (!IsFile(format.codec)) return chunks;
  auto file = EncodeFile(chunks.frame_, format);
  if (!file.ok()) return file.status();
  chunks.file_ = *std::move(file);
  // Only what the end says is still needed.
  chunks.DropLayers();
  chunks.frame_.radiance = {};
  return chunks;
}

void FrameChunks::DropLayers() {
  frame_.object = {};
  frame_.source = {};
  frame_.verdict = {};
  frame_.depth = {};
}

bool FrameChunks::AtEnd() const {
  return IsFile(format_.codec) ? sent_ == file_.size() : y_ >= frame_.height;
}

bool FrameChunks::Next(v1::FrameChunk* chunk) {
  if (ended_) return false;
  if (AtEnd()) {
    ended_ = true;
    FillEnd(chunk->mutable_end());
    return true;
  }
  if (IsFile(format_.codec)) {
    FillPart(chunk->mutable_file());
    return true;
  }
  FillTile(chunk->mutable_tile());
  x_ += kWireTileSide;
  if (x_ >= frame_.width) {
    x_ = 0;
    y_ += kWireTileSide;
  }
  return true;
}

void FrameChunks::FillPart(v1::FilePart* part) {
  part->set_offset(sent_);
  part->set_file_bytes(file_.size());
  part->set_data(file_.substr(sent_, kFilePartBytes));
  sent_ += part->data().size();
}

void FrameChunks::FillTile(v1::Tile* tile) const {
  tile->Clear();
  const int width = std::min(kWireTileSide, frame_.width - x_);
  const int height = std::min(kWireTileSide, frame_.height - y_);
  tile->set_x(static_cast<uint32_t>(x_));
  tile->set_y(static_cast<uint32_t>(y_));
  tile->set_width(static_cast<uint32_t>(width));
  tile->set_height(static_cast<uint32_t>(height));
  const bool is_half = format_.codec == FrameCodec::kHalf;
  if (!is_half) tile->mutable_radiance()->Reserve(3 * width * height);
  const auto count = static_cast<size_t>(width);
  for (int row = 0; row < height; ++row) {
    const size_t start = RowStart(*tile, row, frame_.width);
    if (is_half) {
      AppendHalves(frame_.radiance, 3 * start, 3 * count, tile->mutable_radiance_half());
    } else {
      AppendRow(frame_.radiance, 3 * start, 3 * count, tile->mutable_radiance());
    }
    if (!format_.all_layers) continue;
    AppendRow(frame_.object, start, count, tile->mutable_object());
    AppendBytes(frame_.source, start, count, tile->mutable_source());
    AppendBytes(frame_.verdict, start, count, tile->mutable_verdict());
    AppendRow(frame_.depth, start, count, tile->mutable_depth());
  }
}

void FrameChunks::FillEnd(v1::FrameEnd* end) const {
  end->set_scene_version(frame_.scene_version);
  *end->mutable_stats() = FrameStatsToWire(frame_.stats, frame_.width, frame_.height);
  *end->mutable_camera() = CameraToWire(frame_.camera);
  end->set_max_relative_error(frame_.max_relative_error);
  end->set_lane_rounding(frame_.lane_rounding);
  end->set_white(frame_.white);
  *end->mutable_sampling() = SamplingToWire(frame_.sampling);
}

FrameAssembler::FrameAssembler(int width, int height, const FrameFormat& format) : format_(format) {
  LT_CHECK(width > 0 && height > 0);
  const size_t pixels = static_cast<size_t>(width) * static_cast<size_t>(height);
  frame_.width = width;
  frame_.height = height;
  if (IsFile(format.codec)) return;
  frame_.radiance.resize(3 * pixels, 0);
  filled_.resize(pixels);
  if (!format.all_layers) return;
  frame_.object.resize(pixels, 0);
  frame_.source.resize(pixels, {});
  frame_.verdict.resize(pixels, {});
  frame_.depth.resize(pixels, 0);
}

absl::Status FrameAssembler::Add(const v1::FrameChunk& chunk) {
  if (complete_) return absl::DataLossError("a chunk came after the end of its frame");
  frame_.wire_bytes += chunk.ByteSizeLong();
  if (chunk.has_end()) return AddEnd(chunk.end());
  const bool is_file = IsFile(format_.codec);
  if (is_file && chunk.has_file()) return AddPart(chunk.file());
  if (!is_file && chunk.has_tile()) return AddTile(chunk.tile());
  return absl::DataLossError(absl::StrCat("a chunk came with neither ",
                                          is_file ? "a part of a file" : "a tile", " nor an end"));
}

absl::Status FrameAssembler::AddPart(const v1::FilePart& part) {
  const auto pixels = static_cast<uint64_t>(frame_.width) * static_cast<uint64_t>(frame_.height);
  const uint64_t most = kMaxFileHeaderBytes + pixels * FileBytesPerPixel(format_.codec);
  if (frame_.file.empty()) file_bytes_ = part.file_bytes();
  if (file_bytes_ > most || part.file_bytes() != file_bytes_ || part.data().empty() ||
      part.offset() != frame_.file.size() ||
      part.data().size() > file_bytes_ - frame_.file.size()) {
    return absl::DataLossError(absl::StrCat("a part of a file does not fit: ", part.data().size(),
                                            " bytes at ", part.offset(), " of ",
                                            part.file_bytes()));
  }
  frame_.file += part.data();
  return absl::OkStatus();
}

absl::Status FrameAssembler::TakeFile() {
  if (frame_.file.empty() || frame_.file.size() != file_bytes_) {
    return absl::DataLossError(absl::StrCat("a frame ended with ", frame_.file.size(), " of ",
                                            file_bytes_, " bytes of its file"));
  }
  if (format_.codec != FrameCodec::kExr) return absl::OkStatus();
  auto decoded = DecodeExr(frame_.file, int64_t{frame_.width} * frame_.height);
  if (!decoded.ok()) return absl::DataLossError(decoded.status().message());
  if (decoded->width != frame_.width || decoded->height != frame_.height ||
      decoded->depth.empty() == format_.all_layers) {
    return absl::DataLossError("a file came with another size or other layers than asked for");
  }
  frame_.radiance = std::move(decoded->radiance);
  frame_.object = std::move(decoded->object);
  frame_.source = std::move(decoded->source);
  frame_.verdict = std::move(decoded->verdict);
  frame_.depth = std::move(decoded->depth);
  return absl::OkStatus();
}

absl::Status FrameAssembler::CheckTile(const v1::Tile& tile) const {
  const uint64_t width = tile.width();
  const uint64_t height = tile.height();
  if (width == 0 || height == 0 || tile.x() + width > static_cast<uint64_t>(frame_.width) ||
      tile.y() + height > static_cast<uint64_t>(frame_.height)) {
    return absl::DataLossError(absl::StrCat("a tile lies outside its frame: ", width, "x", height,
                                            " at ", tile.x(), ",", tile.y()));
  }
  const auto pixels = static_cast<size_t>(width * height);
  const size_t layer = format_.all_layers ? pixels : 0;
  const bool is_half = format_.codec == FrameCodec::kHalf;
  if (static_cast<size_t>(tile.radiance_size()) != (is_half ? 0 : 3 * pixels) ||
      tile.radiance_half().size() != (is_half ? 6 * pixels : 0) ||
      static_cast<size_t>(tile.object_size()) != layer || tile.source().size() != layer ||
      tile.verdict().size() != layer || static_cast<size_t>(tile.depth_size()) != layer) {
    return absl::DataLossError("a tile came with a layer of the wrong length");
  }
  if (!AllBelow(tile.source(), v1::Source_ARRAYSIZE) || !AllBelow(tile.verdict(), kVerdictCount)) {
    return absl::DataLossError("a tile came with an unknown source or verdict");
  }
  return absl::OkStatus();
}

absl::Status FrameAssembler::AddTile(const v1::Tile& tile) {
  if (auto status = CheckTile(tile); !status.ok()) return status;
  const auto width = static_cast<size_t>(tile.width());
  for (int row = 0; row < static_cast<int>(tile.height()); ++row) {
    const size_t start = RowStart(tile, row, frame_.width);
    for (size_t i = start; i < start + width; ++i) {
      if (filled_[i]) return absl::DataLossError("two tiles of a frame overlap");
      filled_[i] = true;
    }
    CopyRow(tile, static_cast<size_t>(row) * width, start);
    pixels_filled_ += width;
  }
  return absl::OkStatus();
}

void FrameAssembler::CopyRow(const v1::Tile& tile, size_t from, size_t to) {
  const size_t width = tile.width();
  if (format_.codec == FrameCodec::kHalf) {
    for (size_t i = 0; i < 3 * width; ++i) {
      frame_.radiance[3 * to + i] = HalfAt(tile.radiance_half(), 3 * from + i);
    }
  } else {
    std::copy_n(tile.radiance().data() + 3 * from, 3 * width, frame_.radiance.data() + 3 * to);
  }
  if (!format_.all_layers) return;
  std::copy_n(tile.object().data() + from, width, frame_.object.data() + to);
  std::copy_n(tile.depth().data() + from, width, frame_.depth.data() + to);
  for (size_t i = 0; i < width; ++i) {
    frame_.source[to + i] = static_cast<Source>(tile.source()[from + i]);
    frame_.verdict[to + i] = static_cast<Verdict>(tile.verdict()[from + i]);
  }
}

absl::Status FrameAssembler::AddEnd(const v1::FrameEnd& end) {
  if (pixels_filled_ != filled_.size()) {
    return absl::DataLossError(
        absl::StrCat("a frame ended with ", pixels_filled_, " of ", filled_.size(), " pixels"));
  }
  if (IsFile(format_.codec)) {
    if (auto status = TakeFile(); !status.ok()) return status;
  }
  const auto sampling = SamplingFromWire(end.sampling(), "");
  if (!sampling.ok()) return absl::DataLossError(sampling.status().message());
  frame_.sampling = *sampling;
  frame_.scene_version = end.scene_version();
  frame_.stats = FrameStatsFromWire(end.stats());
  frame_.camera = CameraFromWire(end.camera());
  frame_.max_relative_error = end.max_relative_error();
  frame_.lane_rounding = end.lane_rounding();
  frame_.white = end.white();
  frame_.timing = {end.timing().queue_ms(), end.timing().render_ms(), end.timing().encode_ms()};
  complete_ = true;
  return absl::OkStatus();
}

double FrameAssembler::share_done() const {
  if (IsFile(format_.codec)) {
    return file_bytes_ == 0
               ? 0
               : static_cast<double>(frame_.file.size()) / static_cast<double>(file_bytes_);
  }
  return static_cast<double>(pixels_filled_) / static_cast<double>(filled_.size());
}

Frame FrameAssembler::Take() {
  LT_CHECK(complete_);
  return std::move(frame_);
}

}  // namespace linetree
