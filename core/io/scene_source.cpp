#include "core/io/scene_source.h"

#include <utility>

#include "absl/strings/str_cat.h"

namespace linetree {
namespace {

class MessageSource : public SceneSource {
 public:
  explicit MessageSource(v1::Scene message) : message_(std::move(message)) {}
  const v1::Scene& message() const override { return message_; }
  std::string Where(std::string_view) const override { return ""; }

 private:
  v1::Scene message_;
};

}  // namespace

std::unique_ptr<SceneSource> SceneFromMessage(v1::Scene message) {
  return std::make_unique<MessageSource>(std::move(message));
}

std::string FieldMessage(const SceneSource& source, absl::string_view field_path,
                         absl::string_view message) {
  const std::string where = source.Where({field_path.data(), field_path.size()});
  return absl::StrCat(where, where.empty() ? "" : ": ", field_path, ": ", message);
}

absl::Status FieldError(const SceneSource& source, absl::string_view field_path,
                        absl::string_view message) {
  return absl::InvalidArgumentError(FieldMessage(source, field_path, message));
}

absl::Status CheckLimit(const SceneSource& source, absl::string_view field_path, uint64_t count,
                        uint64_t limit) {
  if (count <= limit) return absl::OkStatus();
  return absl::ResourceExhaustedError(
      FieldMessage(source, field_path, absl::StrCat("expected at most ", limit, ", got ", count)));
}

absl::Status InField(const SceneSource& source, absl::string_view parent,
                     const absl::Status& status) {
  if (status.ok()) return status;
  const absl::string_view text = status.message();
  const size_t colon = text.find(": ");
  if (colon == absl::string_view::npos) return FieldError(source, parent, text);
  return FieldError(source, absl::StrCat(parent, ".", text.substr(0, colon)),
                    text.substr(colon + 2));
}

}  // namespace linetree
