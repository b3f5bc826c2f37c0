#include "corpus.h"

namespace {

TEST(Corpus, QuickOnesEndAsExpected) {
  const broken::Share share = broken::make_all([](const broken::Entry& e) { return e.quick; });
  EXPECT_GE(share.all, 40);
  EXPECT_GE(share.models, 0.7 * share.all);
}

}  // namespace
