// Responses of a step matrix to a few right-hand sides.
#include "linear/step_response.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "linear/bent_beam.h"
#include "palpate/linear/solvers.h"

namespace palpate {
namespace {

using namespace dynamics;
using linear::StepResponse;

constexpr double kStep = 0.01, kTick = 0.001, kDamping = 2e-3;

/// A beam on springs along z under its free end, and the loads of a tool there: a push and two tilts, with a
/// load on all nodes as the last column.
struct Touched {
  BentBeam beam{12, 2e4, 3, {.stiffness_damping = kDamping}};
  double angle;
  std::vector<int> nodes;
  std::vector<double> weight;  ///< weight per node; empty: one

  explicit Touched(double bend = 0.4) : angle(bend) {
    for (int i = 0; i < beam.rest.size() / 3; ++i)
      if (beam.rest[3 * i] > 0.3 && beam.rest[3 * i + 2] < -0.12) nodes.push_back(i);
  }
  /// Moves the springs to one position on the lower side, with the largest weight at its centre; the push has
  /// the same weights.
  void touch(double along) {
    nodes.clear();
    weight.clear();
    for (int i = 0; i < beam.rest.size() / 3; ++i) {
      const double away = (beam.rest[3 * i] - along) / 0.12;
      if (std::abs(away) >= 1.0 || beam.rest[3 * i + 2] > -0.12) continue;
      nodes.push_back(i);
      weight.push_back(1.0 - away * away);
    }
  }
  double share(std::size_t k) const { return weight.empty() ? 1.0 : weight[k]; }
  PointStiffness springs(double stiffness) const {
    PointStiffness out;
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      PointStiffness::OfPoint one;
      one.nodes.count = 1;
      one.nodes.node[0] = nodes[k];
      one.weight[0] = 1.0;
      one.C(2, 2) = share(k) * stiffness;
      out.points.push_back(one);
    }
    return out;
  }
  MatX right() const {
    MatX B = MatX::Zero(beam.rest.size(), 4);
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      const int at = 3 * nodes[k];
      B.block<1, 3>(at + 2, 0) << 1.0, beam.rest[at] - 0.4, beam.rest[at + 1];
      B.row(at + 2) *= share(k);
    }
    for (Eigen::Index i = 0; i < B.rows(); ++i) B(i, 3) = 1e-3 * std::sin(0.1 * static_cast<double>(i));
    for (const int dof : beam.system.driven_dofs()) B.row(dof).setZero();
    return B;
  }
  void give(StepResponse& response, double stiffness, double h = kStep) {
    ASSERT_TRUE(beam.assembly.applies(beam.state.view()));
    ZeroRowSumMatrix& A = response.step_matrix(beam.assembly.pattern());
    VecX b;
    beam.at(angle, h, A, b);
    A.points = springs(stiffness * h * h);
    ASSERT_EQ(response.take_step_matrix(), SolveStatus::kOk);
  }
  /// The step matrix in double, dense.
  MatX matrix(double stiffness, double h = kStep) {
    BorderedMatrix A;
    VecX b;
    beam.at(angle, h, A, b);
    MatX out = A.to_dense();
    for (std::size_t k = 0; k < nodes.size(); ++k)
      out(3 * nodes[k] + 2, 3 * nodes[k] + 2) += share(k) * stiffness * h * h;
    return out;
  }
};

/// Largest error of S_ij relative to the root of S_ii S_jj of the exact one.
double apart(const MatX& S, const MatX& exact) {
  const VecX unit = exact.diagonal().cwiseSqrt().cwiseInverse();
  return (unit.asDiagonal() * (S - exact) * unit.asDiagonal()).cwiseAbs().maxCoeff();
}

void advance(StepResponse& response, int steps) {
  for (int k = 0; k < steps; ++k) ASSERT_EQ(response.advance(), SolveStatus::kOk);
}

}  // namespace

class StepResponses : public testing::TestWithParam<std::pair<double, double>> {
 protected:
  double step() const { return GetParam().first; }
  double stiffness() const { return GetParam().second; }
  void begin(StepResponse& response, Touched& of, const MatX& B) {
    of.give(response, stiffness(), step());
    ASSERT_EQ(response.begin(B), SolveStatus::kOk);
  }
};

