// Steps a soft body: a bar of tissue hangs from its upper end and stretches under gravity until it is at
// rest. At rest the elongation is rho g L^2 / 2E.
#include <cstdio>

#include "palpate/fem/attachments.h"
#include "palpate/fem/soft_body.h"
#include "palpate/integrate/integrators.h"
#include "palpate/mesh/generators.h"

using namespace palpate;

int main() {
  const double length = 0.1, g = 9.81;  // [m], [m/s^2]
  const fem::Material tissue{
      .youngs_modulus = 1e5, .poissons_ratio = 0.0, .density = 1000.0, .stiffness_damping = 0.01};
  const TetMesh mesh = mesh::box({0.02, 0.02, length}, {4, 4, 20});
  const VecX rest = mesh.nodes.reshaped(), masses = fem::lumped_masses(mesh, tissue.density);
  const int n = static_cast<int>(rest.size());

  // The state has positions q [m] and velocities u [m/s] of all nodes, three numbers per node.
  dynamics::State state;
  const int bar = state.insert({.name = "bar", .q_size = n, .u_size = n}, rest, VecX::Zero(n));

  // The system M u' = f is a sum of force terms, with one mass term and the held directions.
  const std::vector<int> held = fem::dofs_of_nodes(
      fem::nodes_in_box(mesh.nodes, {-1, -1, length / 2 - 1e-9}, {1, 1, length / 2 + 1e-9}), 0, "xyz");
  dynamics::System system;
  system.add(std::make_shared<fem::SoftBody>("bar", mesh, tissue, fem::SoftBodyOptions{}, bar));
  system.add(fem::make_lumped_mass(mesh, tissue.density, bar));
  system.add(fem::make_gravity(masses, {0, 0, -g}, bar));
  system.add(fem::make_fixed(held, rest(held)));
  system.prepare(state.view());

  // Any integrator of `palpate list integrators`; a failure is data (StepResult::status), not an exception.
  const auto stepper = integrate::make_stepper(system, state, {.name = "cvode-bdf", .rtol = 1e-4});
  const dynamics::StepResult result = stepper->advance_to(2.0);
  const double longer = -length / 2 - Points(state.q().reshaped(3, n / 3)).row(2).minCoeff();
  std::printf("%s at %g s after %ld steps: longer by %.6g m, by theory rho g L^2 / 2E = %.6g m\n",
              to_string(result.status), result.t, stepper->counters().steps, longer,
              tissue.density * g * length * length / (2.0 * tissue.youngs_modulus));
}
