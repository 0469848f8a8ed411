// The native format: Protobuf text of linetree.v1.Scene.
#include <google/protobuf/text_format.h>

#include <utility>

#include "absl/strings/str_cat.h"
#include "core/io/load_scene.h"
#include "core/io/proto_text.h"
#include "core/math/check.h"

namespace linetree {
namespace {

class TextSource : public SceneSource {
 public:
  TextSource(std::string text, std::string file) : text_(std::move(text)), file_(std::move(file)) {}

  absl::Status Parse() { return ParseProtoText(text_, file_, &message_); }
  const v1::Scene& message() const override { return message_; }
  std::string Where(std::string_view field_path) const override {
    return WhereInProtoText(text_, file_, v1::Scene::default_instance(), field_path);
  }

 private:
  std::string text_;
  std::string file_;
  v1::Scene message_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<SceneSource>> ParseSceneText(std::string_view text,
                                                            const std::string& file_name,
                                                            const SceneLimits& limits) {
  if (text.size() > limits.max_file_bytes) {
    return absl::ResourceExhaustedError(absl::StrCat(
        file_name, ": expected at most ", limits.max_file_bytes, " bytes, got ", text.size()));
  }
  auto source = std::make_unique<TextSource>(std::string(text), file_name);
  if (auto s = source->Parse(); !s.ok()) return s;
  return source;
}

std::string WriteSceneText(const v1::Scene& message) {
  std::string text;
  LT_CHECK(google::protobuf::TextFormat::PrintToString(message, &text));
  return text;
}

}  // namespace linetree
