// Results of bodies alone depend neither on units nor on size (units_scenes.h): statics, steps and modes.
#include <gtest/gtest.h>

#include <limits>

#include "loop/modes.h"
#include "palpate/linear/solvers.h"
#include "units_scenes.h"

namespace palpate {
namespace {

using namespace units_scenes;

// --- Statics

/// Linear displacement of the beam: one solve with the initial tangent.
VecX linear_response(const Scene& s, const Units& units) {
  const auto world = loop::assemble(loop::parse(text_of(s, units), "units.toml"));
  VecX f, x;
  world->system.force(world->state.view(), f);
  world->system.reduce(world->state.view(), f);
  dynamics::BorderedMatrix K;
  world->system.step_matrix(world->state.view(), 0.0, 0.0, 1.0, K);
  const auto solver = linear::make_linear_solver("cholmod");
  EXPECT_EQ(solver->factor(K), dynamics::SolveStatus::kOk);
  EXPECT_EQ(solver->solve(f, x), dynamics::SolveStatus::kOk);
  return x / units.length;
}

// Twelve decades of gravity, from loads at which rotations matter to loads at which a displacement is
// 1e-14 of the beam. A node's position has a rounding error of eps times its magnitude, 0.2 m, and a force
// one of eps |K||x|, which moves the slender beam by about ten times more: this limits the comparison of
// displacements.
TEST(Units, EquilibriaFollowTheLoadOverTwelveDecades) {
  for (const Units& units : kUnits) {
    const double rounding = 100.0 * std::numeric_limits<double>::epsilon() * 0.2;
    for (int decade = 0; decade <= 12; ++decade) {
      SCOPED_TRACE(fmt::format("{}, gravity 1e{}", units.name, 2 - decade));
      Scene s;
      s.gravity = Vec3(0, 0, -std::pow(10.0, 2 - decade));
      const Result found = result_of(s, units);
      ASSERT_EQ(found.error, "");
      EXPECT_LE(found.counters.solver.factorisations, 10);
      EXPECT_EQ(found.counters.newton_failures, 0);
      if (decade >= 5) { EXPECT_GT(found.counters.rounding_limited, 0); }
      const VecX linear = linear_response(s, units);
      // the nonlinear part decreases with the load: 1e-3 of the displacement for the first load
      const double bent = linear.cwiseAbs().maxCoeff() / s.size.x();
      EXPECT_LE((found.q - linear).cwiseAbs().maxCoeff(),
                std::max(kRelative, bent) * linear.cwiseAbs().maxCoeff() + rounding);
    }
  }
}

TEST(Units, LargeBendingUnderADeadLoad) {
  Scene s;
  s.young = 1e5;
  s.gravity = Vec3(0, 0, -2);
  expect_same_in_all_units(s);
}

// --- Fixed steps

class FixedSteps : public testing::TestWithParam<std::string> {};
TEST_P(FixedSteps, AreTheSameInAllUnits) { expect_same_in_all_units(swinging(GetParam())); }
INSTANTIATE_TEST_SUITE_P(Units, FixedSteps,
                         testing::Values("linearly-implicit-euler", "backward-euler", "implicit-midpoint",
                                         "bdf2", "newmark", "generalized-alpha"));

class LinearSolvers : public testing::TestWithParam<std::string> {};
TEST_P(LinearSolvers, AreTheSameInAllUnits) {
  Scene s = swinging("linearly-implicit-euler");
  s.settings = fmt::format("linear_solver = \"{}\"", GetParam());
  if (!find(linear::linear_solver_registry(), GetParam(), "linear solver").keys.empty())
    s.solver_settings = "linear_rtol = 1e-9";
  expect_same_in_all_units(s);
}
std::vector<std::string> linear_solvers() {
  std::vector<std::string> names;
  for (const auto& entry : linear::linear_solver_registry()) names.push_back(entry.name);
  return names;
}
INSTANTIATE_TEST_SUITE_P(Units, LinearSolvers, testing::ValuesIn(linear_solvers()));

class ExplicitSteps : public testing::TestWithParam<std::string> {};
TEST_P(ExplicitSteps, AreTheSameInAllUnits) {
  Scene s = swinging(GetParam());
  s.step = 2e-4;
  s.duration = 0.04;
  expect_same_in_all_units(s);
}
INSTANTIATE_TEST_SUITE_P(Units, ExplicitSteps, testing::Values("symplectic-euler", "rk4"));

// --- Error control

class ErrorControl : public testing::TestWithParam<std::string> {};
TEST_P(ErrorControl, IsTheSameInAllUnits) {
  Scene s = swinging(GetParam());
  s.settings = "rtol = 1e-5";
  s.duration = 0.05;
  expect_same_in_all_units(s, kBinaryUnits);
}
INSTANTIATE_TEST_SUITE_P(Units, ErrorControl,
                         testing::Values("cvode-bdf", "cvode-adams", "ida", "ark-erk-4", "ark-dirk-esdirk324",
                                         "ark-imex-3"));

// --- Modes

TEST(Units, FrequenciesAndShapesOfModes) {
  for (const bool held : {true, false}) {
    Scene s;
    s.held = held;
    modes::Modes first;
    for (const Units& units : kUnits) {
      SCOPED_TRACE(fmt::format("{}, {}", units.name, held ? "held" : "free"));
      const auto world = loop::assemble(loop::parse(text_of(s, units), "units.toml"));
      modes::Modes found = loop::find_modes(*world, 9);
      EXPECT_TRUE(found.converged);
      if (&units == kUnits) first = found;
      ASSERT_EQ(found.count(), first.count());
      for (int j = 0; j < found.count(); ++j)
        EXPECT_NEAR(found.omega_squared[j], first.omega_squared[j], kRelative * first.omega_squared[j]) << j;
      // M-orthonormal: x M x = 1; a square section has pairs of modes, of which any rotation is equally valid
      const double size = first.shapes.leftCols(2).norm();
      if (held) {
        EXPECT_NEAR(std::sqrt(units.mass) * found.shapes.leftCols(2).norm(), size, kRelative * size);
      }
    }
  }
}

}  // namespace
}  // namespace palpate
