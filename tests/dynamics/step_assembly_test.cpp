#include "palpate/dynamics/step_assembly.h"

#include <gtest/gtest.h>

#include "dynamics/chain.h"

using namespace palpate;
using namespace palpate::dynamics;

namespace {

/// Allocates a zero-row-sum matrix in the order of the pattern's upper triangle.
ZeroRowSumMatrix room_for(const BlockSparse& pattern) {
  ZeroRowSumMatrix A;
  A.pattern = &pattern;
  A.slot_map.assign(static_cast<std::size_t>(pattern.slot_count()), -1);
  int pairs = 0;
  for (int i = 0; i < pattern.block_rows(); ++i)
    for (int s = pattern.row_start()[static_cast<std::size_t>(i)];
         s < pattern.row_start()[static_cast<std::size_t>(i) + 1]; ++s) {
      const int j = pattern.columns()[static_cast<std::size_t>(s)];
      if (j > i)
        A.slot_map[static_cast<std::size_t>(s)] = A.slot_map[static_cast<std::size_t>(pattern.slot(j, i))] =
            pairs++;
    }
  A.values.assign(9 * static_cast<std::size_t>(pairs), 0.0f);
  A.slot_map_key = 1;
  return A;
}

}  // namespace

// The zero-row-sum matrix represents step_matrix: it has the same off-diagonal blocks, and its diagonal
// blocks are m minus the sum of the row's off-diagonal blocks. Held rows are stored separately.
TEST(StepAssembly, MakesTheStepOfTheSystem) {
  Chain c(5);
  c.system.add(std::make_shared<ChainMass>(c.block, 5, 2.0));
  c.system.add(std::make_shared<Held>(std::vector<int>{0, 2}, VecX::Zero(2), 0.0));
  c.system.prepare(c.state.view());
  const StateView at = c.state.view();
  StepAssembly assembly(c.system);
  ASSERT_TRUE(assembly.applies(at));
  ZeroRowSumMatrix A = room_for(c.system.pattern());
  const VecX shift = VecX::LinSpaced(15, -1.0, 2.0);
  VecX f, want, product = VecX::Zero(15);
  assembly.assemble(at, shift, 1.0, 0.1, 0.01, f, A);
  c.system.force(at, want);
  c.system.terms()[0]->apply_tangent(at, 1.0, 0.0, shift, product);
  EXPECT_LT((f - (want - product)).norm(), 1e-12 * want.norm());
  EXPECT_EQ(A.positions, at.q.data());
  ASSERT_EQ(A.held->size(), 1u);
  EXPECT_EQ((*A.held)[0].node, 0);
  EXPECT_EQ((*A.held)[0].axes, (std::array<bool, 3>{true, false, true}));
  EXPECT_EQ(std::exp2(std::round(std::log2(A.scale))), A.scale) << "a power of two";

  BorderedMatrix whole;
  c.system.step_matrix(at, 1.0, 0.1, 0.01, whole);
  const MatX dense = whole.to_dense();
  for (int i = 0; i < 5; ++i) {
    Mat3 own = A.diagonal.segment<3>(3 * i).asDiagonal();
    for (int s = c.system.pattern().row_start()[static_cast<std::size_t>(i)];
         s < c.system.pattern().row_start()[static_cast<std::size_t>(i) + 1]; ++s) {
      const int j = c.system.pattern().columns()[static_cast<std::size_t>(s)];
      if (j == i) continue;
      const Mat3 block =
          Eigen::Map<const Eigen::Matrix3f>(A.values.data() + 9 * A.slot_map[static_cast<std::size_t>(s)])
              .cast<double>() /
          A.scale;
      own -= block;
      if (i == 0 || j == 0) continue;
      EXPECT_LT((block - dense.block<3, 3>(3 * i, 3 * j)).norm(), 1e-7);
    }
    if (i > 0) { EXPECT_LT((own - dense.block<3, 3>(3 * i, 3 * i)).norm(), 1e-6) << "node " << i; }
  }
}

