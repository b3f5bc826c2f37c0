#include "stable_step.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

#include "integrate/multirate.h"
#include "palpate/contact/contact_force.h"
#include "palpate/core/error.h"
#include "palpate/integrate/integrators.h"

// With y = [q; u] and the accelerations K = M^-1 K, D = M^-1 D of a linearisation, y' = A y,
//     A = [0 1; -K -D].
// symplectic-euler   u1 = u0 - h (K q0 + D u0), q1 = q0 + h u1:   [1 - h^2 K  h (1 - h D); -h K  1 - h D]
// rk4                R(z) = 1 + z + z^2/2 + z^3/6 + z^4/24 at z = h times each eigenvalue of A
// multi-rate         integrate::multirate_amplification of A = S + F, contact and fast terms in F
// An unconstrained body has eigenvalues 1, which rounding spreads.

namespace palpate::validation {
namespace {

constexpr double kRounding = 1e-6, kShortest = 1e-4;

struct Linearised {
  MatX K, D;
};

MatX over_mass(loop::World& world, double d_scale, double k_scale, const dynamics::System::TermFilter& side) {
  dynamics::BorderedMatrix A, M;
  world.system.step_matrix(world.state.view(), 0.0, d_scale, k_scale, A, side);
  const MatX dense = A.to_dense();
  world.system.step_matrix(world.state.view(), 1.0, 0.0, 0.0, M, side);
  return M.to_dense().lu().solve(dense);
}

Linearised linearised(loop::World& world, const dynamics::System::TermFilter& side = {}) {
  return {over_mass(world, 0.0, 1.0, side), over_mass(world, 1.0, 0.0, side)};
}

MatX first_order(const Linearised& of, bool with_velocity = true) {
  const Eigen::Index n = of.K.rows();
  MatX A = MatX::Zero(2 * n, 2 * n);
  if (with_velocity) A.topRightCorner(n, n).setIdentity();
  A.bottomLeftCorner(n, n) = -of.K;
  A.bottomRightCorner(n, n) = -of.D;
  return A;
}

double symplectic_euler(const Linearised& of, double h) {
  const Eigen::Index n = of.K.rows();
  const MatX one = MatX::Identity(n, n);
  MatX step(2 * n, 2 * n);
  step << one - h * h * of.K, h * (one - h * of.D), -h * of.K, one - h * of.D;
  return step.eigenvalues().cwiseAbs().maxCoeff();
}

double rk4(const Linearised& of, double h) {
  const Eigen::ArrayXcd z = h * first_order(of).eigenvalues().array();
  return (1.0 + z * (1.0 + z / 2.0 * (1.0 + z / 3.0 * (1.0 + z / 4.0)))).abs().maxCoeff();
}

double multi_rate(const std::string& method, loop::World& world, double h) {
  const auto side = [](bool fast) {
    return [fast](const dynamics::TermTraits& t) { return (t.fast || t.contact) == fast; };
  };
  return integrate::multirate_amplification(method, first_order(linearised(world, side(false))),
                                            first_order(linearised(world, side(true)), false), h);
}

double amplification(const dynamics::StepperEntry& entry, loop::World& world, double h) {
  if (entry.traits.family == "multi-rate") return multi_rate(entry.name, world, h);
  if (entry.traits.stability != dynamics::Stability::kExplicit) return 1.0;
  if (entry.name == "symplectic-euler") return symplectic_euler(linearised(world), h);
  if (entry.name == "rk4") return rk4(linearised(world), h);
  fail("the stability limit of integrator \"{}\" is unknown", entry.name);
}

}  // namespace

double stable_step(const std::string& method, loop::World& world, double longest) {
  const auto& entry = find(integrate::stepper_registry(), method, "integrator");
  if (world.contact) world.contact->refresh(world.state.view());
  double h = longest;
  while (amplification(entry, world, h) > 1.0 + kRounding) {
    h /= 2.0;
    if (h < kShortest * longest) fail("{} is stable at no step above {} s", method, h);
  }
  return h;
}

}  // namespace palpate::validation
