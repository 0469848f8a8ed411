#include "core/io/ppm.h"

#include <algorithm>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"

namespace linetree {
namespace {

// The next word of a PNM header; a comment runs from # to the end of the line.
absl::string_view NextWord(absl::string_view bytes, size_t& at) {
  while (at < bytes.size() &&
         (absl::ascii_isspace(static_cast<unsigned char>(bytes[at])) || bytes[at] == '#')) {
    if (bytes[at] == '#') at = std::min(bytes.find('\n', at), bytes.size() - 1);
    ++at;
  }
  const size_t start = at;
  while (at < bytes.size() && !absl::ascii_isspace(static_cast<unsigned char>(bytes[at]))) ++at;
  return bytes.substr(start, at - start);
}

}  // namespace

absl::StatusOr<PpmPicture> ParsePpm16(absl::string_view bytes) {
  size_t at = 0;
  PpmPicture picture;
  int max_value = 0;
  if (NextWord(bytes, at) != "P6" || !absl::SimpleAtoi(NextWord(bytes, at), &picture.width) ||
      !absl::SimpleAtoi(NextWord(bytes, at), &picture.height) ||
      !absl::SimpleAtoi(NextWord(bytes, at), &max_value) || max_value != 65535 ||
      picture.width < 1 || picture.height < 1) {
    return absl::InvalidArgumentError("expected a binary PPM with values up to 65535");
  }
  ++at;
  const size_t count = static_cast<size_t>(picture.width) * static_cast<size_t>(picture.height);
  if (bytes.size() < at || (bytes.size() - at) % 6 != 0 || (bytes.size() - at) / 6 != count) {
    return absl::InvalidArgumentError("expected a PPM of six bytes per pixel");
  }
  picture.pixels.resize(count);
  for (Rgb& pixel : picture.pixels) {
    for (int channel = 0; channel < 3; ++channel, at += 2) {
      const int value =
          static_cast<unsigned char>(bytes[at]) * 256 + static_cast<unsigned char>(bytes[at + 1]);
      pixel[channel] = value / 65535.0;
    }
  }
  return picture;
}

}  // namespace linetree
