#include "core/io/read_file.h"

#include <filesystem>
#include <fstream>

#include "absl/strings/str_cat.h"

namespace linetree {

absl::StatusOr<std::string> ReadFileAtMost(const std::string& path, uint64_t max_bytes) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    return absl::NotFoundError(absl::StrCat(path, ": no such file"));
  }
  if (std::filesystem::is_directory(path, error)) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": expected a file, got a directory"));
  }
  std::ifstream file(path, std::ios::binary);
  // One block more than allowed tells a file that is too long, also where its size is not known
  // beforehand (a pipe).
  std::string text;
  char block[1 << 16];
  while (file && text.size() <= max_bytes) {
    file.read(block, sizeof(block));
    text.append(block, static_cast<size_t>(file.gcount()));
  }
  if (text.size() > max_bytes) {
    return absl::ResourceExhaustedError(
        absl::StrCat(path, ": expected at most ", max_bytes, " bytes"));
  }
  if (!file.eof()) return absl::UnavailableError(absl::StrCat(path, ": cannot be read"));
  return text;
}

}  // namespace linetree
