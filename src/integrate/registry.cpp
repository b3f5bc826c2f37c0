#include "integrate/make.h"
#include "integrate/robust_solver.h"
#include "integrate/sundials/ark_methods.h"
#include "palpate/integrate/integrators.h"
#include "palpate/linear/solvers.h"

namespace palpate::integrate {

using dynamics::Stability;
using dynamics::StepControl;

namespace {

/// In the order in which they are listed and compared: by SUNDIALS, then by hand.
dynamics::StepperRegistry make_registry() {
  dynamics::StepperRegistry all = {
      {"cvode-bdf",
       "backward differences of SUNDIALS CVODE, order 1 to 5 (max_order)",
       {"BDF", 5, 5, StepControl::kAdaptive, Stability::kAlpha, true, true, "force, tangent"},
       make_cvode},
      {"cvode-adams",
       "Adams-Moulton of SUNDIALS CVODE, order 1 to 12 (max_order), fixed-point iteration",
       {"Adams", 12, 0, StepControl::kAdaptive, Stability::kExplicit, false, true, "force"},
       make_cvode},
      {"ida",
       "backward differences of SUNDIALS IDA on the residual M u' - f, order 1 to 5 (max_order)",
       {"BDF", 5, 5, StepControl::kAdaptive, Stability::kAlpha, true, true, "force, tangent"},
       make_ida},
  };
  for (const ArkMethod& m : ark_methods()) all.push_back({m.name, m.summary, m.traits, make_ark});
  const auto multi_rate = [](int order, int stiff_order) {
    return dynamics::StepperTraits{
        "multi-rate",  order, stiff_order, StepControl::kFixed,
        Stability::kA, true,  false,       "force, tangent; contact and tool as the fast side"};
  };
  all.push_back({"ark-mri-2",
                 "multi-rate IRK21a of Sandu 2019: bodies by an implicit slow step, contact and tool fast",
                 multi_rate(2, 2), make_mri});
  all.push_back({"ark-mri-3", "multi-rate ESDIRK34a of Sandu 2019", multi_rate(3, 2), make_mri});
  all.push_back({"ark-mri-4", "multi-rate ESDIRK46a of Sandu 2019", multi_rate(4, 2), make_mri});
  all.push_back({"kinsol-static",
                 "quasi-static equilibrium of SUNDIALS KINSOL: no inertia, no velocity",
                 {"statics", 1, 1, StepControl::kFixed, Stability::kStatic, true, false, "force, tangent"},
                 make_kinsol_static});
  const dynamics::StepperRegistry by_hand = {
      {"linearly-implicit-euler",
       "one linear solve a step; the interactive method of Galoppo et al. 2007",
       {"Euler", 1, 1, StepControl::kFixed, Stability::kL, true, false, "force, tangent", "auto"},
       make_linearly_implicit_euler},
      {"backward-euler",
       "backward Euler, Newton to its end; full, or a factor kept over factor_kept_steps",
       {"Euler", 1, 1, StepControl::kFixed, Stability::kL, true, false, "force, tangent", "auto"},
       make_backward_euler},
      {"implicit-midpoint",
       "implicit midpoint rule, Newton to its end; keeps quadratic invariants; no numerical damping",
       {"Gauss", 2, 2, StepControl::kFixed, Stability::kA, true, false, "force, tangent", "auto"},
       make_implicit_midpoint},
      {"bdf2",
       "backward differences of order 2 with variable steps; starts by an L-stable SDIRK step of order 2",
       {"BDF", 2, 2, StepControl::kFixed, Stability::kL, true, true, "force, tangent", "auto"},
       make_bdf2},
      {"newmark",
       "Newmark 1959, average acceleration (beta = 1/4, gamma = 1/2); no numerical damping",
       {"Newmark", 2, 2, StepControl::kFixed, Stability::kA, true, false, "force, tangent", "auto"},
       make_newmark},
      {"generalized-alpha",
       "Chung and Hulbert 1993; damps high frequencies by spectral_radius a step",
       {"Newmark", 2, 2, StepControl::kFixed, Stability::kA, true, false, "force, tangent", "auto"},
       make_generalized_alpha},
      {"symplectic-euler",
       "velocity first, then position; one force a step, stable below 2/w_max",
       {"explicit Euler", 1, 0, StepControl::kFixed, Stability::kExplicit, false, false, "force"},
       make_symplectic_euler},
      {"rk4",
       "the classical Runge-Kutta method of order 4; four forces a step, stable below 2.8/w_max",
       {"explicit Runge-Kutta", 4, 0, StepControl::kFixed, Stability::kExplicit, false, false, "force"},
       make_rk4},
  };
  all.insert(all.end(), by_hand.begin(), by_hand.end());
  return all;
}

}  // namespace

const dynamics::StepperRegistry& stepper_registry() {
  static const dynamics::StepperRegistry registry = make_registry();
  return registry;
}

std::unique_ptr<dynamics::Stepper> make_stepper(dynamics::System& system, dynamics::State& state,
                                                const IntegratorSpec& spec) {
  const auto& entry = find(stepper_registry(), spec.name, "integrator");
  // a wrong name is refused even where it would not be used
  if (!spec.linear_solver.empty())
    find(linear::linear_solver_registry(), spec.linear_solver, "linear solver");
  const std::string solver = linear_solver_of(spec);
  return entry.make(system, state, spec, solver.empty() ? nullptr : linear::make_linear_solver(solver, spec));
}

std::string linear_solver_of(const IntegratorSpec& spec) {
  const dynamics::StepperTraits& traits = find(stepper_registry(), spec.name, "integrator").traits;
  if (!traits.implicit) return {};
  if (!spec.linear_solver.empty()) return spec.linear_solver;
  return spec.factor_kept_steps > 1 ? "cholmod" : traits.linear_solver;
}

std::unique_ptr<dynamics::LinearSolver> make_robust_linear_solver(const std::string& name,
                                                                  const IntegratorSpec& spec) {
  return std::make_unique<RobustSolver>(linear::make_linear_solver(name, spec));
}

}  // namespace palpate::integrate
