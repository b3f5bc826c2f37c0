#include <cmath>

#include "cases.h"
#include "faults.h"
#include "palpate/core/error.h"
#include "palpate/dynamics/system.h"
#include "palpate/fem/attachments.h"
#include "palpate/fem/soft_body.h"
#include "palpate/integrate/integrators.h"
#include "palpate/linear/solvers.h"
#include "palpate/mesh/generators.h"
#include "palpate/modes/modes.h"

// Problem: largest stable step of symplectic Euler on the highest mode of a soft bar, q'' + 2 z w q' + w^2
// q = 0, W = w h, velocity first and then q1 = q0 + h u1.
//
// Exact answer (linear stability theory):
// - damping at the old velocity, u1 = u0 - h (w^2 q0 + 2 z w u0), characteristic polynomial
//       r^2 - (2 - W^2 - 2 z W) r + (1 - 2 z W);
//   roots inside the circle while 1 + trace + determinant > 0, 4 - W^2 - 4 z W > 0:
//       W < 2 (sqrt(1 + z^2) - z);
// - damping at the new velocity, u1 = u0 - h (w^2 q0 + 2 z w u1), characteristic polynomial
//       (1 + 2 z W) r^2 - (2 + 2 z W - W^2) r + 1;
//   4 + 4 z W - W^2 > 0:
//       W < 2 (sqrt(1 + z^2) + z).
// Undamped both are W < 2. With stiffness damping z = beta w/2 both limits fall with w: the highest mode has
// the smallest, and it is excited.
//
// Measured: above the limit the amplitude grows by a factor per step, so the limit is found by bisection on
// whether it has grown a thousandfold; accepted within 2 %. The implicit variant is not an integrator of the
// registry: M (u1 - u0) = h f(q0, u1), f linear in u, is solved here with the System's step matrix, (M + h D)
// du = h f(q0, u0).

namespace palpate::validation {
namespace {

constexpr double kAmplitude = 1e-9;    // [m]: the body remains linear when grown a thousandfold
constexpr double kDampingRatio = 0.4;  // Damping ratio of the highest mode.

struct Bar {
  TetMesh rest = mesh::box(Vec3(0.10, 0.03, 0.03), {6, 2, 2});
  fem::Material material;
  dynamics::State state;
  dynamics::System system;
  VecX q0;

