// Acceptance limits for the paper's models as made by `palpate model`; their files come from the fixture in
// CMakeLists.txt.
#include <gtest/gtest.h>

#include "malloc_count.h"
#include "touch_cases.h"

using namespace touch;
using pruning::Handed;
using pruning::handed;

namespace {

double share(const std::set<int>& faces, const TriMesh& skin) {
  return static_cast<double>(faces.size()) / static_cast<double>(skin.faces.cols());
}

/// Faces passed on: all of the true patch, and at most twice its share plus 3 % of the skin, on each soft
/// skin and on both skins together (all of a tool is near where it touches).
void check(const Case& c) {
  Bodies bodies(c);
  ASSERT_EQ(bodies.a.size(), 60);
  proxy::Pruner pruner(bodies.a, bodies.b);
  for (const int phase : {0, kPhases / 2}) {
    SCOPED_TRACE(phase);
    bodies.update(phase);
    const Handed found = handed(pruner.query(c.gap));
    const Skins skins(c, phase);
    const auto true_a = true_patch(c.a.skin.faces, skins.a, c.b.skin.faces, skins.b),
               true_b = true_patch(c.b.skin.faces, skins.b, c.a.skin.faces, skins.a);
    ASSERT_FALSE(true_a.empty());
    EXPECT_FALSE(found.a_twice);
    EXPECT_TRUE(pruning::holds(found.a, true_a));
    EXPECT_TRUE(pruning::holds(found.b, true_b));
    EXPECT_LE(share(found.a, c.a.skin), 2 * share(true_a, c.a.skin) + 0.03);
    if (c.b_is_soft()) { EXPECT_LE(share(found.b, c.b.skin), 2 * share(true_b, c.b.skin) + 0.03); }
    const double all = static_cast<double>(c.a.skin.faces.cols() + c.b.skin.faces.cols());
    EXPECT_LE(static_cast<double>(found.a.size() + found.b.size()) / all,
              2 * static_cast<double>(true_a.size() + true_b.size()) / all + 0.03);
  }
  const auto& counts = pruner.counts();
  EXPECT_EQ(counts.pairs, 60L * bodies.b.size());
  EXPECT_LT(counts.after_boxes, 3 * counts.pairs / 5);
  EXPECT_LE(counts.after_hulls, counts.after_boxes);
  EXPECT_GT(counts.after_hulls, 0);
  EXPECT_LT(counts.patches_kept, counts.patches_tested);
}

/// The history of fitted proxies has no effect: a query after a long path equals one from a fresh start.
void check_history(const Case& c) {
  Bodies once(c), travelled(c);
  proxy::Pruner first(once.a, once.b), last(travelled.a, travelled.b);
  for (int i = 0; i < 2 * kPhases; ++i) {
    travelled.update(i % kPhases);
    last.query(c.gap);
  }
  once.update(3);
  travelled.update(3);
  const long before = last.counts().after_hulls;
  for (int p = 0; p < once.a.size(); ++p) {
    EXPECT_EQ(once.a.state(p).linear, travelled.a.state(p).linear);
    EXPECT_EQ(once.a.state(p).inflation, travelled.a.state(p).inflation);
  }
  EXPECT_EQ(first.query(c.gap).size(), last.query(c.gap).size());
  EXPECT_EQ(first.counts().after_hulls, last.counts().after_hulls - before);
}

void check_allocation(const Case& c) {
#if PALPATE_CAN_COUNT
  Bodies bodies(c);
  proxy::Pruner pruner(bodies.a, bodies.b);
  const auto cycle = [&] {
    for (int i = 0; i < kPhases; ++i) {
      bodies.update(i);
      pruner.query(c.gap);
    }
  };
  cycle();
  cycle();
  const long before = malloc_calls;
  cycle();
  EXPECT_EQ(malloc_calls - before, 0);
#endif
}

void check_all(const Case& c) {
  check(c);
  check_history(c);
  check_allocation(c);
}

}  // namespace

TEST(Touch, TwoPumpkins) { check_all(pumpkins(PALPATE_MODELS_FOLDER)); }
TEST(Touch, HeadBySphere) { check_all(head(PALPATE_MODELS_FOLDER)); }
TEST(Touch, HumanAtTheLeg) { check_all(human(PALPATE_MODELS_FOLDER)); }
