#pragma once
#include <string>

namespace palpate {

/// Integrator by name and its settings.  Plain data, the `[integrator]` table of a scene.
struct IntegratorSpec {
  std::string name = "cvode-bdf";
  double rtol = 1e-3;                ///< adaptive methods: relative tolerance
  double atol_q = 0.01;              ///< absolute tolerance of q is atol_q * rtol * the block's q_scale
  double atol_u = 0.1;               ///< the same for u
  double step_s = 1e-3;              ///< fixed-step methods [s]
  int max_order = 0;                 ///< cap on the order; 0: the method's own
  int max_steps = 100000;            ///< internal steps between two outputs before giving up
  std::string linear_solver = "cholmod";
};

}  // namespace palpate