TEST(StepAssembly, AppliesOnlyWhereEveryTermTakesPart) {
  const auto applies = [](auto&& change) {
    Chain c(4);
    change(c);
    c.system.set_mass_solver(std::make_unique<DenseSolver>());
    c.system.prepare(c.state.view());
    return StepAssembly(c.system).applies(c.state.view());
  };
  const auto lumped = [](Chain& c) { c.system.add(std::make_shared<ChainMass>(c.block, 4, 2.0)); };
  EXPECT_TRUE(applies(lumped));
  EXPECT_FALSE(applies([](Chain& c) { c.system.add(std::make_shared<ChainMass>(c.block, 4, 2.0, 0.5)); }))
      << "a consistent mass";
  EXPECT_FALSE(applies([&](Chain& c) {
    lumped(c);
    c.system.add(std::make_shared<ChainSprings>(2, 1.0, false));
  })) << "a term that does not take part";
  EXPECT_FALSE(applies([&](Chain& c) {
    lumped(c);
    c.system.add(std::make_shared<ChainSprings>(2, 1.0));
  })) << "two terms on one pair of nodes";
}

// The step's residual equals the one computed from its matrix and right-hand side, and is zero along held
// directions.
TEST(StepAssembly, TheResidualIsThatOfTheMatrix) {
  Chain c(5);
  c.system.add(std::make_shared<ChainMass>(c.block, 5, 2.0));
  c.system.add(std::make_shared<Held>(std::vector<int>{0, 2}, VecX::Zero(2), 0.0));
  c.system.prepare(c.state.view());
  const StateView at = c.state.view();
  StepAssembly assembly(c.system);
  ASSERT_TRUE(assembly.applies(at));
  const double h = 0.1;
  const VecX shift = VecX::LinSpaced(15, -1.0, 2.0);
  VecX change = VecX::LinSpaced(15, 3.0, -1.0), want, product = VecX::Zero(15), r;
  change[0] = change[2] = 0.0;
  BorderedMatrix A;
  c.system.step_matrix(at, 1.0, h, h * h, A);
  c.system.force(at, want);
  c.system.terms()[0]->apply_tangent(at, 1.0, 0.0, shift, product);
  want = h * (want - product);
  A.multiply(change, product);
  want -= product;
  want[0] = want[2] = 0.0;
  assembly.residual(at, shift + h * change, change, h, r);
  EXPECT_LT((r - want).norm(), 1e-12 * want.norm());
  EXPECT_EQ(r[0], 0.0);
  EXPECT_EQ(r[2], 0.0);
}

// A term without the capability sends its steps to general assembly, unless its tangent is zero.
TEST(StepAssembly, FindsTheCapabilityOfATermThatIsAddedLater) {
  struct Load final : ForceTerm {
    explicit Load(bool is_zero) : zero(is_zero) {}
    std::string_view name() const override { return "load"; }
    TermTraits traits() const override { return {.zero_tangent = zero}; }
    void add_force(const StateView&, VecX& f) override { f.array() += 1.0; }
    void add_tangent(const StateView&, double, double, BorderedMatrix&) override {}
    void apply_tangent(const StateView&, double, double, const VecX&, VecX&) override {}
    bool zero;
  };
  for (const bool zero : {true, false}) {
    Chain c(4);
    c.system.add(std::make_shared<ChainMass>(c.block, 4, 2.0));
    c.system.prepare(c.state.view());
    StepAssembly assembly(c.system);
    ASSERT_TRUE(assembly.applies(c.state.view()));
    c.system.add(std::shared_ptr<ForceTerm>(std::make_shared<Load>(zero)));
    ASSERT_EQ(assembly.applies(c.state.view()), zero);
    if (!zero) continue;
    ZeroRowSumMatrix A = room_for(assembly.pattern());
    VecX f, want;
    assembly.assemble(c.state.view(), VecX::Zero(12), 1.0, 0.1, 0.01, f, A);
    c.system.force(c.state.view(), want);
    EXPECT_EQ(f, want);
  }
}

namespace {

/// A chain for which a step was kept, and a fresh one that never keeps a step.
struct KeptChain {
  Chain c{5}, fresh{5};
  VecX shift = VecX::LinSpaced(15, -1.0, 2.0);
  double d = 0.1, k = 0.01;
  ZeroRowSumMatrix A, B;
  VecX f, g;

