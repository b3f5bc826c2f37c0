#include "integrate/condensed_newton.h"
#include "palpate/linear/solvers.h"

#include <gtest/gtest.h>

#include "integrate/fakes.h"

namespace palpate {
namespace {

using namespace fakes;

// Newton's matrix of the residual form, against the dense matrix from which the header derives it.
TEST(CondensedNewton, SolvesTheResidualForm) {
  Chain chain(0.3);
  IntegratorSpec spec;
  integrate::CondensedNewton newton(chain.system, linear::make_linear_solver("cholmod"), spec);
  StepperCounters counters;
  newton.evaluate(chain.state.view(), counters);
  const Eigen::Index n = chain.state.layout().u_size;
  const double gamma = 0.07;
  ASSERT_EQ(newton.factor(gamma), SolveStatus::kOk);
  MatX J(2 * n, 2 * n);
  J << MatX::Identity(n, n) / gamma, -MatX::Identity(n, n), chain.term->K,
      chain.term->D + MatX::Identity(n, n) / gamma;
  const VecX r = VecX::LinSpaced(2 * n, -1.0, 2.0), expected = J.partialPivLu().solve(r);
  VecX d(2 * n);
  ASSERT_EQ(newton.solve_residual_form(chain.state.layout(), chain.state.q().data(), r.data(), r.data() + n,
                                       d.data(), d.data() + n),
            SolveStatus::kOk);
  EXPECT_LT((d - expected).norm(), 1e-12 * expected.norm());
}

TEST(CondensedNewton, FactorsOnlyWhatChanged) {
  Chain chain;
  integrate::CondensedNewton newton(chain.system, linear::make_linear_solver("cholmod"), {});
  StepperCounters counters;
  newton.evaluate(chain.state.view(), counters);
  for (const double gamma : {0.1, 0.1, 0.1, 0.2, 0.2}) ASSERT_EQ(newton.factor(gamma), SolveStatus::kOk);
  EXPECT_EQ(newton.solver().counters().factorisations, 2);
  EXPECT_EQ(counters.tangent_evaluations, 1);
}

/// Stores the positions passed with a matrix.
struct PositionsKept final : LinearSolver {
  VecX& kept;
  SolverCounters none;
  explicit PositionsKept(VecX& to) : kept(to) {}
  std::string name() const override { return "positions"; }
  bool supports_unsymmetric() const override { return true; }
  SolveStatus factor(const BorderedMatrix& A) override {
    kept = A.positions;
    return SolveStatus::kOk;
  }
  SolveStatus solve(const MatX&, MatX&) override { return SolveStatus::kSingular; }
  SolveStatus solve(const VecX&, VecX&) override { return SolveStatus::kSingular; }
  const SolverCounters& counters() const override { return none; }
};

// The matrix carries the current node positions, with which preconditioners rotate their rigid motions.
TEST(CondensedNewton, TellsWhereTheNodesAre) {
  Chain chain;
  VecX seen;
  integrate::CondensedNewton newton(chain.system, std::make_unique<PositionsKept>(seen), {});
  StepperCounters counters;
  for (const double shift : {0.0, 0.25}) {
    chain.state.q().array() += shift;
    newton.evaluate(chain.state.view(), counters);
    ASSERT_EQ(newton.factor(0.1), SolveStatus::kOk);
    ASSERT_GT(seen.size(), 0);
    EXPECT_EQ(seen, VecX(chain.state.q().head(seen.size())));
  }
}

}  // namespace
}  // namespace palpate
