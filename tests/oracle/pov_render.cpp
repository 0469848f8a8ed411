#include "tests/oracle/pov_render.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"

namespace linetree {
namespace {

std::string ReadAll(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

// The next word of a PNM header; a comment runs from # to the end of the line.
std::string NextWord(const std::string& bytes, size_t& at) {
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

absl::StatusOr<PovPicture> ParsePpm16(const std::string& bytes) {
  size_t at = 0;
  PovPicture picture;
  int max_value = 0;
  if (NextWord(bytes, at) != "P6" || !absl::SimpleAtoi(NextWord(bytes, at), &picture.width) ||
      !absl::SimpleAtoi(NextWord(bytes, at), &picture.height) ||
      !absl::SimpleAtoi(NextWord(bytes, at), &max_value) || max_value != 65535) {
    return absl::InvalidArgumentError("expected a binary PPM with values up to 65535");
  }
  ++at;
  const size_t count = static_cast<size_t>(picture.width) * static_cast<size_t>(picture.height);
  if (bytes.size() != at + 6 * count) {
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

absl::StatusOr<PovPicture> RenderWithPov(const std::string& pov_text, const std::string& name,
                                         int width, int height) {
  const std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / ("linetree_pov_" + name);
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "scene.pov") << pov_text;
  const std::string command =
      absl::StrCat("cd '", folder.string(), "' && povray +Iscene.pov +Opicture.ppm +W", width,
                   " +H", height, " +FP16 File_Gamma=1.0 Dither=off -A -D -V +WT1 > log 2>&1");
  if (std::system(command.c_str()) != 0) {
    return absl::UnavailableError(
        absl::StrCat("expected povray to render the scene:\n", ReadAll(folder / "log")));
  }
  auto picture = ParsePpm16(ReadAll(folder / "picture.ppm"));
  std::filesystem::remove_all(folder);
  return picture;
}

}  // namespace linetree
