#include "client/command/table.h"

#include <gtest/gtest.h>

namespace linetree {
namespace {

TEST(Table, ColumnsAreAsWideAsTheirWidestCell) {
  Table table({{"name"}, {"n", Align::kRight}, {"end"}});
  table.AddRow({"a", "1", "x"});
  table.AddRow({"longest", "12345", ""});
  EXPECT_EQ(table.ToString(),
            "name         n  end\n"
            "a            1  x\n"
            "longest  12345\n");
}

TEST(Table, LinesCanBePrintedOneByOne) {
  const Table table({{"a", Align::kRight, 4}, {"b"}});
  EXPECT_EQ(table.TitleLine(), "   a  b\n");
  EXPECT_EQ(table.RowLine({"12", "x"}), "  12  x\n");
  EXPECT_EQ(table.RowLine({"123456", "x"}), "123456  x\n");
}

TEST(Table, WidthIsInCharactersNotBytes) {
  Table table({{"ε"}, {"b"}});
  table.AddRow({"x", "y"});
  EXPECT_EQ(table.ToString(), "ε  b\nx  y\n");
}

TEST(Table, Numbers) {
  EXPECT_EQ(Grouped(0), "0");
  EXPECT_EQ(Grouped(999), "999");
  EXPECT_EQ(Grouped(1000), "1,000");
  EXPECT_EQ(Grouped(1234567), "1,234,567");
  EXPECT_EQ(Percent(0.8125), "81.2 %");
  EXPECT_EQ(Bytes(512), "512 B");
  EXPECT_EQ(Bytes(1536), "1.5 KiB");
  EXPECT_EQ(Bytes(uint64_t{3} << 30), "3.0 GiB");
}

}  // namespace
}  // namespace linetree
