#include "core/io/html_page.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"

namespace linetree {
namespace {

constexpr const char* kStyle =
    "body{font:15px/1.45 sans-serif;max-width:62em;margin:2em auto;padding:0 1em;color:#222}"
    "table{border-collapse:collapse;margin:1em 0}"
    "th,td{border:1px solid #ccc;padding:.25em .7em;text-align:right}"
    "th{background:#f2f2f2}td:first-child,th:first-child{text-align:left}"
    "figure{margin:1.5em 0}svg{max-width:100%;height:auto}"
    "figcaption{color:#555;font-size:.9em}pre{background:#f6f6f6;padding:.7em;overflow-x:auto}";

std::string Element(const char* name, const std::string& text) {
  return absl::StrCat("<", name, ">", EscapeXml(text), "</", name, ">");
}

std::string Row(const char* cell, const std::vector<std::string>& texts) {
  std::string row = "<tr>";
  for (const std::string& text : texts) absl::StrAppend(&row, Element(cell, text));
  return row + "</tr>\n";
}

}  // namespace

std::string EscapeXml(const std::string& text) {
  return absl::StrReplaceAll(
      text, {{"&", "&amp;"}, {"<", "&lt;"}, {">", "&gt;"}, {"\"", "&quot;"}, {"'", "&#39;"}});
}

void HtmlPage::Heading(const std::string& text, const std::string& id) {
  const std::string attribute = id.empty() ? "" : absl::StrCat(" id=\"", EscapeXml(id), "\"");
  absl::StrAppend(&body_, "<h2", attribute, ">", EscapeXml(text), "</h2>\n");
}

void HtmlPage::Paragraph(const std::string& text) {
  absl::StrAppend(&body_, Element("p", text), "\n");
}

void HtmlPage::Verbatim(const std::string& text) {
  absl::StrAppend(&body_, Element("pre", text), "\n");
}

void HtmlPage::Table(const std::vector<std::string>& titles,
                     const std::vector<std::vector<std::string>>& rows) {
  absl::StrAppend(&body_, "<table>\n", Row("th", titles));
  for (const std::vector<std::string>& row : rows) absl::StrAppend(&body_, Row("td", row));
  absl::StrAppend(&body_, "</table>\n");
}

void HtmlPage::Figure(const std::string& svg, const std::string& caption) {
  absl::StrAppend(&body_, "<figure>\n", svg, Element("figcaption", caption), "</figure>\n");
}

std::string HtmlPage::ToString() const {
  return absl::StrCat(
      "<!DOCTYPE html>\n<html xmlns=\"http://www.w3.org/1999/xhtml\" lang=\"en\"><head>"
      "<meta charset=\"utf-8\"/>",
      Element("title", title_), "<style>", kStyle, "</style></head><body>\n", Element("h1", title_),
      "\n", body_, "</body></html>\n");
}

}  // namespace linetree
