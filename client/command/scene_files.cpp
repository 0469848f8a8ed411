#include "client/command/scene_files.h"

#include <xxhash.h>

#include <algorithm>
#include <filesystem>
#include <limits>

#include "absl/strings/str_cat.h"
#include "core/io/read_file.h"

namespace linetree {

absl::StatusOr<std::vector<std::string>> ScenesIn(const std::string& folder) {
  std::vector<std::string> files;
  std::error_code error;
  for (const std::string& part : {folder, folder + "/spd"}) {
    for (const auto& entry : std::filesystem::directory_iterator(part, error)) {
      const std::string extension = entry.path().extension();
      if (extension == ".textproto" || extension == ".nff") files.push_back(entry.path());
    }
  }
  if (files.empty()) {
    return absl::NotFoundError(absl::StrCat(folder, ": expected a folder with scenes"));
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::string HashOfFile(const std::string& path) {
  const auto text = ReadFileAtMost(path, std::numeric_limits<uint64_t>::max());
  if (!text.ok()) return "";
  return absl::StrCat(absl::Hex(XXH3_64bits(text->data(), text->size()), absl::kZeroPad16));
}

}  // namespace linetree
