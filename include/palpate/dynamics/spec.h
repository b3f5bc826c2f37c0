#pragma once
#include <array>
#include <string>
#include <string_view>

#include "palpate/core/keys.h"

namespace palpate {

/// Treatment of kinks of the force: by error control, or by root finding with a restart at the root.
enum class KinkTreatment { kErrorControl, kRootFinding };
/// Returns the names of the values.
constexpr std::array<std::string_view, 2> option_names(KinkTreatment) {
  return {"error-control", "root-finding"};
}

/// Forces that an ImEx method integrates explicitly in addition to the non-stiff ones: loads, or contact and
/// loads.
enum class ExplicitSide { kLoads, kContact };
/// Returns the names of the values.
constexpr std::array<std::string_view, 2> option_names(ExplicitSide) { return {"loads", "contact"}; }

/// Treatment of a step matrix that is not positive definite: the definite tangent, then LU; or LU at once.
enum class IndefiniteTreatment { kProject, kLu };
/// Returns the names of the values.
constexpr std::array<std::string_view, 2> option_names(IndefiniteTreatment) { return {"project", "lu"}; }

/// Integrator by name and its settings. Plain data, the `[integrator]` table of a scene.
/// A scene that sets a key which its method does not use is rejected (the registries list the keys of each
/// entry). In this struct every field has a value, and a method ignores those it does not use.
struct IntegratorSpec {
  std::string name = "cvode-bdf";  ///< Name; see `palpate list integrators`.
  double rtol = 1e-3;              ///< Adaptive methods: relative tolerance.
  double atol_q = 0.01;            ///< Absolute tolerance of q is atol_q * rtol * the block's q_scale.
  double atol_u = 0.1;             ///< Absolute tolerance of u is atol_u * rtol * the block's u_scale.
  double step_s = 1e-3;            ///< Fixed-step methods: step [s].
  bool fixed_step = false;         ///< Methods with both modes: steps of step_s in place of error control.
  int max_order = 0;               ///< Limit on the order; 0: the method's highest.
  int max_steps = 100000;          ///< Largest number of internal steps between two outputs.
  /// Hand-written implicit methods: number of steps that share one tangent and factor (1: full Newton).
  int factor_kept_steps = 1;
  /// Fixed-step implicit methods: Newton's method stops when its correction, in the units of rtol, is below
  /// this. Statics: it stops when the residual, relative to the largest force, is below this.
  double newton_rtol = 1e-8;
  /// generalized-alpha: spectral radius at infinite frequency, in [0, 1].
  double spectral_radius = 0.8;
  KinkTreatment events = KinkTreatment::kErrorControl;  ///< Treatment of kinks of the force.
  ExplicitSide explicit_side = ExplicitSide::kLoads;    ///< ImEx: forces integrated explicitly.
  /// Treatment of a step matrix that is not positive definite.
  IndefiniteTreatment indefinite = IndefiniteTreatment::kProject;
  /// Linear solver; empty: the method's default (StepperTraits::linear_solver).
  std::string linear_solver = {};
  /// Iterative linear solvers: relative residual of "pcg"; relative error, in the energy norm, of the others.
  /// Under error control the latter also stop where the error is a small share of Newton's tolerance.
  double linear_rtol = 1e-8;
  /// Threads of the whole run, including the caller's: for elements, and for linear solvers that can share
  /// their work. Results do not depend on it.
  int threads = 1;
};

/// Permitted ranges of the settings, checked by the loader of scenes and by the methods that use them.
struct IntegratorRanges {
  /// Relative tolerance.
  static constexpr Range rtol{.low = 0.0, .high = 0.1, .low_open = true, .remedy = "1e-3 is usual"};
  static constexpr Range atol_q = Range::positive("0.01 is usual");  ///< Dimensionless.
  static constexpr Range atol_u = Range::positive("0.1 is usual");   ///< Dimensionless.
  static constexpr Range step_s = Range::positive("1e-3 is usual");  ///< Step [s].
  /// Highest order of a multistep method.
  static constexpr Range max_order = Range::closed(0, 12, "with 0 the method chooses the order");
  /// Number of internal steps.
  static constexpr Range max_steps = Range::at_least(1, "it bounds the internal steps between two outputs");
  static constexpr Range factor_kept_steps = Range::at_least(1, "1 is full Newton");  ///< Number of steps.
  static constexpr Range newton_rtol =
      Range::closed(1e-14, 0.1, "1e-8 is usual");  ///< Share of the tolerance.
  /// Spectral radius at infinite frequency.
  static constexpr Range spectral_radius =
      Range::closed(0.0, 1.0, "0 removes unresolved frequencies in one step, 1 does not damp them");
  /// Relative residual, or relative error in the energy norm.
  static constexpr Range linear_rtol = Range::closed(1e-15, 0.1, "1e-8 is usual");
  /// Number of threads.
  static constexpr Range threads = Range::closed(1, 64, "results do not depend on it");
};

}  // namespace palpate
