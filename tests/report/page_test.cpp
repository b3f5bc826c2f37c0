#include "report/page.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "palpate/core/error.h"
#include "temporary_folder.h"
#include "well_formed.h"

using namespace palpate;

namespace {

constexpr const char* kNasty = "<script>alert(\"x\")</script> & 'y'";
constexpr const char* kNastyEscaped = "&lt;script&gt;alert(&quot;x&quot;)&lt;/script&gt; &amp; &#39;y&#39;";

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + what.size())) ++n;
  return n;
}

}  // namespace

TEST(Page, EscapesEverythingThatIsGiven) {
  report::Page page(kNasty);
  page.add_heading(kNasty)
      .add_paragraph(kNasty)
      .add_table({kNasty}, {{kNasty}}, kNasty)
      .add_facts({{kNasty, kNasty}})
      .add_fact_groups({{kNasty, {{kNasty, kNasty}}}})
      .add_code(kNasty);
  const std::string html = page.html();
  EXPECT_EQ(html.find(kNasty), std::string::npos);
  // the title twice; heading, paragraph; header, its region's label, cell, caption; name, value; group, name,
  // value; code
  EXPECT_EQ(count(html, kNastyEscaped), 14u);
  EXPECT_EQ(well_formed_problem(html), "");
}

TEST(Page, ReplacesControlCharacters) {
  EXPECT_EQ(report::escape_html(std::string("a\x01") + "b\n"),
            "a\xEF\xBF\xBD"
            "b\n");
}

TEST(Page, SetsColumnsOfNumbersToTheRight) {
  report::Page page("t");
  page.add_table({"name", "value"}, {{"a", "1.5"}, {"b", "-"}});
  EXPECT_NE(page.html().find("<td>a</td><td class=\"n\">1.5</td>"), std::string::npos);
}

TEST(Page, SaysWhereTheValuesOfAChartAreAndKeepsItsNumbersInside) {
  report::Page page("t");
  page.add_chart("{\"title\": \"</script><b> & c\"}", "values <of>.csv", kNasty);
  const std::string html = page.html();
  EXPECT_EQ(well_formed_problem(html), "");
  EXPECT_NE(html.find("This chart needs JavaScript. Its values are in values &lt;of&gt;.csv."),
            std::string::npos);
  EXPECT_EQ(count(html, kNastyEscaped), 1u) << "the caption";
  EXPECT_NE(html.find("{\"title\": \"\\u003c/script>\\u003cb> \\u0026 c\"}"), std::string::npos)
      << "no text ends the element that contains the numbers";
}

TEST(Page, EmbedsAPngAndRefusesWhatIsNone) {
  const TemporaryFolder folder;
  const auto png = folder / "tiny.png";
  std::ofstream(png, std::ios::binary) << "\x89PNG\r\n\x1a\n";
  report::Page page("t");
  page.add_png(png, "a picture");
  // RFC 4648 of 89 50 4e 47 0d 0a 1a 0a
  EXPECT_NE(page.html().find("src=\"data:image/png;base64,iVBORw0KGgo=\""), std::string::npos);
  std::ofstream(png, std::ios::binary) << "GIF89a";
  EXPECT_THROW(page.add_png(png, ""), Error);
  EXPECT_THROW(page.add_png("/nowhere.png", ""), Error);
}

TEST(Page, SaysWhereItCannotBeWritten) {
  const TemporaryFolder folder;
  const auto path = folder / "page.html";
  report::write(report::Page("t"), path);
  EXPECT_TRUE(std::filesystem::exists(path));
  try {
    report::write(report::Page("t"), "/nowhere/page.html");
    FAIL() << "a folder that is not there was written to";
  } catch (const Error& e) { EXPECT_NE(std::string(e.what()).find("/nowhere/page.html"), std::string::npos); }
}
