// Camera paths: whatever is written, it is cameras or an error.
#include "core/io/camera_path.h"
#include "core/math/check.h"
#include "tests/fuzz/fuzz.h"

namespace linetree::fuzz {

std::vector<std::string> Seeds() { return SeedFiles("scenes/paths", ".textproto"); }

}  // namespace linetree::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  const auto path = linetree::ParseCameraPath(text, "fuzz");
  if (!path.ok()) return 0;
  const auto cameras = linetree::SampleCameraPath(*path, 7);
  if (!cameras.ok()) return 0;
  for (const auto& camera : *cameras) LT_CHECK(linetree::ValidateCamera(camera).ok());
  return 0;
}
