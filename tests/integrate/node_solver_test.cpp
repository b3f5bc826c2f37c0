#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "integrate/linear/auto_choice.h"
#include "integrate/linear/energy_bound.h"
#include "integrate/linear/node_kernels.h"
#include "integrate/linear/node_order.h"
#include "integrate/linear/row_packing.h"
#include "malloc_count.h"
#include "palpate/core/team.h"
#include "palpate/dynamics/system.h"
#include "palpate/fem/attachments.h"
#include "palpate/fem/soft_body.h"
#include "palpate/integrate/integrators.h"
#include "palpate/mesh/generators.h"

namespace palpate {
namespace {

using namespace dynamics;

/// Step matrices M + h^2 K of a beam, held at one end, bent by angles that large rotation needs.
struct BentBeam {
  State state;
  System system;
  VecX rest, masses;
  explicit BentBeam(int cells_along, double youngs_modulus, int cells_across = 0) {
    const int across = cells_across > 0 ? cells_across : cells_along / 4;
    const double width = static_cast<double>(across) / cells_along;
    const TetMesh mesh = mesh::box(Vec3(1.0, width, width), {cells_along, across, across});
    const auto n = static_cast<int>(mesh.nodes.cols());
    rest = mesh.nodes.reshaped();
    const int id = state.insert(BlockSpec{.name = "beam", .q_size = 3 * n, .u_size = 3 * n}, rest, VecX::Zero(3 * n));
    const fem::Material material{.youngs_modulus = youngs_modulus, .poissons_ratio = 0.4, .density = 1000.0};
    system.add(std::static_pointer_cast<ForceTerm>(
        std::make_shared<fem::SoftBody>("beam", mesh, material, fem::SoftBodyOptions{.tangent = fem::Tangent::kWarped}, id)));
    masses = fem::lumped_masses(mesh, material.density);
    system.add(fem::make_gravity(masses, Vec3(0, 0, -9.81), id));
    system.add(fem::make_lumped_mass(mesh, material.density, id));
    const std::vector<int> held = fem::dofs_of_nodes(fem::nodes_in_box(mesh.nodes, Vec3(-0.5 - 1e-9, -1, -1), Vec3(-0.5 + 1e-9, 1, 1)), 0, "xyz");
    VecX x0(static_cast<Eigen::Index>(held.size()));
    for (std::size_t i = 0; i < held.size(); ++i) x0[static_cast<Eigen::Index>(i)] = rest[held[i]];
    system.add(fem::make_fixed(held, x0));
    system.prepare(state.view());
  }
  /// Bends the middle line to a circle whose angle at the end is `angle`, writes the step matrix there, and a right-hand side: weight and a wave.
  void at(double angle, double h, BorderedMatrix& A, VecX& b) {
    bend(angle);
    system.step_matrix(state.view(), 1.0, h, h * h, A);
    system.force(state.view(), b);
    load(angle, h, b);
  }
  /// The same of a balanced matrix.
  void at(double angle, double h, BalancedMatrix& A, VecX& b) {
    bend(angle);
    ASSERT_TRUE(system.balanced(state.view()));
    system.balanced_step(state.view(), VecX::Zero(rest.size()), 1.0, h, h * h, b, A);
    load(angle, h, b);
  }
  const BlockSparse& pattern() {
    EXPECT_TRUE(system.balanced(state.view()));
    return system.pattern();
  }