// S and the solutions converge to those of a factorisation; the deficit of S is the energy of the columns'
// errors, so that S converges from below.
TEST_P(StepResponses, TendToTheFactoredOnesFromBelow) {
  Touched of;
  StepResponse response(1);
  const MatX B = of.right();
  begin(response, of, B);
  const MatX A = of.matrix(stiffness(), step()), exact_X = A.ldlt().solve(B), exact = B.transpose() * exact_X;
  for (int k = 0; k < 40; ++k) {
    const MatX lacks = exact - response.response();
    MatX E(B.rows(), B.cols());
    for (Eigen::Index c = 0; c < B.cols(); ++c) {
      VecX x;
      response.solution(c, x);
      E.col(c) = x - exact_X.col(c);
    }
    const VecX unit = exact.diagonal().cwiseSqrt().cwiseInverse();
    const MatX energy = E.transpose() * A * E;
    EXPECT_LT((unit.asDiagonal() * (lacks - energy) * unit.asDiagonal()).norm(), 2e-5) << "step " << k;
    EXPECT_GT((unit.asDiagonal() * lacks * unit.asDiagonal())
                  .eval()
                  .selfadjointView<Eigen::Lower>()
                  .eigenvalues()
                  .minCoeff(),
              -2e-5)
        << "step " << k;
    advance(response, 1);
  }
  EXPECT_LT(apart(response.response(), exact), 1e-5);
}

// Stopping by the estimate gives the requested error, without many excess iterations.
TEST_P(StepResponses, LackAboutWhatTheySayTheyLack) {
  Touched of;
  StepResponse response(1);
  const MatX B = of.right();
  const MatX exact = B.transpose() * of.matrix(stiffness(), step()).ldlt().solve(B);
  begin(response, of, B);
  for (const double requested : {1e-1, 1e-2, 1e-3, 1e-4}) {
    for (int k = 0; k < 60; ++k) {
      if ((response.error_bound().array() <= requested * exact.diagonal().array()).all()) break;
      advance(response, 1);
    }
    EXPECT_LT(apart(response.response(), exact), requested);
  }
}

// New right-hand sides, combinations of slightly changed previous ones, start from the previous solutions.
TEST_P(StepResponses, BeginWhereTheLastOnesEnded) {
  Touched of;
  StepResponse response(1);
  MatX B = of.right();
  begin(response, of, B);
  advance(response, 30);
  of.angle += 0.01;
  MatX turn = MatX::Identity(4, 4);
  turn.topLeftCorner<3, 3>() = quaternion_of(Vec3(0.3, -0.5, 0.8)).toRotationMatrix();
  B = of.right() * turn;
  const MatX exact = B.transpose() * of.matrix(stiffness(), step()).ldlt().solve(B);
  const long before = response.products();
  begin(response, of, B);
  EXPECT_EQ(response.products(), before) << "the matrix is read as it is packed";
  EXPECT_LT(apart(response.response(), exact), 5e-3);
  StepResponse cold(1);
  begin(cold, of, B);
  EXPECT_GT(apart(cold.response(), exact), 0.5) << "nothing is known at first";
}

// Before its first step a call has no eigenvalue estimate for its right-hand sides: the right-hand sides of a
// tool that moves along the beam are new in each step.
TEST_P(StepResponses, LackNoMoreThanTheySayBeforeTheFirstStep) {
  Touched of;
  StepResponse response(1);
  int begun = 0, enough = 0;
  for (double along = 0.45; along > 0.39; along -= 0.002) {
    of.touch(along);
    const MatX B = of.right();
    const VecX exact = (B.transpose() * of.matrix(stiffness(), step()).ldlt().solve(B)).diagonal();
    begin(response, of, B);
    if (begun++ > 0) {
      const VecX lacks = exact - response.response().diagonal();
      EXPECT_TRUE((lacks.array() <= response.error_bound().array() + 1e-5 * exact.array()).all())
          << "at " << along << ": " << lacks.cwiseQuotient(exact).transpose() << ", not "
          << response.error_bound().cwiseQuotient(exact).transpose();
      enough += (response.error_bound().array() <= 0.1 * exact.array()).all();
    }
    for (int k = 0; k < 60 && !(response.error_bound().array() <= 1e-2 * exact.array()).all(); ++k)
      advance(response, 1);
  }
  EXPECT_GT(enough, begun / 2) << "a bound that is never small says nothing";
}

