#include <gtest/gtest.h>

#include "integrate/registry_test_name.h"
#include "palpate/dynamics/system.h"
#include "palpate/fem/attachments.h"
#include "palpate/fem/soft_body.h"
#include "palpate/integrate/integrators.h"
#include "palpate/linear/solvers.h"
#include "palpate/mesh/generators.h"

namespace palpate {
namespace {

using namespace dynamics;

/// A soft beam with one end held, that falls under gravity and swings.
struct Cantilever {
  State state;
  System system;
  VecX rest;
  Cantilever() {
    const TetMesh mesh = mesh::box(Vec3(0.4, 0.1, 0.1), {8, 2, 2});
    const auto n = static_cast<int>(mesh.nodes.cols());
    rest = mesh.nodes.reshaped();
    const int id =
        state.insert(BlockSpec{.name = "beam", .q_size = 3 * n, .u_size = 3 * n}, rest, VecX::Zero(3 * n));
    const fem::Material material{
        .youngs_modulus = 1e5, .poissons_ratio = 0.4, .density = 1000.0, .stiffness_damping = 1e-3};
    system.add(std::static_pointer_cast<ForceTerm>(
        std::make_shared<fem::SoftBody>("beam", mesh, material, fem::SoftBodyOptions{}, id)));
    system.add(fem::make_gravity(fem::lumped_masses(mesh, material.density), Vec3(0, 0, -9.81), id));
    system.add(fem::make_lumped_mass(mesh, material.density, id));
    const std::vector<int> held = fem::dofs_of_nodes(
        fem::nodes_in_box(mesh.nodes, Vec3(-0.2 - 1e-9, -1, -1), Vec3(-0.2 + 1e-9, 1, 1)), 0, "xyz");
    VecX x0(static_cast<Eigen::Index>(held.size()));
    for (std::size_t i = 0; i < held.size(); ++i) x0[static_cast<Eigen::Index>(i)] = rest[held[i]];
    system.add(fem::make_fixed(held, x0));
    system.prepare(state.view());
  }
};

StepperCounters swing(Cantilever& beam, const std::string& linear_solver) {
  const auto stepper = integrate::make_stepper(
      beam.system, beam.state, {.name = "cvode-bdf", .rtol = 1e-5, .linear_solver = linear_solver});
  const StepResult result = stepper->advance_to(0.2);
  EXPECT_TRUE(result.ok()) << result.message;
  return stepper->counters();
}

class SoftCantilever : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Registry, SoftCantilever, testing::ValuesIn(names(linear::linear_solver_registry())),
                         registry_test_name);

// Every linear solver is exact within CVODE's accuracy, so that the steps are the same, and the trajectories
// differ by less than CVODE's tolerance.
TEST_P(SoftCantilever, SwingsTheSameWithEveryLinearSolver) {
  Cantilever beam, direct;
  const StepperCounters c = swing(beam, GetParam()), reference = swing(direct, "cholmod");
  const double moved = (direct.state.q() - direct.rest).cwiseAbs().maxCoeff();
  ASSERT_GT(moved, 0.01);
  EXPECT_LT((beam.state.q() - direct.state.q()).cwiseAbs().maxCoeff(), 1e-5 * moved);
  EXPECT_NEAR(static_cast<double>(c.steps), static_cast<double>(reference.steps),
              0.05 * static_cast<double>(reference.steps));
  EXPECT_NEAR(static_cast<double>(c.newton_iterations), static_cast<double>(reference.newton_iterations),
              0.05 * static_cast<double>(reference.newton_iterations));
  EXPECT_EQ(c.newton_failures, reference.newton_failures);
  EXPECT_EQ(c.indefinite, 0);
  EXPECT_EQ(c.unconverged, 0);
  EXPECT_EQ(c.solver.symbolic, 1) << "no LU was made";
  EXPECT_EQ(c.solver.iterations > 0,
            GetParam().starts_with("pcg") || GetParam() == "auto" || GetParam() == "gmres");
}

}  // namespace
}  // namespace palpate