 private:
  void bend(double angle) {
    VecX q = rest;
    for (Eigen::Index i = 0; i < q.size(); i += 3) {
      const double s = rest[i] + 0.5, z = rest[i + 2], turn = angle * s, radius = angle != 0.0 ? 1.0 / angle : 0.0;
      if (angle == 0.0) continue;
      q[i] = (radius + z) * std::sin(turn) - 0.5;
      q[i + 2] = (radius + z) * std::cos(turn) - radius;
    }
    state.q() = q;
  }
  void load(double angle, double h, VecX& b) {
    for (Eigen::Index i = 0; i < b.size(); ++i) b[i] = h * b[i] + masses[i / 3] * std::sin(7.0 * rest[i - i % 3] + angle);
    system.reduce(state.view(), b);
  }
};

double energy_norm(const BorderedMatrix& A, const VecX& x) {
  VecX Ax;
  A.multiply(x, Ax);
  return std::sqrt(x.dot(Ax));
}

class NodeSolvers : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Registry, NodeSolvers, testing::Values("pcg-single", "pcg-two-level"), [](const auto& p) {
  std::string name = p.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

// What linear_rtol says: the error of the solution in the energy norm, against a direct solve, over a motion, with what the last steps left to start from.
TEST_P(NodeSolvers, TheErrorIsWhatTheToleranceSays) {
  int checked = 0;
  for (const double E : {1e5, 1e6})
    for (const double h : {1e-3, 1e-2})
      for (const double rtol : {1e-3, 1e-6, 1e-9}) {
        BentBeam beam(16, E);
        const auto solver = integrate::make_linear_solver(GetParam(), {.step_s = h, .linear_rtol = rtol});
        const auto direct = integrate::make_linear_solver("cholmod");
        BorderedMatrix A;
        VecX b, x, exact;
        for (int k = 0; k < 8; ++k) {
          beam.at(0.2 * k, h, A, b);
          ASSERT_EQ(direct->factor(A), SolveStatus::kOk);
          ASSERT_EQ(direct->solve(b, exact), SolveStatus::kOk);
          ASSERT_EQ(solver->factor(A), SolveStatus::kOk);
          ASSERT_EQ(solver->solve(b, x), SolveStatus::kOk);
          EXPECT_LE(energy_norm(A, x - exact), rtol * energy_norm(A, exact)) << "E " << E << ", h " << h << ", rtol " << rtol << ", step " << k;
          ++checked;
        }
        EXPECT_EQ(solver->counters().symbolic, 1);
      }
  EXPECT_EQ(checked, 96);
}

// A balanced matrix, off-diagonal blocks in single precision, is held to the same promise: against a direct solve of the whole matrix in double.  Across from four elements to
// one, where rounding of the blocks tells most; from matrices that are nearly mass to those that are nearly stiffness.  Where it is too coarse for the tolerance, the solver says so.
TEST_P(NodeSolvers, TheErrorIsWhatTheToleranceSaysOfABalancedMatrix) {
  int checked = 0, refused = 0;
  for (const int across : {4, 1})
    for (const double E : {1e4, 1e5, 1e6})
      for (const double rtol : {1e-3, 1e-6, 1e-7}) {
        BentBeam beam(across == 1 ? 64 : 16, E, across);
        const double h = 1e-2;
        const auto solver = integrate::make_linear_solver(GetParam(), {.step_s = h, .linear_rtol = rtol});
        const auto direct = integrate::make_linear_solver("cholmod");
        BorderedMatrix whole;
        VecX b, x, exact;
        for (int k = 0; k < 6; ++k) {
          beam.at(0.2 * k, h, whole, b);
          ASSERT_EQ(direct->factor(whole), SolveStatus::kOk);
          ASSERT_EQ(direct->solve(b, exact), SolveStatus::kOk);
          BalancedMatrix* A = solver->balanced(beam.pattern());
          if (!A) {
            EXPECT_GT(k, 0) << "it has to see one to know";
            continue;
          }
          beam.at(0.2 * k, h, *A, b);
          if (solver->factor_balanced() != SolveStatus::kOk) {
            ++refused;
            continue;
          }
          ASSERT_EQ(solver->solve(b, x), SolveStatus::kOk) << across << " across, E " << E << ", rtol " << rtol << ", step " << k << ", iterations " << solver->counters().iterations;
          EXPECT_LE(energy_norm(whole, x - exact), rtol * energy_norm(whole, exact)) << across << " across, E " << E << ", rtol " << rtol << ", step " << k;
          ++checked;
        }
        EXPECT_EQ(solver->counters().symbolic, 1);
      }
  EXPECT_GE(checked, 60);
  EXPECT_GE(refused, 1);
}

// Whole and balanced matrices of one pattern in turn: one analysis, and what is remembered serves both.
TEST_P(NodeSolvers, TakeWholeAndBalancedMatricesInTurn) {
  BentBeam beam(16, 1e5);
  const auto solver = integrate::make_linear_solver(GetParam(), {.linear_rtol = 1e-4});
  BorderedMatrix whole;
  VecX b, x, y;
  beam.at(0.5, 1e-2, whole, b);
  ASSERT_EQ(solver->factor(whole), SolveStatus::kOk);
  ASSERT_EQ(solver->solve(b, x), SolveStatus::kOk);
  const long cold = solver->counters().iterations;
  BalancedMatrix* A = solver->balanced(beam.pattern());
  ASSERT_NE(A, nullptr);
  beam.at(0.5, 1e-2, *A, b);
  ASSERT_EQ(solver->factor_balanced(), SolveStatus::kOk);
  ASSERT_EQ(solver->solve(b, y), SolveStatus::kOk);
  EXPECT_LE(solver->counters().iterations - cold, cold / 4);
  EXPECT_LE(energy_norm(whole, x - y), 2e-4 * energy_norm(whole, x));
  ASSERT_EQ(solver->solve(VecX(2.0 * b), y), SolveStatus::kOk) << "a second right-hand side";
  EXPECT_LE(energy_norm(whole, 2.0 * x - y), 4e-4 * energy_norm(whole, x));
  ASSERT_EQ(solver->factor(whole), SolveStatus::kOk);
  ASSERT_EQ(solver->solve(b, y), SolveStatus::kOk);
  EXPECT_LE(energy_norm(whole, x - y), 2e-4 * energy_norm(whole, x));
  EXPECT_EQ(solver->counters().symbolic, 1);
}

TEST_P(NodeSolvers, SayWhatTheyCannotDoWithABalancedMatrix) {
  BentBeam beam(8, 1e5);
  const auto solver = integrate::make_linear_solver(GetParam(), {.linear_rtol = 1e-4});
  BalancedMatrix* A = solver->balanced(beam.pattern());
  ASSERT_NE(A, nullptr);
  VecX b;
  beam.at(0.5, 1e-2, *A, b);
  A->values[9 * static_cast<std::size_t>(A->place[1]) + 4] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(solver->factor_balanced(), SolveStatus::kSingular);
  beam.at(0.5, 1e-2, *A, b);
  A->diagonal *= -1e6;
  EXPECT_EQ(solver->factor_balanced(), SolveStatus::kIndefinite);
  beam.at(0.5, 1e-2, *A, b);
  EXPECT_EQ(solver->factor_balanced(), SolveStatus::kOk);
}

// Rows of held directions are the identity's: what the right-hand side has there is the answer, and the rest does not feel it; in place, too.
TEST_P(NodeSolvers, HeldRowsStandAlone) {
  BentBeam beam(8, 1e5);
  const auto solver = integrate::make_linear_solver(GetParam(), {.linear_rtol = 1e-6});
  BalancedMatrix* A = solver->balanced(beam.pattern());
  ASSERT_NE(A, nullptr);
  VecX b, x;
  beam.at(0.5, 1e-2, *A, b);
  ASSERT_EQ(solver->factor_balanced(), SolveStatus::kOk);
  ASSERT_EQ(solver->solve(b, x), SolveStatus::kOk);
  ASSERT_FALSE(A->held->empty());
  VecX y = b;
  for (const HeldNode& held : *A->held)
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(x[3 * held.node + axis], 0.0);
      y[3 * held.node + axis] = 1.0 + axis;
    }
  ASSERT_EQ(solver->solve(y, y), SolveStatus::kOk);
  for (const HeldNode& held : *A->held)
    for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(y[3 * held.node + axis], 1.0 + axis);
  for (const HeldNode& held : *A->held) y.segment<3>(3 * held.node).setZero();
  EXPECT_LT((x - y).norm(), 1e-5 * x.norm());
}

TEST_P(NodeSolvers, ThreadsDoNotChangeABit) {
  std::vector<VecX> answers;
  for (const int threads : {1, 2, 3}) {
    BentBeam beam(16, 1e5);
    const auto solver = integrate::make_linear_solver(GetParam(), {.linear_rtol = 1e-6, .threads = threads});
    BorderedMatrix A;
    VecX b, x, all(0);
    for (int k = 0; k < 4; ++k) {
      beam.at(0.3 * k, 1e-2, A, b);
      ASSERT_EQ(solver->factor(A), SolveStatus::kOk);
      ASSERT_EQ(solver->solve(b, x), SolveStatus::kOk);
      all.conservativeResize(all.size() + 2 * x.size());
      all.tail(x.size()) = x;
      BalancedMatrix* balanced = solver->balanced(beam.pattern());
      ASSERT_NE(balanced, nullptr);
      beam.at(0.3 * k, 1e-2, *balanced, b);
      ASSERT_EQ(solver->factor_balanced(), SolveStatus::kOk);
      ASSERT_EQ(solver->solve(VecX(b.reverse().cwiseProduct((b.array() != 0.0).cast<double>().matrix())), x), SolveStatus::kOk);
      all.segment(all.size() - 2 * x.size(), x.size()) = x;
    }
    answers.push_back(all);
  }
  EXPECT_EQ(answers[0], answers[1]);
  EXPECT_EQ(answers[0], answers[2]);
}

// The same matrix again is solved by what is remembered; a second right-hand side of one factor starts from products with that factor's matrix.
TEST_P(NodeSolvers, StartFromTheLastSolutions) {
  BentBeam beam(16, 1e5);
  const auto solver = integrate::make_linear_solver(GetParam(), {.linear_rtol = 1e-4});
  BorderedMatrix A;
  VecX b, c, x, exact;
  beam.at(0.5, 1e-2, A, b);
  ASSERT_EQ(solver->factor(A), SolveStatus::kOk);
  ASSERT_EQ(solver->solve(b, x), SolveStatus::kOk);
  const long cold = solver->counters().iterations;
  EXPECT_GT(cold, 5);
  ASSERT_EQ(solver->solve(VecX(-3.0 * b), x), SolveStatus::kOk);
  EXPECT_LE(solver->counters().iterations - cold, cold / 4);
  c = VecX::LinSpaced(b.size(), -1.0, 2.0);
  ASSERT_EQ(solver->solve(c, x), SolveStatus::kOk);
  const auto direct = integrate::make_linear_solver("cholmod");
  ASSERT_EQ(direct->factor(A), SolveStatus::kOk);
  ASSERT_EQ(direct->solve(c, exact), SolveStatus::kOk);
  EXPECT_LE(energy_norm(A, x - exact), 1e-4 * energy_norm(A, exact));
  ASSERT_EQ(solver->solve(VecX(VecX::Zero(b.size())), x), SolveStatus::kOk);
  EXPECT_EQ(x, VecX(VecX::Zero(b.size())));
}

// Units: the same problem in other units of force is solved to the same bits but for a power of two, far outside of what single precision can hold.
TEST_P(NodeSolvers, TakeAnyUnits) {
  BentBeam beam(8, 1e5);
  BorderedMatrix A;
  VecX b, x, scaled;
  beam.at(0.5, 1e-2, A, b);
  const auto solver = integrate::make_linear_solver(GetParam(), {.linear_rtol = 1e-6});
  ASSERT_EQ(solver->factor(A), SolveStatus::kOk);
  ASSERT_EQ(solver->solve(b, x), SolveStatus::kOk);
  for (const double unit : {std::ldexp(1.0, 200), std::ldexp(1.0, -200)}) {
    BorderedMatrix B = A;
    for (double& value : B.body.values()) value *= unit;
    B.touch();
    const auto other = integrate::make_linear_solver(GetParam(), {.linear_rtol = 1e-6});
    ASSERT_EQ(other->factor(B), SolveStatus::kOk);
    ASSERT_EQ(other->solve(b, scaled), SolveStatus::kOk);
    EXPECT_EQ(VecX(unit * scaled), x);
  }
}

TEST_P(NodeSolvers, FindNegativeCurvatureWhileTheySolve) {
  PatternBuilder pattern(50);
  for (int i = 0; i + 1 < 50; ++i) pattern.add_pair(i, i + 1);
  BorderedMatrix A;
  A.body = pattern.build();
  for (int i = 0; i < 50; ++i) A.body.add(A.body.slot(i, i), (i == 0 || i == 49 ? 0.99 : 1.99) * Mat3::Identity());
  for (int i = 0; i + 1 < 50; ++i) {
    A.body.add(A.body.slot(i, i + 1), -Mat3::Identity());
    A.body.add(A.body.slot(i + 1, i), -Mat3::Identity());
  }
  A.touch();
  const auto solver = integrate::make_linear_solver(GetParam());
  const SolveStatus factored = solver->factor(A);
  VecX x = VecX::Ones(150);
  if (factored == SolveStatus::kOk) {
    EXPECT_EQ(solver->solve(VecX(x), x), SolveStatus::kIndefinite);
  }
  const auto robust = integrate::make_robust_linear_solver(GetParam());
  ASSERT_EQ(robust->factor(A), SolveStatus::kOk);
  const VecX b = VecX::Ones(150);
  ASSERT_EQ(robust->solve(b, x), SolveStatus::kOk);
  VecX Ax;
  A.multiply(x, Ax);
  EXPECT_LT((Ax - b).norm(), 1e-9 * b.norm());
}

TEST_P(NodeSolvers, RefuseSettingsOutOfRange) {
  for (const double bad : {0.0, -1e-8, 0.5, std::nan("")}) EXPECT_THROW(integrate::make_linear_solver(GetParam(), {.linear_rtol = bad}), Error) << bad;
  for (const int bad : {0, -1, 65}) EXPECT_THROW(integrate::make_linear_solver(GetParam(), {.threads = bad}), Error) << bad;
}

// Twice the stiffness number is 1.4 times the iterations of block Jacobi; rigid clusters take the long waves, so that the count hardly grows.
TEST(TwoLevel, StiffnessHardlyShowsInTheCount) {
  std::vector<long> two_level, single;
  for (const double E : {1e5, 1e7}) {
    BentBeam beam(24, E);
    BorderedMatrix A;
    VecX b, x;
    beam.at(0.7, 1e-2, A, b);
    for (const char* name : {"pcg-single", "pcg-two-level"}) {
      const auto solver = integrate::make_linear_solver(name, {.linear_rtol = 1e-6});
      ASSERT_EQ(solver->factor(A), SolveStatus::kOk);
      ASSERT_EQ(solver->solve(b, x), SolveStatus::kOk);
      (std::string(name) == "pcg-single" ? single : two_level).push_back(solver->counters().iterations);
    }
  }
  EXPECT_GT(single[1], 3 * single[0]) << "a hundred times the stiffness";
  EXPECT_LT(two_level[1], 2 * two_level[0]);
}

TEST(TwoLevel, KeepsItsClustersWhileTheyServe) {
  BentBeam beam(16, 1e6);
  const auto solver = integrate::make_linear_solver("pcg-two-level", {.linear_rtol = 1e-3});
  BorderedMatrix A;
  VecX b, x;
  for (int k = 0; k < 20; ++k) {
    beam.at(0.001 * k, 1e-2, A, b);
    ASSERT_EQ(solver->factor(A), SolveStatus::kOk);
    ASSERT_EQ(solver->solve(b, x), SolveStatus::kOk);
  }
  EXPECT_EQ(solver->counters().refreshes, 1);
}

// Rows of M + h^2 K sum to those of M: the number is what the definition says, from masses and diagonal.
TEST(Auto, ReadsTheStiffnessNumberFromTheMatrix) {
  for (const auto& [cells, h] : {std::pair{16, 1e-4}, {16, 1e-2}, {36, 1e-3}}) {  // the last has rows that are not looked at
    BentBeam beam(cells, 1e5);
    BorderedMatrix A;
    VecX b;
    beam.at(0.6, h, A, b);
    double own = 0.0, mass = 0.0;
    for (int i = 0; i < A.body.block_rows(); ++i) {
      if (beam.rest[3 * i] < -0.5 + 0.1) continue;  // held, or beside what is held
      const double* block = A.body.block(A.body.diagonal(i));
      own += block[0] + block[4] + block[8];
      mass += 3.0 * beam.masses[i];
    }
    EXPECT_NEAR(integrate::stiffness_number(A.body), own / mass, 0.1 * own / mass);
  }
}

TEST(Auto, AnswersWhateverTheTableChooses) {
  int checked = 0;
  for (const auto& [cells, E] : {std::pair{8, 1e5}, {8, 1e9}, {24, 1e5}, {24, 1e8}}) {
    BentBeam beam(cells, E);
    const auto solver = integrate::make_linear_solver("auto", {.linear_rtol = 1e-6}), direct = integrate::make_linear_solver("cholmod");
    BorderedMatrix A;
    VecX b, x, exact;
    beam.at(0.4, 1e-2, A, b);
    ASSERT_EQ(direct->factor(A), SolveStatus::kOk);
    ASSERT_EQ(direct->solve(b, exact), SolveStatus::kOk);
    ASSERT_EQ(solver->factor(A), SolveStatus::kOk);
    ASSERT_EQ(solver->solve(b, x), SolveStatus::kOk);
    EXPECT_LE(energy_norm(A, x - exact), 1e-6 * energy_norm(A, exact)) << cells << " cells, E " << E;
    ++checked;
  }
  EXPECT_EQ(checked, 4);
}

// A matrix far from the last one sends the choice back to a whole one.
TEST(Auto, KeepsItsChoiceForBalancedMatricesWhileItServes) {
  BentBeam beam(24, 1e5);
  const auto solver = integrate::make_linear_solver("auto", {.linear_rtol = 1e-3});
  EXPECT_EQ(solver->balanced(beam.pattern()), nullptr) << "nothing was chosen yet";
  BorderedMatrix whole;
  VecX b, x, exact;
  beam.at(0.4, 1e-2, whole, b);
  ASSERT_EQ(solver->factor(whole), SolveStatus::kOk);
  BalancedMatrix* A = solver->balanced(beam.pattern());
  ASSERT_NE(A, nullptr);
  beam.at(0.4, 1e-2, *A, b);
  ASSERT_EQ(solver->factor_balanced(), SolveStatus::kOk);
  ASSERT_EQ(solver->solve(b, x), SolveStatus::kOk);
  const auto direct = integrate::make_linear_solver("cholmod");
  ASSERT_EQ(direct->factor(whole), SolveStatus::kOk);
  ASSERT_EQ(direct->solve(b, exact), SolveStatus::kOk);
  EXPECT_LE(energy_norm(whole, x - exact), 1e-3 * energy_norm(whole, exact));
  A = solver->balanced(beam.pattern());
  beam.at(0.4, 1e-1, *A, b);
  EXPECT_NE(solver->factor_balanced(), SolveStatus::kOk);
}

// --- the step --------------------------------------------------------------------------------------------------------

// Steps in one pass are the steps of the general way, to the solver's tolerance; and no whole matrix was made on the way.
TEST(LinearlyImplicitEuler, StepsTheSameInOnePass) {
  for (const std::string name : {"pcg-single", "pcg-two-level"}) {
    BentBeam fast(16, 1e5), direct(16, 1e5);
    const auto one_pass = integrate::make_stepper(fast.system, fast.state, {.name = "linearly-implicit-euler", .step_s = 2e-3, .linear_solver = name, .linear_rtol = 1e-6});
    const auto general = integrate::make_stepper(direct.system, direct.state, {.name = "linearly-implicit-euler", .step_s = 2e-3, .linear_solver = "cholmod"});
    for (int k = 1; k <= 20; ++k) {
      ASSERT_TRUE(one_pass->advance_to(2e-3 * k).ok());
      ASSERT_TRUE(general->advance_to(2e-3 * k).ok());
    }
    const VecX moved = direct.state.q() - direct.rest;
    EXPECT_GT(moved.norm(), 1e-3);
    EXPECT_LT((fast.state.q() - direct.state.q()).norm(), 1e-5 * moved.norm()) << name;
    const StepperCounters& c = one_pass->counters();
    EXPECT_EQ(c.tangent_evaluations, 20);
    EXPECT_EQ(c.force_evaluations, 20);
    EXPECT_EQ(c.solver.factorisations, 20);
    EXPECT_EQ(c.solver.solves, 20);
    EXPECT_EQ(c.solver.symbolic, 1);
    EXPECT_EQ(c.unconverged, 0);
  }
}

TEST(LinearlyImplicitEuler, AllocatesNothingOnceWarm) {
#if PALPATE_CAN_COUNT
  for (const std::string name : {"pcg-single", "pcg-two-level", "auto"}) {
    BentBeam beam(16, 1e5);
    const auto stepper = integrate::make_stepper(beam.system, beam.state, {.name = "linearly-implicit-euler", .step_s = 1e-3, .linear_solver = name, .linear_rtol = 1e-4});
    for (int k = 1; k <= 8; ++k) ASSERT_TRUE(stepper->advance_to(1e-3 * k).ok());
    const long warm = malloc_calls;
    for (int k = 9; k <= 16; ++k) ASSERT_TRUE(stepper->advance_to(1e-3 * k).ok());
    EXPECT_EQ(malloc_calls - warm, 0) << name;
  }
#else
  GTEST_SKIP() << "a sanitizer owns malloc: nothing can be counted here";
#endif
}

// --- parts -----------------------------------------------------------------------------------------------------------

TEST(NodeOrder, CutsAGraphIntoEqualPartsThatHangTogether) {
  BentBeam beam(16, 1e5);
  BorderedMatrix A;
  VecX b;
  beam.at(0.0, 1e-2, A, b);
  const int n = A.body.block_rows();
  for (const int clusters : {1, 2, 7, 20}) {
    const integrate::NodeOrder order = integrate::cluster_nodes(A.body, clusters);
    ASSERT_EQ(order.clusters(), clusters);
    std::vector<int> seen(static_cast<std::size_t>(n), 0);
    for (const int i : order.node) ++seen[static_cast<std::size_t>(i)];
    EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), n);
    for (int c = 0; c < clusters; ++c) EXPECT_NEAR(order.start[static_cast<std::size_t>(c) + 1] - order.start[static_cast<std::size_t>(c)], n / clusters, 5);
    EXPECT_EQ(order.parts(), 1);
    const integrate::NodeOrder parted = integrate::cluster_nodes(A.body, clusters, 4);
    EXPECT_EQ(parted.clusters(), clusters);
    EXPECT_EQ(parted.parts(), std::min(clusters, 4));
    EXPECT_EQ(parted.first_node(static_cast<std::size_t>(parted.parts())), n);
    for (std::size_t p = 0; p < static_cast<std::size_t>(parted.parts()); ++p) EXPECT_NEAR(parted.first_node(p + 1) - parted.first_node(p), n / parted.parts(), 2);
  }
  EXPECT_EQ(integrate::cluster_nodes(A.body, 10 * n).clusters(), n) << "no more clusters than nodes";
}

