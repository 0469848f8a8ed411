// Scene text: whatever is written, it is a scene or an error.
#include "core/io/load_scene.h"
#include "tests/fuzz/small_limits.h"

namespace linetree::fuzz {

std::vector<std::string> Seeds() { return SeedFiles("scenes", ".textproto"); }

}  // namespace linetree::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto source = linetree::ParseSceneText(text, "fuzz", linetree::fuzz::SmallScenes());
  linetree::fuzz::BuildAndLook(source);
  return 0;
}
