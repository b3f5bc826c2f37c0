#include "palpate/dynamics/system.h"

#include <gtest/gtest.h>

#include "dynamics/chain.h"

using namespace palpate;
using namespace palpate::dynamics;

/// Couples one pair of nodes that may change; counts the calls of add_pattern().
class Rolling final : public ForceTerm {
 public:
  std::string_view name() const override { return "rolling"; }
  TermTraits traits() const override { return {}; }
  void add_pattern(PatternBuilder& pattern) const override {
    pattern.add_pair(0, at);
    ++asked;
  }
  std::uint64_t pattern_version() const override { return version; }
  void add_force(const StateView&, VecX&) override {}
  void add_tangent(const StateView&, double, double, BorderedMatrix&) override {}
  void apply_tangent(const StateView&, double, double, const VecX&, VecX&) override {}
  int at = 2;
  std::uint64_t version = 0;
  mutable int asked = 0;
};

// Only the term whose pairs changed is queried again, and the pattern equals that of a System that never had
// the old pairs.
TEST(System, AsksForThePairsOfWhatChangedAlone) {
  Chain chain(8);
  const auto first = std::make_shared<Rolling>(), second = std::make_shared<Rolling>();
  chain.system.add(std::shared_ptr<ForceTerm>(first));
  chain.system.add(std::shared_ptr<ForceTerm>(second));
  second->at = 4;
  chain.system.add(std::make_shared<ChainMass>(chain.block, 8, 1.0, 0.0));
  chain.system.prepare(chain.state.view());
  BorderedMatrix A;
  chain.system.step_matrix(chain.state.view(), 1.0, 0.0, 1.0, A);
  for (int at = 5; at < 8; ++at) {
    second->at = at;
    ++second->version;
    chain.system.step_matrix(chain.state.view(), 1.0, 0.0, 1.0, A);
    PatternBuilder fresh(8);
    for (int i = 0; i + 1 < 8; ++i) fresh.add_pair(i, i + 1);
    fresh.add_pair(0, 2);
    fresh.add_pair(0, at);
    EXPECT_EQ(A.body.columns(), fresh.build().columns()) << at;
    EXPECT_EQ(A.body.row_start(), fresh.build().row_start()) << at;
  }
  EXPECT_EQ(first->asked, 1);
  EXPECT_EQ(second->asked, 4);
}
