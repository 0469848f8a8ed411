#include "core/io/html_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace linetree {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(HtmlPage, TextIsEscapedAndPicturesAreNot) {
  HtmlPage page("a < b");
  page.Heading("\"Times\" & more", "it's");
  page.Paragraph("x > y");
  page.Verbatim("1 <\n 2");
  page.Table({"<t>"}, {{"a&b"}, {"<c>"}});
  page.Figure("<svg/>", "as <seen>");
  const std::string html = page.ToString();
  for (const char* part :
       {"<title>a &lt; b</title>", "<h1>a &lt; b</h1>",
        "<h2 id=\"it&#39;s\">&quot;Times&quot; &amp; more</h2>", "<p>x &gt; y</p>",
        "<pre>1 &lt;\n 2</pre>", "<th>&lt;t&gt;</th>", "<td>a&amp;b</td>", "<td>&lt;c&gt;</td>",
        "<figure>\n<svg/><figcaption>as &lt;seen&gt;</figcaption>"}) {
    EXPECT_THAT(html, HasSubstr(part));
  }
  // Nothing comes from elsewhere.
  EXPECT_THAT(html, Not(HasSubstr("href")));
  EXPECT_THAT(html, Not(HasSubstr("src=")));
}

}  // namespace
}  // namespace linetree
