#include "report/html/html.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace axisfit {
namespace {

TEST(Html, EscapesWhatWouldBeMarkup) {
  EXPECT_EQ(escaped("a < b & c > \"d\" 'e'"), "a &lt; b &amp; c &gt; &quot;d&quot; &#39;e&#39;");
  EXPECT_EQ(escaped("&lt;"), "&amp;lt;");
  EXPECT_EQ(escaped("10 µm"), "10 µm");
}

TEST(Html, TakesTextsAsTextAndMarkupAsMarkup) {
  const Html bold = html("<b>{}</b>", std::string("x < y"));
  EXPECT_EQ(bold.text(), "<b>x &lt; y</b>");
  EXPECT_EQ(html("<p>{}: {}</p>", "a & b", bold).text(), "<p>a &amp; b: <b>x &lt; y</b></p>");
  EXPECT_EQ(Html::raw("<br>").text(), "<br>");
}

TEST(Html, FormatsNumbers) {
  EXPECT_EQ(html("{:.2f} {} {:>4}", 1.005, -3, 7u).text(), "1.00 -3    7");
}

TEST(Html, JoinsPieces) {
  EXPECT_TRUE(Html().empty());
  const std::vector<std::string> names{"a", "<b>"};
  const Html all = each(names, [](const std::string& name) { return html("<i>{}</i>", name); });
  EXPECT_EQ((all + Html::raw("!")).text(), "<i>a</i><i>&lt;b&gt;</i>!");
  EXPECT_TRUE(each(std::vector<int>(), [](int i) { return html("{}", i); }).empty());
}

}  // namespace
}  // namespace axisfit
