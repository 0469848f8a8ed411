// Rays and their answers as text, for `linetree rays`.
#pragma once

#include <istream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/render/scene_host.h"

namespace linetree {

// Reads rays a block at a time: lines "ox oy oz dx dy dz", six finite numbers separated by blanks.
// Empty lines and lines that start with # are skipped.
class RayReader {
 public:
  // `name` stands in errors; the stream must outlive the reader.
  RayReader(std::istream& in, std::string name);

  // The next rays, at most `count`; none at the end. INVALID_ARGUMENT "name:line: …" for anything
  // else.
  absl::StatusOr<std::vector<Ray>> Next(size_t count);

 private:
  std::istream& in_;
  const std::string name_;
  uint64_t line_ = 0;
};

// "r g b source object depth\n": enough digits to read the float back, -1 for no object, inf for no
// depth.
std::string RayAnswerLine(const RayAnswer& answer);

nlohmann::json RayAnswerJson(const RayAnswer& answer);

}  // namespace linetree
