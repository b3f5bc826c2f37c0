#include "session/missing_outputs.h"

#include <gtest/gtest.h>

using namespace palpate;

TEST(MissingOutputs, NameTheOutputAndTheFirstLineOfTheReason) {
  session::MissingOutputs missing;
  EXPECT_TRUE(missing.empty());
  missing.add("picture out/picture.png", "no context\nEGL 1.5");
  session::MissingOutputs more;
  more.add("movie a.webm", "the disk is full");
  missing.add(more);
  EXPECT_EQ(missing.outputs(), (std::vector<std::string>{"picture out/picture.png (no context)",
                                                         "movie a.webm (the disk is full)"}));
}

TEST(MissingOutputs, FiguresOfAPageAreGroupedByReason) {
  report::RunReport page;
  page.page = "out/report.html";
  page.missing_figures = {{"force", "no ffmpeg"}, {"energy", "no ffmpeg"}, {"bodies", "too large"}};
  session::MissingOutputs missing;
  missing.add(page);
  EXPECT_EQ(missing.outputs(),
            (std::vector<std::string>{"2 figures in out/report.html (no ffmpeg)",
                                      "figure \"bodies\" in out/report.html (too large)"}));
}