// Every block has a place of its own, or shares its mirror image's where both nodes are of one part; little is filled up.
TEST(RowPacking, TakesEveryBlockOnce) {
  BentBeam beam(24, 1e5);
  const BlockSparse& pattern = beam.pattern();
  const std::size_t n = static_cast<std::size_t>(pattern.block_rows());
  for (const int parts : {1, 2, 5}) {
    const integrate::NodeOrder order = integrate::cluster_nodes(pattern, parts, parts);
    std::vector<int> place(n), row_start(1, 0), column, part(n);
    for (std::size_t k = 0; k < n; ++k) place[static_cast<std::size_t>(order.node[k])] = static_cast<int>(k);
    for (std::size_t p = 0; p < static_cast<std::size_t>(parts); ++p) std::fill(part.begin() + order.first_node(p), part.begin() + order.first_node(p + 1), static_cast<int>(p));
    for (std::size_t k = 0; k < n; ++k) {
      const auto i = static_cast<std::size_t>(order.node[k]);
      column.push_back(static_cast<int>(k));
      const std::size_t first = column.size();
      for (int s = pattern.row_start()[i]; s < pattern.row_start()[i + 1]; ++s)
        if (pattern.columns()[static_cast<std::size_t>(s)] != static_cast<int>(i)) column.push_back(place[static_cast<std::size_t>(pattern.columns()[static_cast<std::size_t>(s)])]);
      std::sort(column.begin() + static_cast<std::ptrdiff_t>(first), column.end());
      row_start.push_back(static_cast<int>(column.size()));
    }
    integrate::RowPacking packing;
    packing.analyse(order, row_start, column);
    std::vector<int> taken(packing.places(), 0);
    std::size_t blocks = 0;
    for (std::size_t i = 0; i < n; ++i)
      for (auto s = static_cast<std::size_t>(row_start[i]); s < static_cast<std::size_t>(row_start[i + 1]); ++s) {
        const auto j = static_cast<std::size_t>(column[s]);
        const integrate::PackedRows rows = packing.rows(static_cast<std::size_t>(part[packing.turned(s) ? j : i]), nullptr);
        EXPECT_EQ(rows.column[packing.place(s)], static_cast<int>(4 * (packing.turned(s) ? i : j)));
        if (packing.turned(s)) {
          EXPECT_EQ(part[i], part[j]);
          continue;
        }
        ++taken[packing.place(s)];
        ++blocks;
      }
    EXPECT_EQ(*std::max_element(taken.begin(), taken.end()), 1);
    EXPECT_EQ(static_cast<std::size_t>(std::count(taken.begin(), taken.end(), 1)), blocks);
    if (parts == 1) {
      EXPECT_EQ(blocks, (column.size() - n) / 2 + n) << "every pair shares";
    }
    EXPECT_LT(static_cast<double>(packing.places()), 1.25 * static_cast<double>(blocks));
  }
}

