#pragma once
#include <memory>

#include "coupled_tool.h"
#include "palpate/dynamics/linear_solver.h"
#include "palpate/dynamics/matrix.h"

/// One linearly implicit Euler step of the bodies over an exchange period, from which a tool's contact is
/// linearised (condensation.cpp, model_reduction.cpp).
namespace palpate::loop {

/// Factor of the system's step matrix, by LU if it is indefinite (an inverted element, a compressed strut).
/// Solvers are created on demand.
class StepFactor {
 public:
  /// Factors A = M + H D + H^2 K at a state. Returns null if it is singular.
  dynamics::LinearSolver* of(dynamics::System& system, const dynamics::StateView& state, double H);

 private:
  dynamics::BorderedMatrix matrix_;
  std::unique_ptr<dynamics::LinearSolver> symmetric_, lu_;
};

/// Returns the coordinates moved by a displacement along u-directions.
VecX moved(const dynamics::State& state, const VecX& displacement);
/// Computes the prescribed part of the step over H: displacements s [m] and velocity changes w [m/s].
void known_motion(const dynamics::System& system, const dynamics::State& state, double H, VecX& s, VecX& w);
/// Returns the rate of change of the nodal forces due to the motion of the other tools [N/s]; empty without
/// contact.
VecX rate_by_other_tools(const CoupledTool& tool);
/// Returns H (f + H rate - K s - D w) - M w on free directions.
/// @param rate  from rate_by_other_tools()
VecX right_hand_side(dynamics::System& system, const dynamics::State& state, double H, const VecX& s,
                     const VecX& w, const VecX& rate);

}  // namespace palpate::loop
