// Runs a fuzz target on its seeds and on mutations of them: the same inputs for the same flags.
//
//   TARGET [-runs=N] [-seed=S] [-write_seeds=FOLDER] [FILE...]
//
// With files it runs on these and nothing else. An input that ends the process is left in
// ./crash-input.
#include <csignal>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "tests/fuzz/fuzz.h"

extern "C" void __sanitizer_set_death_callback(void (*callback)()) __attribute__((weak));

namespace linetree::fuzz {
namespace {

constexpr size_t kMaxInputBytes = 64 << 10;

std::string input;

void KeepInput() {
  std::ofstream("crash-input", std::ios::binary) << input;
  std::fprintf(stderr, "the input is in ./crash-input: %zu bytes\n", input.size());
}

// Words at which parsers and checks turn.
constexpr std::string_view kWords[] = {"nan",     "inf",      "-1",         "0",
                                       "1e308",   "1e-320",   "4294967296", "-9223372036854775808",
                                       "\"",      "{",        "}",          "[",
                                       "]",       ":",        "#",          "\n",
                                       "\\",      "\xff",     "<",          "true",
                                       "\0z",     "1.",       "0x7f",       "'",
                                       "objects", "vertices", "material"};

class Mutator {
 public:
  Mutator(std::vector<std::string> seeds, uint64_t seed)
      : seeds_(std::move(seeds)), random_(seed) {}

  std::string Next() {
    std::string text = Seed();
    const size_t changes = 1 + Below(4);
    for (size_t i = 0; i < changes; ++i) Change(text);
    text.resize(std::min(text.size(), kMaxInputBytes));
    return text;
  }

 private:
  size_t Below(size_t bound) {
    return std::uniform_int_distribution<size_t>(0, bound - 1)(random_);
  }
  const std::string& Seed() { return seeds_[Below(seeds_.size())]; }

  void Change(std::string& text) {
    const size_t at = Below(text.size() + 1);
    const size_t length = std::min(text.size() - at, 1 + Below(Below(2) == 0 ? 8 : 400));
    switch (Below(7)) {
      case 0:
        if (at < text.size()) text[at] = static_cast<char>(text[at] ^ (1 << Below(8)));
        break;
      case 1:
        text.erase(at, length);
        break;
      case 2:
        text.insert(at, text.substr(at, length));
        break;
      case 3:
        text.replace(at, length, kWords[Below(std::size(kWords))]);
        break;
      case 4:
        text.insert(at, kWords[Below(std::size(kWords))]);
        break;
      case 5: {
        const std::string& other = Seed();
        text.insert(at, other, Below(other.size() + 1), 1 + Below(400));
        break;
      }
      case 6:
        text.resize(at);
        break;
    }
  }

  const std::vector<std::string> seeds_;
  std::mt19937_64 random_;
};

void Run(std::string bytes) {
  input = std::move(bytes);
  LLVMFuzzerTestOneInput(reinterpret_cast<const uint8_t*>(input.data()), input.size());
}

struct Flags {
  uint64_t runs = 1000;
  uint64_t seed = 1;
  std::string write_seeds{};
  std::vector<std::string> files{};
};

Flags Parse(int argc, char** argv) {
  Flags flags;
  for (const std::string& argument : std::vector<std::string>(argv + 1, argv + argc)) {
    const std::string value = argument.substr(argument.find('=') + 1);
    if (argument.starts_with("-runs=")) {
      flags.runs = std::stoull(value);
    } else if (argument.starts_with("-seed=")) {
      flags.seed = std::stoull(value);
    } else if (argument.starts_with("-write_seeds=")) {
      flags.write_seeds = value;
    } else {
      flags.files.push_back(argument);
    }
  }
  return flags;
}

int Main(const Flags& flags) {
  for (const std::string& name : flags.files) {
    std::ifstream file(name, std::ios::binary);
    Run({std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()});
  }
  if (!flags.files.empty()) return 0;
  const std::vector<std::string> seeds = Seeds();
  for (size_t i = 0; i < seeds.size() && !flags.write_seeds.empty(); ++i) {
    std::ofstream(flags.write_seeds + "/seed-" + std::to_string(i), std::ios::binary) << seeds[i];
  }
  for (const std::string& seed : seeds) Run(seed);
  Mutator mutator(seeds, flags.seed);
  for (uint64_t run = 0; run < flags.runs; ++run) Run(mutator.Next());
  std::printf("%zu seeds and %llu mutations, seed %llu\n", seeds.size(),
              static_cast<unsigned long long>(flags.runs),
              static_cast<unsigned long long>(flags.seed));
  return seeds.empty() ? 1 : 0;
}

}  // namespace
}  // namespace linetree::fuzz

int main(int argc, char** argv) {
  if (__sanitizer_set_death_callback != nullptr) {
    __sanitizer_set_death_callback(linetree::fuzz::KeepInput);
  }
  std::signal(SIGABRT, [](int) { linetree::fuzz::KeepInput(); });
  return linetree::fuzz::Main(linetree::fuzz::Parse(argc, argv));
}
