#include "core/io/exr.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfVecAttribute.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <exception>
#include <filesystem>
#include <stdexcept>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/io/atomic_file.h"
#include "core/io/stats_json.h"
#include "core/math/check.h"

namespace linetree {
namespace {

constexpr const char* kObject = "object";
constexpr const char* kSource = "source";
constexpr const char* kVerdict = "verdict";
constexpr const char* kDepth = "Z";

// OpenEXR writes into memory first: the file then appears in one step.
class MemoryStream : public Imf::OStream {
 public:
  MemoryStream() : Imf::OStream("memory") {}
  void write(const char c[], int n) override {
    const size_t size = static_cast<size_t>(n);
    if (position_ + size > bytes_.size()) bytes_.resize(position_ + size);
    std::memcpy(bytes_.data() + position_, c, size);
    position_ += size;
  }
  uint64_t tellp() override { return position_; }
  void seekp(uint64_t position) override { position_ = position; }
  std::string Take() { return std::move(bytes_); }

 private:
  std::string bytes_;
  size_t position_ = 0;
};

// OpenEXR throws at the end of a file that is too short.
class MemoryReader : public Imf::IStream {
 public:
  explicit MemoryReader(const std::string& bytes) : Imf::IStream("memory"), bytes_(bytes) {}
  bool read(char c[], int n) override {
    const size_t size = static_cast<size_t>(n);
    if (position_ > bytes_.size() || size > bytes_.size() - position_) {
      throw std::runtime_error("unexpected end of file");
    }
    std::memcpy(c, bytes_.data() + position_, size);
    position_ += size;
    return position_ < bytes_.size();
  }
  uint64_t tellg() override { return position_; }
  void seekg(uint64_t position) override { position_ = position; }