  Bar(double beta, const std::string& fault) {
    material.youngs_modulus = 1e5;
    material.stiffness_damping = fault == "no-damping" ? 0.0 : beta;
    q0 = rest.nodes.reshaped();
    dynamics::BlockSpec spec;
    spec.name = "bar";
    spec.q_size = spec.u_size = static_cast<int>(q0.size());
    spec.q_scale = kAmplitude;
    const int id = state.insert(spec, q0, VecX::Zero(q0.size()));
    std::shared_ptr<dynamics::ForceTerm> elastic =
        std::make_shared<fem::SoftBody>("bar", rest, material, fem::SoftBodyOptions{}, id);
    if (fault == "stiffer") elastic = scaled(elastic, {.force = 1.1});
    system.add(elastic);
    const auto mass = fem::make_lumped_mass(rest, material.density, id);
    system.add(fault == "lighter" ? scaled(mass, 0.9) : mass);
    std::vector<int> clamped;
    for (int i = 0; i < rest.nodes.cols(); ++i)
      for (int axis = 0; axis < 3 && rest.nodes(0, i) < -0.05 + 1e-9; ++axis) clamped.push_back(3 * i + axis);
    system.add(fem::make_fixed(clamped, q0(clamped)));
    system.prepare(state.view());
  }
  double amplitude() const { return (state.q() - q0).cwiseAbs().maxCoeff(); }
  void excite(const VecX& shape) {
    state.set_time(0.0);
    state.q() = q0 + kAmplitude * shape / shape.cwiseAbs().maxCoeff();
    state.u().setZero();
  }
};

enum class Damping { kOld, kNew };

/// Performs one step of u1 = u0 + h M^-1 f(q0, u1), q1 = q0 + h u1.
void step_damped_at_new(Bar& bar, double h, dynamics::LinearSolver& solver) {
  dynamics::BorderedMatrix A;
  VecX f, du;
  bar.system.force(bar.state.view(), f);
  bar.system.reduce(bar.state.view(), f);
  bar.system.step_matrix(bar.state.view(), 1.0, h, 0.0, A);
  PALPATE_CHECK(solver.factor(A) == dynamics::SolveStatus::kOk, "M + h D has no factor");
  solver.solve(VecX(h * f), du);
  bar.state.u() += du;
  bar.state.q() += h * bar.state.u();
}

/// Returns whether the mode has grown a thousandfold within 300 steps.
bool grows(double h, double beta, Damping damping, const VecX& shape, const std::string& fault) {
  constexpr int kSteps = 300;
  Bar bar(beta, fault);
  bar.excite(shape);
  IntegratorSpec spec;
  spec.name = fault == "implicit" ? "backward-euler" : "symplectic-euler";
  spec.step_s = h;
  const auto stepper = integrate::make_stepper(bar.system, bar.state, spec);
  const auto solver = linear::make_linear_solver("cholmod");
  for (int i = 1; i <= kSteps; ++i) {
    if (damping == Damping::kNew)
      step_damped_at_new(bar, h, *solver);
    else if (!stepper->advance_to(i * h).ok())
      return true;
    if (!(bar.amplitude() < 1e3 * kAmplitude)) return true;
  }
  return false;
}

/// Returns the largest stable step [s] between half and twice the expected one.
double found_limit(double expected, double beta, Damping damping, const VecX& shape,
                   const std::string& fault) {
  double low = 0.5 * expected, high = 2.0 * expected;
  if (grows(low, beta, damping, shape, fault)) return low;
  if (!grows(high, beta, damping, shape, fault)) return high;
  while (high - low > 1e-3 * expected) {
    const double middle = 0.5 * (low + high);
    (grows(middle, beta, damping, shape, fault) ? high : low) = middle;
  }
  return 0.5 * (low + high);
}

std::vector<Measurement> run(const std::string& fault) {
  Bar bar(0.0, "");
  const modes::Modes modes =
      modes::find_modes(bar.system, bar.state.view(), {1, modes::ModesOptions::End::kHighest});
  const double w = modes.omega(0), z = kDampingRatio, beta = 2.0 * z / w, root = std::sqrt(1.0 + z * z);
  const VecX shape = modes.shapes.col(0);
  std::vector<Measurement> out;
  const auto add = [&](const std::string& what, double exact, double damping, Damping kind) {
    const double found = found_limit(exact, damping, kind, shape, fault);
    out.push_back({.quantity = "largest stable step [s], " + what,
                   .computed = found,
                   .exact = exact,
                   .error = std::abs(found / exact - 1.0),
                   .bar = 0.02,
                   .note = fmt::format("highest mode {:.4g} rad/s, by bisection", w)});
  };
  add("undamped", 2.0 / w, 0.0, Damping::kOld);
  add("damping at the old velocity, ratio 0.4", 2.0 / w * (root - z), beta, Damping::kOld);
  add("damping at the new velocity, ratio 0.4", 2.0 / w * (root + z), beta, Damping::kNew);
  return out;
}

}  // namespace

ValidationCase explicit_limit() {
  return {.name = "explicit-limit",
          .section = "D",
          .summary =
              "largest stable step of symplectic Euler: undamped, damped at the old and at the new velocity",
          .why =
              "the highest frequency determines the cost of an explicit method on a stiff body; linear "
              "stability theory",
          .quick = true,
          .run = run,
          .faults = {{"stiffer", "largest stable step"},
                     {"lighter", "largest stable step"},
                     {"no-damping", "damping at"},
                     {"implicit", "undamped"}}};
}

}  // namespace palpate::validation
