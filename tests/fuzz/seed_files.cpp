#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/fuzz/fuzz.h"

namespace linetree::fuzz {

namespace {
constexpr uintmax_t kMaxSeedBytes = 16 << 10;
}  // namespace

std::vector<std::string> SeedFiles(const std::string& folder, const std::string& extension) {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::string(LINETREE_SOURCE_DIR) + "/" + folder)) {
    if (entry.path().extension() == extension && entry.file_size() <= kMaxSeedBytes) {
      paths.push_back(entry.path());
    }
  }
  // So that the same seed of the random numbers gives the same inputs everywhere.
  std::sort(paths.begin(), paths.end());
  std::vector<std::string> seeds;
  for (const auto& path : paths) {
    std::ifstream file(path, std::ios::binary);
    seeds.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  return seeds;
}

}  // namespace linetree::fuzz
