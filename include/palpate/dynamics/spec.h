#pragma once
#include <string>

#include "palpate/core/keys.h"

namespace palpate {

/// Integrator by name and its settings.  Plain data, the `[integrator]` table of a scene.
/// A scene that sets what its method has no use for is refused (the registries say which keys an entry uses);
/// here, where every field has a value, a method ignores the others.
struct IntegratorSpec {
  std::string name = "cvode-bdf";  ///< see `palpate list integrators`
  double rtol = 1e-3;              ///< adaptive methods: relative tolerance
  double atol_q = 0.01;            ///< absolute tolerance of q is atol_q * rtol * the block's q_scale
  double atol_u = 0.1;             ///< the same for u
  double step_s = 1e-3;            ///< fixed-step methods [s]
  bool fixed_step = false;         ///< methods that can do both: steps of step_s in place of error control
  int max_order = 0;               ///< cap on the order; 0: the method's own
  int max_steps = 100000;          ///< internal steps between two outputs before giving up
  /// hand-written implicit methods: steps that one tangent and factor serve (1: full Newton)
  int factor_kept_steps = 1;
  /// hand-written implicit methods: Newton ends when its correction, in the units of rtol, is below this
  double newton_rtol = 1e-8;
  /// generalized-alpha: of the amplification at infinite frequency, in [0, 1]
  double spectral_radius = 0.8;
  /// how a kink of the force is met: "error-control", or "root-finding" with a restart at the root
  std::string events = "error-control";
  /// ImEx: what is explicit beside what is not stiff: "loads", or "contact" (contact and loads)
  std::string explicit_side = "loads";
  /// a step matrix that is not positive definite: "project" (definite tangent), then LU; or "lu" at once
  std::string indefinite = "project";
  std::string linear_solver = {};  ///< empty: the method's own (StepperTraits::linear_solver)
  /// iterative linear solvers: relative residual of "pcg"; relative error, in the energy norm, of the others,
  /// which under error control end as well where the error is a small share of Newton's tolerance
  double linear_rtol = 1e-8;
  /// of the whole run, the caller's included: elements, and linear solvers that can share their work; results
  /// do not depend on it
  int threads = 1;
};

/// What the settings may be: checked by the loader of scenes, and by the methods that use them.
struct IntegratorRanges {
  /// relative tolerance
  static constexpr Range rtol{.low = 0.0, .high = 0.1, .low_open = true, .remedy = "1e-3 is usual"};
  static constexpr Range atol_q = Range::positive("0.01 is usual");  ///< [1]
  static constexpr Range atol_u = Range::positive("0.1 is usual");   ///< [1]
  static constexpr Range step_s = Range::positive("1e-3 is usual");  ///< [s]
  /// highest order of a multistep method
  static constexpr Range max_order = Range::closed(0, 12, "0 leaves the order to the method");
  /// a count
  static constexpr Range max_steps = Range::at_least(1, "it bounds the internal steps between two outputs");
  static constexpr Range factor_kept_steps = Range::at_least(1, "1 is full Newton");  ///< a count of steps
  static constexpr Range newton_rtol =
      Range::closed(1e-14, 0.1, "1e-8 is usual");  ///< share of the tolerance
  /// amplification at infinite frequency
  static constexpr Range spectral_radius =
      Range::closed(0.0, 1.0, "0 damps what the step cannot resolve at once, 1 not at all");
  static constexpr Range linear_rtol = Range::closed(1e-15, 0.1, "1e-8 is usual");  ///< relative residual
  /// a count
  static constexpr Range threads = Range::closed(1, 64, "results do not depend on it");
};

}  // namespace palpate
