#include "client/command/parse_values.h"

#include <cmath>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"

namespace linetree {

absl::StatusOr<std::vector<double>> ParseNumbers(const std::string& text) {
  std::vector<double> numbers;
  for (absl::string_view part : absl::StrSplit(text, ',')) {
    double number = 0;
    if (!absl::SimpleAtod(part, &number) || !std::isfinite(number)) {
      return absl::InvalidArgumentError(
          absl::StrCat("expected finite numbers with commas between them, found '", text, "'"));
    }
    numbers.push_back(number);
  }
  return numbers;
}

absl::StatusOr<Vec3d> ParseVec3(const std::string& text) {
  const absl::StatusOr<std::vector<double>> numbers = ParseNumbers(text);
  if (!numbers.ok() || numbers->size() != 3) {
    return absl::InvalidArgumentError(
        absl::StrCat("expected three finite numbers x,y,z, found '", text, "'"));
  }
  return Vec3d{(*numbers)[0], (*numbers)[1], (*numbers)[2]};
}

absl::StatusOr<std::string> NumberedName(const std::string& pattern, int index) {
  const auto format = absl::ParsedFormat<'d'>::New(pattern);
  if (format == nullptr) {
    return absl::InvalidArgumentError(absl::StrCat(
        "expected a name with one %d for the number of the frame, such as frame_%04d.png, found '",
        pattern, "'"));
  }
  return absl::StrFormat(*format, index);
}

}  // namespace linetree
