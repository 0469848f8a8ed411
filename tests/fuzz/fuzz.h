// What a fuzz target defines. By g++ it is linked with driver.cpp, which mutates the seeds; by
// clang with libFuzzer, which libfuzzer.cpp gives them (see CMakeLists.txt).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

// Must return 0 whatever the bytes are; sanitizers and LT_CHECK say what is wrong.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);

namespace linetree::fuzz {

// Inputs that get far, to start from.
std::vector<std::string> Seeds();

// Files of the source tree that end so, up to 16 KiB each.
std::vector<std::string> SeedFiles(const std::string& folder, const std::string& extension);

}  // namespace linetree::fuzz
