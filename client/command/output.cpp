#include "client/command/output.h"

#include <algorithm>
#include <filesystem>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "core/io/atomic_file.h"
#include "core/io/exr.h"
#include "core/io/jpeg.h"
#include "core/io/png.h"

namespace linetree {
namespace {

bool IsExr(const std::string& path) { return absl::EndsWithIgnoreCase(path, ".exr"); }
bool IsJpeg(const std::string& path) {
  return absl::EndsWithIgnoreCase(path, ".jpg") || absl::EndsWithIgnoreCase(path, ".jpeg");
}

}  // namespace

bool NeedsLayers(const OutputFlags& flags) {
  if (flags.pictures.empty()) return false;
  return flags.layer != Layer::kBeauty ||
         std::any_of(flags.pictures.begin(), flags.pictures.end(), IsExr);
}

absl::Status CheckFolders(const std::vector<std::string>& files) {
  for (const std::string& file : files) {
    const std::filesystem::path folder = std::filesystem::path(file).parent_path();
    std::error_code error;
    if (!folder.empty() && !std::filesystem::is_directory(folder, error)) {
      return absl::NotFoundError(
          absl::StrCat("cannot write ", file, ": no folder ", folder.string()));
    }
  }
  return absl::OkStatus();
}

absl::Status CheckFormat(const OutputFlags& flags, const FrameFormat& format) {
  if (HoldsLayers(format.codec)) return absl::OkStatus();
  const bool is_jpeg = format.codec == FrameCodec::kJpeg;
  if (flags.layer != Layer::kBeauty) {
    return absl::InvalidArgumentError("--layer: pictures (--codec) hold the beauty layer only");
  }
  for (const std::string& picture : flags.pictures) {
    if (!IsExr(picture) && IsJpeg(picture) == is_jpeg) continue;
    return absl::InvalidArgumentError(
        absl::StrCat("-o ", picture, ": frames come as ", is_jpeg ? "JPEG" : "PNG", " (--codec)"));
  }
  return absl::OkStatus();
}

absl::Status WritePicture(const Frame& frame, Layer layer, const std::string& path) {
  if (frame.radiance.empty() && !frame.file.empty()) return WriteFileAtomically(path, frame.file);
  if (IsExr(path)) return WriteExr(frame, path);
  if (IsJpeg(path)) {
    const auto file = EncodeJpeg(PaintLayer(frame, layer), FrameFormat{}.jpeg_quality);
    return file.ok() ? WriteFileAtomically(path, *file) : file.status();
  }
  return WritePng(PaintLayer(frame, layer), path);
}

absl::Status WriteJson(const nlohmann::json& json, const std::string& path) {
  return WriteFileAtomically(path, json.dump(2) + "\n");
}

}  // namespace linetree
