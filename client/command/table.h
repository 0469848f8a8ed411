// Text tables with aligned columns.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace linetree {

enum class Align { kLeft, kRight };

struct TableColumn {
  std::string title{};
  Align align = Align::kLeft;
  // Width in characters at least; rows that are printed before all are known need it.
  size_t width = 0;
};

class Table {
 public:
  explicit Table(std::vector<TableColumn> columns);

  // As many cells as there are columns.
  void AddRow(std::vector<std::string> cells);

  // Titles and rows, each a line; columns as wide as their widest cell.
  std::string ToString() const;

  // One line at a time, aligned by the columns' own widths.
  std::string TitleLine() const;
  std::string RowLine(const std::vector<std::string>& cells) const;

 private:
  std::vector<TableColumn> columns_;
  std::vector<std::vector<std::string>> rows_;
};

// All at once; the first columns are aligned to the left, as many as `names`, the others to the
// right.
std::string TextTable(const std::vector<std::string>& titles,
                      const std::vector<std::vector<std::string>>& rows, size_t names = 1);

// 12345678 as "12,345,678".
std::string Grouped(uint64_t number);
// A share in [0, 1] as "81.2 %".
std::string Percent(double share);
// Bytes as "1.5 MiB".
std::string Bytes(uint64_t bytes);

}  // namespace linetree
