// One self-contained HTML page: text, tables and SVG pictures, well-formed as XML too.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace linetree {

// The five characters that XML reserves, as entities.
std::string EscapeXml(const std::string& text);

// What stands on the page comes in the order of the calls. All text is escaped here; `svg` must be
// a whole document of SvgPlots or its like.
class HtmlPage {
 public:
  explicit HtmlPage(std::string title) : title_(std::move(title)) {}

  // `id`, where not empty, is what links name.
  void Heading(const std::string& text, const std::string& id = "");
  void Paragraph(const std::string& text);
  // As it stands, in letters of one width.
  void Verbatim(const std::string& text);
  void Table(const std::vector<std::string>& titles,
             const std::vector<std::vector<std::string>>& rows);
  void Figure(const std::string& svg, const std::string& caption);

  std::string ToString() const;

 private:
  const std::string title_;
  std::string body_;
};

}  // namespace linetree
