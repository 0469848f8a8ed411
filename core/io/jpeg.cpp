#include "core/io/jpeg.h"

#include <turbojpeg.h>

#include <memory>

#include "absl/strings/str_cat.h"
#include "core/math/check.h"

namespace linetree {
namespace {

struct Destroy {
  void operator()(void* handle) const { tjDestroy(handle); }
  void operator()(unsigned char* bytes) const { tjFree(bytes); }
};
using Handle = std::unique_ptr<void, Destroy>;

}  // namespace

absl::StatusOr<std::string> EncodeJpeg(const Picture8& picture, int quality) {
  LT_CHECK(quality >= 1 && quality <= 100);
  LT_CHECK(picture.rgb.size() ==
           3 * static_cast<size_t>(picture.width) * static_cast<size_t>(picture.height));
  const Handle encoder(tjInitCompress());
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  const int failed =
      tjCompress2(encoder.get(), picture.rgb.data(), picture.width, 0, picture.height, TJPF_RGB,
                  &bytes, &size, TJSAMP_444, quality, TJFLAG_ACCURATEDCT);
  const std::unique_ptr<unsigned char, Destroy> owned(bytes);
  if (failed != 0) {
    return absl::InternalError(
        absl::StrCat("cannot encode a JPEG file: ", tjGetErrorStr2(encoder.get())));
  }
  return std::string(reinterpret_cast<const char*>(bytes), size);
}

absl::StatusOr<Picture8> DecodeJpeg(std::string_view bytes) {
  const Handle decoder(tjInitDecompress());
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  Picture8 picture;
  int sampling = 0, colors = 0;
  const auto failed = [&] {
    return absl::InvalidArgumentError(
        absl::StrCat("expected a JPEG file: ", tjGetErrorStr2(decoder.get())));
  };
  if (tjDecompressHeader3(decoder.get(), data, bytes.size(), &picture.width, &picture.height,
                          &sampling, &colors) != 0) {
    return failed();
  }
  picture.rgb.resize(3 * static_cast<size_t>(picture.width) * static_cast<size_t>(picture.height));
  if (tjDecompress2(decoder.get(), data, bytes.size(), picture.rgb.data(), picture.width, 0,
                    picture.height, TJPF_RGB, TJFLAG_ACCURATEDCT) != 0) {
    return failed();
  }
  return picture;
}

}  // namespace linetree