// The Gauss-Radau bound against the error itself, along the iteration, for a spectrum given.
TEST(EnergyBound, LiesAboveTheErrorAndCloseToIt) {
  const int n = 60;
  VecX lambda(n);
  for (int i = 0; i < n; ++i) lambda[i] = std::pow(10.0, -2.0 + 2.0 * i / (n - 1));  // 0.01 to 1
  const VecX exact = VecX::LinSpaced(n, 1.0, 2.0), b = lambda.cwiseProduct(exact);
  integrate::EnergyBound bound;
  int above = 0, checked = 0;
  double worst = 0.0;
  for (int solve = 0; solve < 3; ++solve) {  // the first teaches it the spectrum
    bound.begin(0.0);
    VecX x = VecX::Zero(n), r = b, p = r;
    double rho = r.squaredNorm();
    for (int k = 0; k < 40; ++k) {
      const VecX Ap = lambda.cwiseProduct(p);
      const double alpha = rho / p.dot(Ap);
      x += alpha * p;
      r -= alpha * Ap;
      const double next = r.squaredNorm();
      bound.step(alpha, rho, next);
      p = r + (next / rho) * p;
      rho = next;
      const double error = (exact - x).dot(lambda.cwiseProduct(exact - x));
      if (solve == 0 || error < 1e-20) continue;
      ++checked;
      above += bound.error(rho) >= error * (1.0 - 1e-6);
      worst = std::max(worst, bound.error(rho) / error);
    }
    bound.end();
  }
  EXPECT_GT(checked, 40);
  EXPECT_EQ(above, checked);
  EXPECT_LT(worst, 100.0) << "of the squares: a factor of ten";
}