TEST_P(StepResponses, DoNotDependOnTheNumberOfThreads) {
  Touched of;
  MatX S[2];
  for (const int threads : {1, 2}) {
    StepResponse response(threads);
    const MatX B = of.right();
    begin(response, of, B);
    advance(response, 5);
    S[threads - 1] = response.response();
  }
  EXPECT_EQ(S[0], S[1]);
}

INSTANTIATE_TEST_SUITE_P(Of, StepResponses,
                         testing::Values(std::pair{kStep, 0.0}, std::pair{kStep, 1e4}, std::pair{kTick, 0.0},
                                         std::pair{kTick, 1e4}),
                         [](const auto& of) {
                           return std::string(of.param.first == kStep ? "Step" : "Tick") +
                                  (of.param.second > 0.0 ? "OnSprings" : "");
                         });

// Dependent columns, zero columns, and more columns than one pass handles.
TEST(StepResponse, TakesAnyColumns) {
  Touched of;
  StepResponse response(1);
  const MatX few = of.right();
  MatX B(few.rows(), 9);
  B << few, 2.0 * few.col(0), few.col(1) - few.col(2), MatX::Zero(few.rows(), 1), few.col(3),
      1e-9 * few.col(0);
  const MatX exact = B.transpose() * of.matrix(1e3).ldlt().solve(B);
  of.give(response, 1e3);
  ASSERT_EQ(response.begin(B), SolveStatus::kOk);
  EXPECT_EQ(response.products(), 0);
  advance(response, 1);
  EXPECT_EQ(response.products(), 2);
  advance(response, 40);
  const VecX unit =
      (exact.diagonal().array() > 0.0).select(exact.diagonal().array().max(1e-300).rsqrt(), 0.0);
  EXPECT_LT((unit.asDiagonal() * (response.response() - exact) * unit.asDiagonal()).cwiseAbs().maxCoeff(),
            2e-5);
  EXPECT_EQ(response.response().row(6).norm(), 0.0);
}

TEST(StepResponse, SaysThatAMatrixIsIndefinite) {
  Touched of;
  StepResponse response(1);
  ZeroRowSumMatrix& A = response.step_matrix(of.beam.pattern());
  VecX b;
  of.beam.at(of.angle, kStep, A, b);
  A.diagonal *= -1e3;  // indefinite in blocks of single nodes
  EXPECT_EQ(response.take_step_matrix(), SolveStatus::kIndefinite);
  of.beam.at(of.angle, kStep, A, b);
  A.diagonal -= 1.2 * of.beam.system.nodal_mass();  // indefinite only as a whole: a push of all nodes
  ASSERT_EQ(response.take_step_matrix(), SolveStatus::kOk);
  MatX push = MatX::Zero(b.size(), 1);
  for (Eigen::Index i = 2; i < b.size(); i += 3) push(i, 0) = of.beam.masses[i / 3];
  for (const int dof : of.beam.system.driven_dofs()) push.row(dof).setZero();
  ASSERT_EQ(response.begin(push), SolveStatus::kOk);
  SolveStatus status = SolveStatus::kOk;
  for (int k = 0; k < 200 && status == SolveStatus::kOk; ++k) status = response.advance();
  EXPECT_EQ(status, SolveStatus::kIndefinite);
}

// A matrix assembled for model reduction can be used for the step, and vice versa, with either solver.
TEST(StepResponse, HasTheOrderOfTheSolvers) {
  for (const int cells : {8, 16, 32}) {
    BentBeam beam(cells, 1e5);
    const BlockSparse& pattern = beam.pattern();
    StepResponse response(1);
    const ZeroRowSumMatrix& mine = response.step_matrix(pattern);
    EXPECT_NE(mine.slot_map_key, 0u);
    for (const char* name : {"pcg-single", "pcg-two-level"}) {
      const auto solver = linear::make_linear_solver(name);
      const ZeroRowSumMatrix* theirs = dynamic_cast<MixedPrecisionSolver&>(*solver).step_matrix(pattern);
      ASSERT_TRUE(theirs);
      EXPECT_EQ(theirs->slot_map, mine.slot_map) << name;
      EXPECT_EQ(theirs->slot_map_key, mine.slot_map_key) << name;
    }
  }
  BentBeam one(8, 1e5), other(12, 1e5);
  StepResponse response(1), second(1);
  EXPECT_NE(response.step_matrix(one.pattern()).slot_map_key,
            second.step_matrix(other.pattern()).slot_map_key);
}

}  // namespace palpate
