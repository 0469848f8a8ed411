#include "core/io/nff_source.h"

#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"

namespace linetree {
namespace {

class NffSource : public SceneSource {
 public:
  NffSource(v1::Scene message, NffPositions positions, std::string file)
      : message_(std::move(message)), positions_(std::move(positions)), file_(std::move(file)) {}

  const v1::Scene& message() const override { return message_; }

  std::string Where(std::string_view path) const override {
    const absl::string_view field_path(path.data(), path.size());
    const size_t bracket = field_path.find('[');
    if (bracket == absl::string_view::npos) return file_;
    const auto found = positions_.find(field_path.substr(0, bracket));
    const auto digits = field_path.substr(bracket + 1, field_path.find(']') - bracket - 1);
    size_t index = 0;
    if (found == positions_.end() || !absl::SimpleAtoi(digits, &index) ||
        index >= found->second.size()) {
      return file_;
    }
    const TextPosition& position = found->second[index];
    return absl::StrCat(file_, ":", position.line, ":", position.column);
  }

 private:
  v1::Scene message_;
  NffPositions positions_;
  std::string file_;
};

}  // namespace

std::unique_ptr<SceneSource> MakeNffSource(v1::Scene message, NffPositions positions,
                                           std::string file_name) {
  return std::make_unique<NffSource>(std::move(message), std::move(positions),
                                     std::move(file_name));
}

}  // namespace linetree
