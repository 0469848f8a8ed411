#include "client/command/ray_text.h"

#include <array>
#include <optional>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"
#include "core/io/layer_colors.h"
#include "core/io/stats_json.h"

namespace linetree {
namespace {

std::string SourceName(Source source) {
  return std::string(SourceLegend()[static_cast<size_t>(source)].label);
}

// Absent for anything but six finite numbers and a direction other than zero.
std::optional<Ray> ParseRay(const std::string& line) {
  const std::vector<absl::string_view> words =
      absl::StrSplit(line, absl::ByAnyChar(" \t\r"), absl::SkipEmpty());
  std::array<double, 6> v{};
  if (words.size() != v.size()) return std::nullopt;
  for (size_t i = 0; i < v.size(); ++i) {
    if (!absl::SimpleAtod(words[i], &v[i])) return std::nullopt;
  }
  const Ray ray{{v[0], v[1], v[2]}, {v[3], v[4], v[5]}};
  const bool good = IsFinite(ray.origin) && IsFinite(ray.direction) && ray.direction != Vec3d{};
  return good ? std::optional(ray) : std::nullopt;
}

}  // namespace

RayReader::RayReader(std::istream& in, std::string name) : in_(in), name_(std::move(name)) {}

absl::StatusOr<std::vector<Ray>> RayReader::Next(size_t count) {
  std::vector<Ray> rays;
  std::string line;
  while (rays.size() < count && std::getline(in_, line)) {
    ++line_;
    const size_t first = line.find_first_not_of(" \t\r");
    if (first == std::string::npos || line[first] == '#') continue;
    const std::optional<Ray> ray = ParseRay(line);
    if (!ray) {
      return absl::InvalidArgumentError(absl::StrCat(
          name_, ":", line_,
          ": expected six finite numbers 'ox oy oz dx dy dz' and a direction other than "
          "zero, found '",
          line.substr(0, 80), "'"));
    }
    rays.push_back(*ray);
  }
  if (in_.bad()) return absl::DataLossError(absl::StrCat(name_, ": cannot be read"));
  return rays;
}

std::string RayAnswerLine(const RayAnswer& answer) {
  const Rgb& rgb = answer.radiance;
  return absl::StrFormat("%.9g %.9g %.9g %s %d %.9g\n", rgb.r, rgb.g, rgb.b,
                         SourceName(answer.source), answer.object, answer.depth);
}

nlohmann::json RayAnswerJson(const RayAnswer& answer) {
  const Rgb& rgb = answer.radiance;
  return {{"radiance", {JsonNumber(rgb.r), JsonNumber(rgb.g), JsonNumber(rgb.b)}},
          {"source", SourceName(answer.source)},
          {"verdict", std::string(VerdictName(answer.verdict))},
          {"object", answer.object},
          {"depth", JsonNumber(answer.depth)}};
}

}  // namespace linetree