 private:
  const std::string& bytes_;
  size_t position_ = 0;
};

// The layers that OpenEXR wants as 32-bit numbers.
struct UintLayers {
  std::vector<uint32_t> object, source, verdict;
  explicit UintLayers(size_t pixels) : object(pixels), source(pixels), verdict(pixels) {}
};

bool HasLayers(const Frame& frame) {
  const size_t pixels = frame.radiance.size() / 3;
  return frame.object.size() == pixels && frame.source.size() == pixels &&
         frame.verdict.size() == pixels && frame.depth.size() == pixels;
}

UintLayers PackLayers(const Frame& frame) {
  UintLayers layers(frame.object.size());
  for (size_t i = 0; i < frame.object.size(); ++i) {
    layers.object[i] =
        frame.object[i] < 0 ? kExrBackgroundObject : static_cast<uint32_t>(frame.object[i]);
    layers.source[i] = static_cast<uint32_t>(frame.source[i]);
    layers.verdict[i] = static_cast<uint32_t>(frame.verdict[i]);
  }
  return layers;
}

Imath::V3d ToImath(const Vec3d& v) { return {v.x, v.y, v.z}; }
Vec3d FromImath(const Imath::V3d& v) { return {v.x, v.y, v.z}; }

Imf::Header HeaderOf(const Frame& frame) {
  Imf::Header header(frame.width, frame.height);
  header.compression() = Imf::ZIP_COMPRESSION;
  header.insert("camera", Imf::StringAttribute(frame.camera.name));
  header.insert("eye", Imf::V3dAttribute(ToImath(frame.camera.eye)));
  header.insert("look_at", Imf::V3dAttribute(ToImath(frame.camera.look_at)));
  header.insert("up", Imf::V3dAttribute(ToImath(frame.camera.up)));
  header.insert("fov_deg", Imf::DoubleAttribute(frame.camera.fov_deg));
  header.insert("max_relative_error", Imf::DoubleAttribute(frame.max_relative_error));
  header.insert("white", Imf::DoubleAttribute(frame.white));
  header.insert("scene_version", Imf::StringAttribute(frame.scene_version));
  header.insert("statistics",
                Imf::StringAttribute(StatsJson(frame.stats, frame.width, frame.height).dump()));
  return header;
}

// A slice over a packed array of `per_pixel` numbers a pixel. (x0, y0) is the corner of the data
// window, which OpenEXR's addressing counts from the origin.
template <class T>
Imf::Slice SliceOf(Imf::PixelType type, T* data, int per_pixel, const Imath::Box2i& window) {
  const auto width = static_cast<size_t>(window.max.x - window.min.x + 1);
  const size_t x_stride = sizeof(T) * static_cast<size_t>(per_pixel);
  return Imf::Slice::Make(type, data, window, x_stride, x_stride * width);
}

void AddBeauty(Imf::FrameBuffer& buffer, float* radiance, const Imath::Box2i& window) {
  buffer.insert("R", SliceOf(Imf::FLOAT, radiance, 3, window));
  buffer.insert("G", SliceOf(Imf::FLOAT, radiance + 1, 3, window));
  buffer.insert("B", SliceOf(Imf::FLOAT, radiance + 2, 3, window));
}

void AddLayers(Imf::FrameBuffer& buffer, UintLayers& layers, float* depth,
               const Imath::Box2i& window) {
  buffer.insert(kObject, SliceOf(Imf::UINT, layers.object.data(), 1, window));
  buffer.insert(kSource, SliceOf(Imf::UINT, layers.source.data(), 1, window));
  buffer.insert(kVerdict, SliceOf(Imf::UINT, layers.verdict.data(), 1, window));
  buffer.insert(kDepth, SliceOf(Imf::FLOAT, depth, 1, window));
}

template <class Attribute, class Value>
void TakeAttribute(const Imf::Header& header, const char* name, Value& value) {
  if (const auto* found = header.findTypedAttribute<Attribute>(name)) value = found->value();
}

void TakeVec3(const Imf::Header& header, const char* name, Vec3d& value) {
  if (const auto* found = header.findTypedAttribute<Imf::V3dAttribute>(name)) {
    value = FromImath(found->value());
  }
}

void TakeAttributes(const Imf::Header& header, Frame& frame) {
  TakeAttribute<Imf::StringAttribute>(header, "camera", frame.camera.name);
  TakeVec3(header, "eye", frame.camera.eye);
  TakeVec3(header, "look_at", frame.camera.look_at);
  TakeVec3(header, "up", frame.camera.up);
  TakeAttribute<Imf::DoubleAttribute>(header, "fov_deg", frame.camera.fov_deg);
  TakeAttribute<Imf::DoubleAttribute>(header, "max_relative_error", frame.max_relative_error);
  TakeAttribute<Imf::DoubleAttribute>(header, "white", frame.white);
  TakeAttribute<Imf::StringAttribute>(header, "scene_version", frame.scene_version);
}

// What error figures divide by and compare with must be numbers that they can use.
absl::Status CheckAttributes(const Frame& frame) {
  if (!std::isfinite(frame.white) || !(frame.white > 0)) {
    return absl::InvalidArgumentError(
        absl::StrCat("attribute white: expected a positive number, found ", frame.white));
  }
  if (!std::isfinite(frame.max_relative_error) || !(frame.max_relative_error >= 0)) {
    return absl::InvalidArgumentError(
        absl::StrCat("attribute max_relative_error: expected a number of at least 0, found ",
                     frame.max_relative_error));
  }
  return absl::OkStatus();
}

// An unknown number (a file from elsewhere) is refused rather than cast.
absl::Status UnpackLayers(const UintLayers& layers, Frame& frame) {
  for (size_t i = 0; i < layers.object.size(); ++i) {
    if (layers.source[i] >= static_cast<uint32_t>(kSourceCount) ||
        layers.verdict[i] >= static_cast<uint32_t>(kVerdictCount)) {
      return absl::InvalidArgumentError(absl::StrCat(
          "pixel ", i, ": expected a source below ", kSourceCount, " and a verdict below ",
          kVerdictCount, ", found ", layers.source[i], " and ", layers.verdict[i]));
    }
    frame.object[i] = static_cast<int32_t>(layers.object[i]);
    frame.source[i] = static_cast<Source>(layers.source[i]);
    frame.verdict[i] = static_cast<Verdict>(layers.verdict[i]);
  }
  return absl::OkStatus();
}

// Names, each up to a zero, with 16 bytes behind it; an empty one ends them.
bool IsChannelList(std::string_view value) {
  constexpr size_t kChannelBytes = 16;
  size_t at = 0;
  while (at < value.size() && value[at] != 0) {
    const size_t end = value.find('\0', at);
    if (end == value.npos || value.size() - end <= kChannelBytes) return false;
    at = end + 1 + kChannelBytes;
  }
  return at + 1 == value.size();
}

// OpenEXR reads what a type takes, whatever size the header claims, and goes on behind that: where
// they differ, it would see other attributes than CheckHeader. Of the types that EncodeExr writes.
bool IsValueOf(std::string_view type, std::string_view value) {
  constexpr std::pair<std::string_view, size_t> kSizes[] = {
      {"box2i", 16},    {"compression", 1}, {"double", 8}, {"float", 4},
      {"lineOrder", 1}, {"v2f", 8},         {"v3d", 24}};
  if (type == "chlist") return IsChannelList(value);
  return type == "string" || std::any_of(std::begin(kSizes), std::end(kSizes), [&](const auto& of) {
           return of.first == type && of.second == value.size();
         });
}

// OpenEXR sets memory aside for whatever a header claims, so what it claims is looked at before.
// Layout: a magic number and a version, 4 bytes each; then attributes: name and type, each up to a
// zero, 4 bytes of size, and the value. An empty name ends them.
absl::Status CheckHeader(std::string_view bytes, int64_t max_pixels) {
  const auto number = [&](size_t at) {
    uint32_t value = 0;
    for (size_t i = 0; i < 4; ++i) value |= (bytes[at + i] & 0xffu) << (8 * i);
    return value;
  };
  const auto bad = [](absl::string_view what) {
    return absl::InvalidArgumentError(absl::StrCat("expected an OpenEXR file: ", what));
  };
  constexpr uint32_t kOnePartOfLines = 2;
  if (bytes.size() < 8 || number(4) != kOnePartOfLines) return bad("of one part, by lines");
  size_t at = 8;
  while (at < bytes.size() && bytes[at] != 0) {
    const size_t name_end = bytes.find('\0', at);
    const size_t type_end = name_end == bytes.npos ? bytes.npos : bytes.find('\0', name_end + 1);
    if (type_end == bytes.npos || bytes.size() - type_end < 5) return bad("its header is cut off");
    const std::string_view name = bytes.substr(at, name_end - at);
    const size_t size = number(type_end + 1);
    at = type_end + 5;
    if (size > bytes.size() - at) return bad("an attribute ends behind its end");
    const std::string_view type = bytes.substr(name_end + 1, type_end - name_end - 1);
    if (!IsValueOf(type, bytes.substr(at, size))) {
      return bad("an attribute is not as large as its type");
    }
    if (name == "dataWindow" && type == "box2i") {
      const auto side = [&](size_t axis) {
        return int64_t{static_cast<int32_t>(number(at + 8 + 4 * axis))} -
               static_cast<int32_t>(number(at + 4 * axis)) + 1;
      };
      if (side(0) < 1 || side(1) < 1 || side(0) > max_pixels || side(1) > max_pixels) {
        return bad(absl::StrCat("of at most ", max_pixels, " pixels"));
      }
    }
    at += size;
  }
  return absl::OkStatus();
}

absl::StatusOr<Frame> Decode(Imf::InputFile& file, int64_t max_pixels) {
  const Imf::Header& header = file.header();
  const Imath::Box2i window = header.dataWindow();
  const int64_t width = int64_t{window.max.x} - window.min.x + 1;
  const int64_t height = int64_t{window.max.y} - window.min.y + 1;
  if (width > max_pixels || height > max_pixels || width * height > max_pixels) {
    return absl::InvalidArgumentError(
        absl::StrCat("expected at most ", max_pixels, " pixels, found ", width, " x ", height));
  }
  for (const char* channel : {"R", "G", "B"}) {
    if (header.channels().findChannel(channel) == nullptr) {
      return absl::InvalidArgumentError(absl::StrCat("expected a channel ", channel));
    }
  }
  Frame frame;
  frame.width = static_cast<int>(width);
  frame.height = static_cast<int>(height);
  const auto pixels = static_cast<size_t>(width * height);
  frame.stats.pixels = pixels;
  frame.radiance.resize(3 * pixels, 0);
  Imf::FrameBuffer buffer;
  AddBeauty(buffer, frame.radiance.data(), window);
  bool layered = true;
  for (const char* channel : {kObject, kSource, kVerdict, kDepth}) {
    layered = layered && header.channels().findChannel(channel) != nullptr;
  }
  UintLayers layers(layered ? pixels : 0);
  if (layered) {
    frame.object.resize(pixels, 0);
    frame.source.resize(pixels, {});
    frame.verdict.resize(pixels, {});
    frame.depth.resize(pixels, 0);
    AddLayers(buffer, layers, frame.depth.data(), window);
  }
  file.setFrameBuffer(buffer);
  file.readPixels(window.min.y, window.max.y);
  TakeAttributes(header, frame);
  if (absl::Status status = CheckAttributes(frame); !status.ok()) return status;
  if (absl::Status status = UnpackLayers(layers, frame); !status.ok()) return status;
  return frame;
}

}  // namespace

std::string EncodeExr(const Frame& frame) {
  LT_CHECK(frame.width > 0 && frame.height > 0);
  LT_CHECK(frame.radiance.size() ==
           3 * static_cast<size_t>(frame.width) * static_cast<size_t>(frame.height));
  Imf::Header header = HeaderOf(frame);
  const Imath::Box2i window = header.dataWindow();
  Imf::FrameBuffer buffer;
  // OpenEXR takes a pointer to non-const for reading and writing alike.
  AddBeauty(buffer, const_cast<float*>(frame.radiance.data()), window);
  UintLayers layers(0);
  if (HasLayers(frame)) {
    layers = PackLayers(frame);
    AddLayers(buffer, layers, const_cast<float*>(frame.depth.data()), window);
  }
  for (auto channel = buffer.begin(); channel != buffer.end(); ++channel) {
    header.channels().insert(channel.name(), Imf::Channel(channel.slice().type));
  }
  MemoryStream stream;
  {
    Imf::OutputFile file(stream, header);
    file.setFrameBuffer(buffer);
    file.writePixels(frame.height);
  }
  return stream.Take();
}

absl::Status WriteExr(const Frame& frame, const std::string& path) {
  return WriteFileAtomically(path, EncodeExr(frame));
}

absl::StatusOr<Frame> DecodeExr(const std::string& bytes, int64_t max_pixels) {
  if (auto status = CheckHeader(bytes, max_pixels); !status.ok()) return status;
  try {
    MemoryReader reader(bytes);
    Imf::InputFile file(reader);
    return Decode(file, max_pixels);
  } catch (const std::exception& e) {
    return absl::InvalidArgumentError(absl::StrCat("expected an OpenEXR file: ", e.what()));
  }
}

absl::StatusOr<Frame> ReadExr(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    return absl::NotFoundError(absl::StrCat(path, ": no such file"));
  }
  // OpenEXR reports by exceptions; they end here.
  try {
    Imf::InputFile file(path.c_str());
    absl::StatusOr<Frame> frame = Decode(file, kMaxExrPixels);
    if (frame.ok()) return frame;
    return absl::Status(frame.status().code(), absl::StrCat(path, ": ", frame.status().message()));
  } catch (const std::exception& e) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": expected an OpenEXR file: ", e.what()));
  }
}

}  // namespace linetree
