#include "core/io/ppm.h"

#include <gtest/gtest.h>

namespace linetree {
namespace {

using std::string_literals::operator""s;

TEST(ParsePpm16, ReadsHeadersWithComments) {
  const auto picture =
      ParsePpm16("P6\n# by hand\n2 1\n65535\n"s + "\xff\xff\0\0\x80\0"s + "\0\1\0\0\0\2"s);
  ASSERT_TRUE(picture.ok()) << picture.status();
  EXPECT_EQ(picture->width, 2);
  EXPECT_EQ(picture->pixels[0], (Rgb{1, 0, 32768 / 65535.0}));
  EXPECT_EQ(picture->pixels[1], (Rgb{1 / 65535.0, 0, 2 / 65535.0}));
  EXPECT_FALSE(ParsePpm16("P6 2 1 255\n123456").ok());
  EXPECT_FALSE(ParsePpm16("P6 2 1 65535\n123456").ok());
  EXPECT_FALSE(ParsePpm16("P6 -2 -1 65535\n123456123456").ok());
  EXPECT_FALSE(ParsePpm16("P6 2 1 65535").ok());
  EXPECT_FALSE(ParsePpm16("").ok());
}

}  // namespace
}  // namespace linetree