TEST(NodeKernels, EverySetGivesTheSameButForRounding) {
  BentBeam beam(8, 1e5);
  BorderedMatrix A;
  VecX b;
  beam.at(0.9, 1e-2, A, b);
  const auto n = static_cast<std::size_t>(A.body.block_rows());
  std::vector<int> source(static_cast<std::size_t>(A.body.slot_count())), diagonal(n);
  for (std::size_t s = 0; s < source.size(); ++s) source[s] = static_cast<int>(s);
  for (std::size_t i = 0; i < n; ++i) {
    diagonal[i] = A.body.diagonal(static_cast<int>(i));
    const auto row = source.begin() + A.body.row_start()[i];
    std::rotate(row, source.begin() + diagonal[i], source.begin() + diagonal[i] + 1);  // the row's own block first
  }
  std::vector<int> column;
  for (const int slot : source) column.push_back(A.body.columns()[static_cast<std::size_t>(slot)]);
  std::vector<int> row_start(A.body.row_start().begin(), A.body.row_start().end());
  integrate::NodeOrder order = integrate::cluster_nodes(A.body, 3, 3);
  for (std::size_t i = 0; i < n; ++i) order.node[i] = static_cast<int>(i);  // parts of nodes as they come: many blocks between parts
  integrate::RowPacking packing;
  packing.analyse(order, row_start, column);
  std::vector<double> v(4 * n + integrate::kVectorTail), Av(v);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t a = 0; a < 3; ++a) v[4 * i + a] = b[static_cast<Eigen::Index>(3 * i + a)];
  VecX exact;
  A.multiply(b, exact);
  for (int limit = 0; limit <= 2; ++limit) {
    const integrate::NodeKernels& k = integrate::node_kernels(limit);
    std::vector<float> values(9 * (source.size() + 1) + integrate::kBlockTail), p(4 * n + integrate::kVectorTail), q(p), inverse(static_cast<std::size_t>(integrate::inverse_place(static_cast<int>(n) + 3)));
    const integrate::DoubleBlocks D{row_start.data(), column.data(), source.data(), A.body.values().data(), A.body.slot_count() - 1};
    ASSERT_TRUE(k.convert(D, 1.0, values.data(), 0, static_cast<int>(n)));
    k.multiply_double(D, v.data(), Av.data(), 0, static_cast<int>(n));
    for (std::size_t i = 0; i < v.size(); ++i) p[i] = static_cast<float>(v[i]);
    std::vector<int> offset(packing.places() + integrate::kLanesOfGroup * integrate::kStepsAhead, 9 * static_cast<int>(source.size()));
    std::vector<std::uint16_t> turned(packing.places() / integrate::kLanesOfGroup, 0);
    for (std::size_t s = 0; s < source.size(); ++s)
      if (!packing.turned(s)) offset[packing.place(s)] = 9 * static_cast<int>(s);
    double pq = 0.0;
    for (std::size_t part = 0; part < 3; ++part) k.pack(packing.rows(part, nullptr), {values.data(), offset.data(), nullptr});
    for (std::size_t part = 0; part < 3; ++part) pq += k.product(packing.rows(part, nullptr), p.data(), q.data());
    ASSERT_TRUE(k.invert_diagonal(A.body.values().data(), diagonal.data(), 1.0, inverse.data(), 0, static_cast<int>(n)));
    const auto lacks_held_columns = [&](std::size_t i) { return beam.rest[static_cast<Eigen::Index>(3 * i)] < -0.5 + 0.2; };
    const auto off_identity = [&](bool balanced) {
      double most = 0.0;
      for (std::size_t i = 0; i < n; ++i) {
        if (balanced && lacks_held_columns(i)) continue;
        const Mat3 own = Eigen::Map<const Mat3>(A.body.block(diagonal[i]));
        Mat3 J;
        for (int c = 0; c < 3; ++c)
          for (int r = 0; r < 3; ++r) J(r, c) = inverse[static_cast<std::size_t>(integrate::inverse_place(static_cast<int>(i)) + (r == c ? r : integrate::kToOffDiagonal + 3 - r - c))];
        most = std::max(most, (own * J - Mat3::Identity()).norm());
      }
      return most;
    };
    double in_double = 0.0, in_single = 0.0;
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t a = 0; a < 3; ++a) {
        const double want = exact[static_cast<Eigen::Index>(3 * i + a)];
        in_double = std::max(in_double, std::abs(Av[4 * i + a] - want));
        in_single = std::max(in_single, std::abs(q[4 * i + a] - want));
      }
    EXPECT_LT(in_double, 1e-13 * exact.cwiseAbs().maxCoeff()) << k.name;
    EXPECT_LT(in_single, 1e-5 * exact.cwiseAbs().maxCoeff()) << k.name;
    EXPECT_NEAR(pq, b.dot(exact), 1e-5 * std::abs(b.dot(exact))) << k.name;
    EXPECT_LT(off_identity(false), 1e-5) << k.name;

    // Balanced: what is missing in a row's sum is its mass.  Blocks come turned and unturned.
    std::vector<double> mass(4 * n + integrate::kVectorTail);
    std::vector<float> mass_single(mass.size());
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t a = 0; a < 3; ++a) {
        double sum = 0.0;
        for (int s = A.body.row_start()[i]; s < A.body.row_start()[i + 1]; ++s)
          sum += A.body.columns()[static_cast<std::size_t>(s)] == static_cast<int>(i) ? A.body.block(s)[4 * a] : static_cast<float>(A.body.block(s)[4 * a]);
        mass[4 * i + a] = sum;
        mass_single[4 * i + a] = static_cast<float>(sum);
      }
    for (std::size_t s = 0; s < source.size(); ++s) {
      const std::size_t at = packing.place(s);
      if (packing.turned(s) || at % 3 != 0 || column[s] == static_cast<int>(std::upper_bound(row_start.begin(), row_start.end(), static_cast<int>(s)) - row_start.begin()) - 1) continue;
      Eigen::Map<Eigen::Matrix3f>(values.data() + 9 * s).transposeInPlace();
      turned[at / integrate::kLanesOfGroup] = static_cast<std::uint16_t>(turned[at / integrate::kLanesOfGroup] | 1u << at % integrate::kLanesOfGroup);
    }
    std::vector<float> sums(8 * n + integrate::kVectorTail), Vs[5], AVs[5];
    const float* V[5] = {};
    float* AV[5] = {};
    for (int c = 0; c < 5; ++c) {
      Vs[c] = p;
      AVs[c].resize(p.size());
      for (float& value : Vs[c]) value *= static_cast<float>(c + 1);
      V[c] = Vs[c].data();
      AV[c] = AVs[c].data();
    }
    std::fill(inverse.begin(), inverse.end(), 0.0f);
    std::fill(Av.begin(), Av.end(), 0.0);
    double trace = 0.0, all_traces = 0.0;
    for (std::size_t part = 0; part < 3; ++part) {
      const integrate::PackedRows rows = packing.rows(part, mass_single.data());
      ASSERT_EQ(k.balance(rows, {values.data(), offset.data(), turned.data()}, sums.data(), inverse.data(), &trace, static_cast<int>(part) + 3, V, AV), integrate::Balanced::kOk);
      all_traces += trace;
    }
    pq = 0.0;
    for (std::size_t part = 0; part < 3; ++part) {
      const integrate::PackedRows rows = packing.rows(part, mass_single.data());
      k.multiply_balanced(rows, mass.data(), 1.0, v.data(), Av.data());
      pq += k.product(rows, p.data(), q.data());
    }
    double off = 0.0, off_single = 0.0, off_columns = 0.0, traces = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      traces += Eigen::Map<const Mat3>(A.body.block(diagonal[i])).trace();
      if (lacks_held_columns(i)) continue;  // such rows are not balanced
      for (std::size_t a = 0; a < 3; ++a) {
        const double want = exact[static_cast<Eigen::Index>(3 * i + a)];
        off = std::max(off, std::abs(Av[4 * i + a] - want));
        off_single = std::max(off_single, std::abs(q[4 * i + a] - want));
        for (std::size_t c = 0; c < 3; ++c) off_columns = std::max(off_columns, std::abs(AVs[c][4 * i + a] / static_cast<double>(c + 1) - want));
      }
    }
    EXPECT_LT(off, 1e-6 * exact.cwiseAbs().maxCoeff()) << k.name;
    EXPECT_LT(off_single, 1e-5 * exact.cwiseAbs().maxCoeff()) << k.name;
    EXPECT_LT(off_columns, 1e-5 * exact.cwiseAbs().maxCoeff()) << k.name;
    EXPECT_NEAR(all_traces, traces, 1e-5 * traces) << k.name;
    EXPECT_LT(off_identity(true), 1e-5) << k.name;
    k.multiply(packing.rows(2, mass_single.data()), 5, V, AV);
    EXPECT_EQ(AVs[4][4 * (n - 1)], AVs[4][4 * (n - 1)]) << "a number";
    EXPECT_NEAR(AVs[4][4 * (n - 1)], 5.0 * q[4 * (n - 1)], 1e-4 * exact.cwiseAbs().maxCoeff()) << k.name;

    const int size = 21, stride = 32;
    MatX S = MatX::Random(size, size);
    S = S * S.transpose() + MatX::Identity(size, size);
    std::vector<float> E(size * stride, 0.0f), w(stride, 0.0f), y(stride, 0.0f);
    for (int i = 0; i < size; ++i) {
      y[static_cast<std::size_t>(i)] = static_cast<float>(S.row(i).sum());
      for (int j = 0; j < size; ++j) E[static_cast<std::size_t>(i * stride + j)] = static_cast<float>(S(i, j));
    }
    ASSERT_TRUE(k.invert(E.data(), size, stride));
    k.dense(E.data(), stride, y.data(), w.data(), 0, size);
    for (int i = 0; i < size; ++i) EXPECT_NEAR(w[static_cast<std::size_t>(i)], 1.0, 1e-3) << k.name;
  }
}

TEST(Team, WorksTogetherAgainAndAgain) {
  for (const int size : {1, 2, 4}) {
    Team team(size);
    std::vector<long> slots(static_cast<std::size_t>(size), 0), sums(static_cast<std::size_t>(size), 0);
    for (long round = 1; round <= 200; ++round)
      team.run([&](int k) {
        slots[static_cast<std::size_t>(k)] = round * (k + 1);
        team.barrier();
        for (const long slot : slots) sums[static_cast<std::size_t>(k)] += slot;  // sees what all wrote
        team.barrier();
      });
    for (const long sum : sums) EXPECT_EQ(sum, 200 * 201 / 2 * size * (size + 1) / 2);
  }
  EXPECT_THROW(Team(0), InternalError);
}

}  // namespace
}  // namespace palpate