  explicit KeptChain(std::uint64_t version = 7) {
    for (Chain* one : {&c, &fresh}) {
      one->system.add(std::make_shared<ChainMass>(one->block, 5, 2.0));
      one->system.prepare(one->state.view());
      springs_of(*one).drag = 3.0;
    }
    springs().version = version;
    A = room_for(c.system.updated_pattern(c.state.view()));
    B = room_for(fresh.system.updated_pattern(fresh.state.view()));
    assemble(true);
  }
  static ChainSprings& springs_of(Chain& c) { return dynamic_cast<ChainSprings&>(*c.system.terms()[0]); }
  ChainSprings& springs() { return springs_of(c); }
  void assemble(bool keep) {
    StepAssembly assembly(c.system);
    ASSERT_TRUE(assembly.applies(c.state.view()));
    assembly.assemble(c.state.view(), shift, 1.0, d, k, f, A, keep);
  }
  /// Returns whether the terms were evaluated again by another assembly into a matrix with other values. The
  /// result equals in any case that of a system that keeps nothing.
  bool asks_again() {
    const int before = springs().assembled;
    std::fill(A.values.begin(), A.values.end(), 77.0f);
    assemble(false);
    fresh.state.q() = c.state.q();
    fresh.state.u() = c.state.u();
    StepAssembly whole(fresh.system);
    EXPECT_TRUE(whole.applies(fresh.state.view()));
    whole.assemble(fresh.state.view(), shift, 1.0, d, k, g, B);
    EXPECT_LE((f - g).norm(), 1e-10 * g.norm());
    EXPECT_LE((A.diagonal - B.diagonal).norm(), 1e-10 * B.diagonal.norm());
    for (std::size_t i = 0; i < B.values.size(); ++i) EXPECT_NEAR(A.values[i], B.values[i], 1e-6f);
    return springs().assembled > before;
  }
};

}  // namespace

// A request for the kept step is served without evaluating the terms; any other request is assembled.
TEST(StepAssembly, TakesWhatWasKeptOfTheSameStepAlone) {
  const auto changed = [](auto&& change) {
    KeptChain chain;
    change(chain);
    return chain.asks_again();
  };
  EXPECT_FALSE(changed([](KeptChain&) {}));
  EXPECT_FALSE(changed([](KeptChain& k) { k.shift *= 1.0 + 1e-12; })) << "by the rounding of a time";
  EXPECT_FALSE(changed([](KeptChain& k) { k.d *= 1.0 - 1e-12; })) << "likewise";
  EXPECT_TRUE(changed([](KeptChain& k) { k.shift[4] += 1e-7; }));
  EXPECT_TRUE(changed([](KeptChain& k) { k.k *= 2.0; }));
  EXPECT_TRUE(changed([](KeptChain& k) { k.d *= 2.0; }));
  EXPECT_TRUE(changed([](KeptChain& k) { k.c.state.q()[7] += 1e-13; })) << "a state that has moved";
  EXPECT_TRUE(changed([](KeptChain& k) { k.c.state.u()[7] += 1e-13; }));
  EXPECT_TRUE(changed([](KeptChain& k) { ++k.springs().version; })) << "another material";
  EXPECT_TRUE(changed([](KeptChain& k) { ++k.A.slot_map_key; })) << "a matrix of another order";
  EXPECT_TRUE(changed([](KeptChain& k) { k.A.slot_map_key = 0; })) << "of an order without a name";
}

TEST(StepAssembly, KeepsNothingOfTermsWithoutAVersion) {
  KeptChain chain(0);
  EXPECT_TRUE(chain.asks_again());
}

// An assembly with keep = false leaves the kept step valid.
TEST(StepAssembly, KeepsWhatItIsAskedToKeep) {
  KeptChain chain;
  const VecX shift = chain.shift;
  chain.shift *= 2.0;
  EXPECT_TRUE(chain.asks_again());
  EXPECT_TRUE(chain.asks_again());
  chain.shift = shift;
  EXPECT_FALSE(chain.asks_again());
  chain.shift *= 2.0;
  chain.assemble(true);
  EXPECT_FALSE(chain.asks_again());
}
