#include "core/io/proto_text.h"

#include <google/protobuf/io/tokenizer.h>
#include <google/protobuf/text_format.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "core/math/check.h"

namespace linetree {
namespace {

namespace pb = google::protobuf;
using Location = pb::TextFormat::ParseLocation;

// Protobuf counts lines and columns from 0.
std::string Place(const std::string& file, int line, int column) {
  return absl::StrCat(file, ":", line + 1, ":", column + 1);
}

// Keeps the first error; later ones are mostly its consequences.
class FirstError : public pb::io::ErrorCollector {
 public:
  explicit FirstError(const std::string& file) : file_(file) {}
  void AddError(int line, pb::io::ColumnNumber column, const std::string& message) override {
    if (!text_.empty()) return;
    text_ = absl::StrCat(line < 0 ? file_ : Place(file_, line, column), ": ", message);
  }
  const std::string& text() const { return text_; }

 private:
  std::string file_;
  std::string text_;
};

// One component of a field path: "vertices[3]" or "radius" (index -1).
struct Step {
  std::string name;
  int index = -1;
};

// Debian's abseil has a string_view of its own, which its functions take.
Step ParseStep(absl::string_view component) {
  const size_t bracket = component.find('[');
  Step step{std::string(component.substr(0, bracket))};
  if (bracket != absl::string_view::npos) {
    const auto digits = component.substr(bracket + 1, component.size() - bracket - 2);
    LT_CHECK(absl::SimpleAtoi(digits, &step.index));
  }
  return step;
}

std::optional<Location> Find(const pb::TextFormat::ParseInfoTree& root, const pb::Descriptor* type,
                             std::string_view path) {
  const pb::TextFormat::ParseInfoTree* tree = &root;
  std::optional<Location> found;
  for (absl::string_view component :
       absl::StrSplit(absl::string_view(path.data(), path.size()), '.')) {
    const Step step = ParseStep(component);
    const pb::FieldDescriptor* field = tree && type ? type->FindFieldByName(step.name) : nullptr;
    if (field == nullptr) break;
    // A repeated field as a whole stands where its first element does.
    const int index = field->is_repeated() ? std::max(step.index, 0) : -1;
    Location location = tree->GetLocation(field, index);
    // Numbers in a list in brackets have one position together.
    if (location.line < 0 && index > 0 && field->message_type() == nullptr) {
      location = tree->GetLocation(field, 0);
    }
    if (location.line >= 0) found = location;
    type = field->message_type();
    tree = type ? tree->GetTreeForNested(field, index) : nullptr;
  }
  return found;
}

}  // namespace

absl::Status ParseProtoText(const std::string& text, const std::string& file_name,
                            pb::Message* message) {
  FirstError error(file_name);
  pb::TextFormat::Parser parser;
  parser.RecordErrorsTo(&error);
  if (parser.ParseFromString(text, message)) return absl::OkStatus();
  return absl::InvalidArgumentError(
      error.text().empty()
          ? absl::StrCat(file_name, ": expected a ", message->GetDescriptor()->full_name())
          : error.text());
}

std::string WhereInProtoText(const std::string& text, const std::string& file_name,
                             const pb::Message& prototype, std::string_view field_path) {
  pb::TextFormat::ParseInfoTree tree;
  FirstError error(file_name);
  pb::TextFormat::Parser parser;
  parser.RecordErrorsTo(&error);
  parser.WriteLocationsTo(&tree);
  const std::unique_ptr<pb::Message> again(prototype.New());
  LT_CHECK(parser.ParseFromString(text, again.get()));
  const auto location = Find(tree, prototype.GetDescriptor(), field_path);
  return location ? Place(file_name, location->line, location->column) : file_name;
}

}  // namespace linetree
