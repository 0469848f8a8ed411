// With clang: libFuzzer looks for new ways by itself. What it finds goes to a folder of its own,
// where the next run goes on; an input that ends the process is left as crash-... in the working
// folder.
//
//   LINETREE_FUZZ_SECONDS  how long to look, in place of the runs of the command line
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/fuzz/fuzz.h"

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  // libFuzzer reads the arguments after this, until the process ends.
  static std::vector<std::string> arguments(*argv, *argv + *argc);
  static std::vector<char*> pointers;
  const std::string corpus = "corpus-" + std::filesystem::path(arguments[0]).filename().string();
  std::filesystem::create_directories(corpus);
  const std::vector<std::string> seeds = linetree::fuzz::Seeds();
  for (size_t i = 0; i < seeds.size(); ++i) {
    std::ofstream(corpus + "/seed-" + std::to_string(i), std::ios::binary) << seeds[i];
  }
  if (const char* seconds = std::getenv("LINETREE_FUZZ_SECONDS")) {
    arguments.insert(arguments.end(), {"-runs=-1", std::string("-max_total_time=") + seconds});
  }
  arguments.insert(arguments.end(), {"-max_len=65536", "-print_final_stats=1", corpus});
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  *argc = static_cast<int>(arguments.size());
  *argv = pointers.data();
  return 0;
}
