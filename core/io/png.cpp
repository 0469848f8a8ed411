#include "core/io/png.h"

#include <png.h>

#include <cstring>
#include <filesystem>

#include "absl/strings/str_cat.h"
#include "core/io/atomic_file.h"
#include "core/math/check.h"

namespace linetree {
namespace {

// libpng's simplified interface keeps its state in this struct and reports by return value.
png_image EmptyImage() {
  png_image image;
  std::memset(&image, 0, sizeof image);
  image.version = PNG_IMAGE_VERSION;
  return image;
}

absl::Status PngError(const std::string& path, const png_image& image) {
  return absl::InvalidArgumentError(absl::StrCat(path, ": ", image.message));
}

}  // namespace

absl::StatusOr<std::string> EncodePng(const Picture8& picture) {
  LT_CHECK(picture.width > 0 && picture.height > 0);
  LT_CHECK(picture.rgb.size() ==
           3 * static_cast<size_t>(picture.width) * static_cast<size_t>(picture.height));
  png_image image = EmptyImage();
  image.width = static_cast<png_uint_32>(picture.width);
  image.height = static_cast<png_uint_32>(picture.height);
  image.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::string bytes(size, '\0');
  if (png_image_write_to_memory(&image, bytes.data(), &size, 0, picture.rgb.data(), 0, nullptr) ==
      0) {
    return absl::InternalError(absl::StrCat("cannot encode a PNG file: ", image.message));
  }
  bytes.resize(size);
  return bytes;
}

absl::Status WritePng(const Picture8& picture, const std::string& path) {
  const auto bytes = EncodePng(picture);
  if (!bytes.ok()) return bytes.status();
  return WriteFileAtomically(path, *bytes);
}

absl::StatusOr<Picture8> ReadPng(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    return absl::NotFoundError(absl::StrCat(path, ": no such file"));
  }
  png_image image = EmptyImage();
  if (png_image_begin_read_from_file(&image, path.c_str()) == 0) return PngError(path, image);
  image.format = PNG_FORMAT_RGB;
  Picture8 picture{static_cast<int>(image.width), static_cast<int>(image.height), {}};
  picture.rgb.resize(PNG_IMAGE_SIZE(image));
  if (png_image_finish_read(&image, nullptr, picture.rgb.data(), 0, nullptr) == 0) {
    return PngError(path, image);
  }
  return picture;
}

}  // namespace linetree
