#include "integrate/error_test.h"
#include "integrate/make.h"
#include "integrate/robust_solver.h"
#include "integrate/settings.h"
#include "integrate/sundials/ark_methods.h"
#include "palpate/integrate/integrators.h"
#include "palpate/linear/solvers.h"

namespace palpate::integrate {

using dynamics::Stability;
using dynamics::StepControl;

namespace {

using Keys = std::vector<std::string>;

/// Keys of all implicit methods, in addition to those of each method. make_registry() adds `rtol` where there
/// is an error test, and `threads`, which any method uses.
const Keys kImplicit = {"linear_solver", "indefinite"};
const Keys kFixed = {"step_s", "max_steps"};

Keys together(Keys keys, const Keys& more) {
  keys.insert(keys.end(), more.begin(), more.end());
  return keys;
}
std::vector<PartKey> with(const Keys& keys, const Keys& more) { return part_keys(together(keys, more)); }

/// Returns the key `rtol` with the range that the method accepts at the defaults of its other settings.
PartKey rtol_key(double (*tightest_rtol)(const IntegratorSpec&), const std::string& name) {
  return {.name = "rtol", .range = rtol_range(tightest_rtol({.name = name}))};
}

std::vector<PartKey> adaptive_keys(int highest_order, bool implicit) {
  std::vector<PartKey> keys =
      with({"atol_q", "atol_u", "max_steps", "events"}, implicit ? kImplicit : Keys{});
  keys.push_back({.name = "max_order", .range = order_range(highest_order)});
  return keys;
}

/// Keys of methods with error control or fixed steps, where newton_rtol replaces rtol.
std::vector<PartKey> ark_keys(const dynamics::StepperTraits& traits) {
  Keys keys = {"atol_q", "atol_u", "max_steps", "events", "fixed_step", "step_s"};
  if (traits.implicit) keys = together(together(keys, kImplicit), {"newton_rtol"});
  if (traits.family == "ImEx Runge-Kutta") keys.push_back("explicit_side");
  return part_keys(keys);
}

/// Lists the methods of SUNDIALS.
dynamics::StepperRegistry methods_of_sundials() {
  dynamics::StepperRegistry all = {
      {"cvode-bdf",
       "backward differences of SUNDIALS CVODE, order 1 to 5 (max_order)",
       {"BDF", 5, 5, StepControl::kAdaptive, Stability::kAlpha, true, true, "force, tangent"},
       make_cvode,
       adaptive_keys(5, true),
       error_test_rtol_of_bdf,
       tightest_rtol_of_bdf},
      {"cvode-adams",
       "Adams-Moulton of SUNDIALS CVODE, order 1 to 12 (max_order), fixed-point iteration",
       {"Adams", 12, 0, StepControl::kAdaptive, Stability::kExplicit, false, true, "force"},
       make_cvode,
       adaptive_keys(12, false),
       error_test_rtol_of_adams,
       tightest_rtol_of_adams},
      {"ida",
       "backward differences of SUNDIALS IDA on the residual M u' - f, order 1 to 5 (max_order)",
       {"BDF", 5, 5, StepControl::kAdaptive, Stability::kAlpha, true, true, "force, tangent"},
       make_ida,
       adaptive_keys(5, true),
       error_test_rtol_of_bdf,
       tightest_rtol_of_bdf},
  };
  for (const ArkMethod& m : ark_methods())
    all.push_back({m.name, m.summary, m.traits, make_ark, ark_keys(m.traits), error_test_rtol_of_ark,
                   tightest_rtol_of_ark});
  const auto multi_rate = [](int order, int stiff_order) {
    return dynamics::StepperTraits{
        "multi-rate",  order, stiff_order, StepControl::kFixed,
        Stability::kA, true,  false,       "force, tangent; contact and tool as the fast part"};
  };
  const std::vector<PartKey> mri_keys =
      with({"step_s", "max_steps", "newton_rtol", "atol_q", "atol_u", "events"}, kImplicit);
  all.push_back(
      {"ark-mri-2",
       "multi-rate IRK21a of Sandu 2019: implicit slow steps for bodies, fast steps for contact and tool",
       multi_rate(2, 2), make_mri, mri_keys, error_test_rtol_of_mri, tightest_rtol_of_mri});
  all.push_back({"ark-mri-3", "multi-rate ESDIRK34a of Sandu 2019", multi_rate(3, 2), make_mri, mri_keys,
                 error_test_rtol_of_mri, tightest_rtol_of_mri});
  all.push_back({"ark-mri-4", "multi-rate ESDIRK46a of Sandu 2019", multi_rate(4, 2), make_mri, mri_keys,
                 error_test_rtol_of_mri, tightest_rtol_of_mri});
  all.push_back({"kinsol-static",
                 "quasi-static equilibrium by SUNDIALS KINSOL: no inertia, no velocity",
                 {"statics", 1, 1, StepControl::kFixed, Stability::kStatic, true, false, "force, tangent"},
                 make_kinsol_static,
                 with({"newton_rtol"}, kImplicit)});
  return all;
}

/// Lists the hand-written methods.
dynamics::StepperRegistry methods_by_hand() {
  const Keys newton_keys =
      together(together(kFixed, kImplicit), {"newton_rtol", "atol_q", "atol_u", "factor_kept_steps"});
  return {
      {"linearly-implicit-euler",
       "linearly implicit Euler: one linear solve per step; the interactive method of Galoppo et al. 2007",
       {"Euler", 1, 1, StepControl::kFixed, Stability::kL, true, false, "force, tangent", "auto", true},
       make_linearly_implicit_euler,
       with(kFixed, kImplicit)},
      {"linearly-implicit-bdf2",
       "backward differences of order 2, linearized: one linear solve per step, as accurate as bdf2 where "
       "forces are smooth",
       {"BDF", 2, 2, StepControl::kFixed, Stability::kL, true, true, "force, tangent", "auto", true},
       make_linearly_implicit_bdf2,
       with(kFixed, kImplicit)},
      {"backward-euler",
       "backward Euler, Newton iterated to convergence: full Newton, or a factor reused over "
       "factor_kept_steps steps",
       {"Euler", 1, 1, StepControl::kFixed, Stability::kL, true, false, "force, tangent", "auto"},
       make_backward_euler,
       part_keys(newton_keys)},
      {"implicit-midpoint",
       "implicit midpoint rule, Newton iterated to convergence; preserves quadratic invariants; no numerical "
       "damping",
       {"Gauss", 2, 2, StepControl::kFixed, Stability::kA, true, false, "force, tangent", "auto"},
       make_implicit_midpoint,
       part_keys(newton_keys)},
      {"bdf2",
       "backward differences of order 2 with variable steps; the first step is an L-stable SDIRK step of "
       "order 2",
       {"BDF", 2, 2, StepControl::kFixed, Stability::kL, true, true, "force, tangent", "auto"},
       make_bdf2,
       part_keys(newton_keys)},
      {"newmark",
       "Newmark 1959, average acceleration (beta = 1/4, gamma = 1/2); no numerical damping",
       {"Newmark", 2, 2, StepControl::kFixed, Stability::kA, true, false, "force, tangent", "auto"},
       make_newmark,
       part_keys(newton_keys)},
      {"generalized-alpha",
       "Chung and Hulbert 1993; damps high frequencies by the factor spectral_radius per step",
       {"Newmark", 2, 2, StepControl::kFixed, Stability::kA, true, false, "force, tangent", "auto"},
       make_generalized_alpha,
       with(newton_keys, {"spectral_radius"})},
      {"symplectic-euler",
       "velocity first, then position; one force evaluation per step, stable below 2/w_max",
       {"explicit Euler", 1, 0, StepControl::kFixed, Stability::kExplicit, false, false, "force"},
       make_symplectic_euler,
       part_keys(kFixed)},
      {"rk4",
       "classical Runge-Kutta method of order 4; four force evaluations per step, stable below 2.8/w_max",
       {"explicit Runge-Kutta", 4, 0, StepControl::kFixed, Stability::kExplicit, false, false, "force"},
       make_rk4,
       part_keys(kFixed)},
  };
}

/// Lists the integrators in the order in which they are listed and compared.
dynamics::StepperRegistry make_registry() {
  dynamics::StepperRegistry all = methods_of_sundials();
  const dynamics::StepperRegistry by_hand = methods_by_hand();
  all.insert(all.end(), by_hand.begin(), by_hand.end());
  for (dynamics::StepperEntry& entry : all) {
    if (entry.tightest_rtol) entry.keys.push_back(rtol_key(entry.tightest_rtol, entry.name));
    entry.keys.push_back({.name = "threads"});
  }
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
  // An unknown name is rejected even where it would not be used.
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

std::optional<double> error_test_rtol_of(const IntegratorSpec& spec) {
  const auto& entry = find(stepper_registry(), spec.name, "integrator");
  if (!entry.error_test_rtol || spec.fixed_step) return {};
  return entry.error_test_rtol(spec);
}

std::unique_ptr<dynamics::LinearSolver> make_robust_linear_solver(const std::string& name,
                                                                  const IntegratorSpec& spec) {
  return std::make_unique<RobustSolver>(linear::make_linear_solver(name, spec), spec);
}

}  // namespace palpate::integrate
