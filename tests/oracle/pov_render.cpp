#include "tests/oracle/pov_render.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "absl/strings/str_cat.h"

namespace linetree {
namespace {

std::string ReadAll(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

}  // namespace

absl::StatusOr<PpmPicture> RenderWithPov(const std::string& pov_text, const std::string& name,
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
