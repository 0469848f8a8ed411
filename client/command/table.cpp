#include "client/command/table.h"

#include <algorithm>
#include <array>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/math/check.h"

namespace linetree {
namespace {

// Characters, not bytes: UTF-8 continuation bytes take no room.
size_t WidthOf(const std::string& text) {
  return static_cast<size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0) != 0x80;
  }));
}

std::string Line(const std::vector<TableColumn>& columns, const std::vector<std::string>& cells) {
  LT_CHECK(cells.size() == columns.size());
  std::string line;
  for (size_t i = 0; i < cells.size(); ++i) {
    const size_t width = WidthOf(cells[i]);
    const std::string pad(columns[i].width > width ? columns[i].width - width : 0, ' ');
    if (i > 0) line += "  ";
    line += columns[i].align == Align::kLeft ? cells[i] + pad : pad + cells[i];
  }
  line.erase(line.find_last_not_of(' ') + 1);
  return line + "\n";
}

std::vector<std::string> Titles(const std::vector<TableColumn>& columns) {
  std::vector<std::string> titles;
  for (const TableColumn& column : columns) titles.push_back(column.title);
  return titles;
}

}  // namespace

Table::Table(std::vector<TableColumn> columns) : columns_(std::move(columns)) {
  for (TableColumn& column : columns_) {
    column.width = std::max(column.width, WidthOf(column.title));
  }
}

void Table::AddRow(std::vector<std::string> cells) {
  LT_CHECK(cells.size() == columns_.size());
  rows_.push_back(std::move(cells));
}

std::string Table::ToString() const {
  std::vector<TableColumn> columns = columns_;
  for (const auto& row : rows_) {
    for (size_t i = 0; i < row.size(); ++i) {
      columns[i].width = std::max(columns[i].width, WidthOf(row[i]));
    }
  }
  std::string text = Line(columns, Titles(columns));
  for (const auto& row : rows_) text += Line(columns, row);
  return text;
}

std::string Table::TitleLine() const { return Line(columns_, Titles(columns_)); }

std::string Table::RowLine(const std::vector<std::string>& cells) const {
  return Line(columns_, cells);
}

std::string TextTable(const std::vector<std::string>& titles,
                      const std::vector<std::vector<std::string>>& rows, size_t names) {
  std::vector<TableColumn> columns;
  for (const std::string& title : titles) {
    columns.push_back({title, columns.size() < names ? Align::kLeft : Align::kRight});
  }
  Table table(std::move(columns));
  for (const auto& row : rows) table.AddRow(row);
  return table.ToString();
}

std::string Grouped(uint64_t number) {
  std::string digits = absl::StrCat(number);
  for (size_t at = digits.size(); at > 3; at -= 3) digits.insert(at - 3, ",");
  return digits;
}

std::string Percent(double share) { return absl::StrFormat("%.1f %%", 100 * share); }

std::string Bytes(uint64_t bytes) {
  constexpr std::array<const char*, 5> kUnits = {"B", "KiB", "MiB", "GiB", "TiB"};
  if (bytes < 1024) return absl::StrCat(bytes, " B");
  double value = static_cast<double>(bytes);
  size_t unit = 0;
  while (value >= 1024 && unit + 1 < kUnits.size()) {
    value /= 1024;
    ++unit;
  }
  return absl::StrFormat("%.1f %s", value, kUnits[unit]);
}

}  // namespace linetree
