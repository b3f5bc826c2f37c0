#pragma once
#include <memory>

#include "palpate/core/registry.h"
#include "palpate/dynamics/stepper.h"
#include "tick_input.h"

namespace palpate::tool {

class SimbodyBody;

/// Integrator that advances the tool by one tick.
class TickScheme {
 public:
  virtual ~TickScheme() = default;
  /// Advances `motion` from input.t0 to input.t0 + input.h. On failure `motion` is unspecified; the caller
  /// keeps the last valid one.
  virtual dynamics::StepResult advance(const TickInput& input, RigidMotion& motion) = 0;
  /// Clears history, after the motion was changed from outside or the last advance was rejected.
  virtual void reset() {}
};

/// Sets the twist to u and advances the pose with it: x1 = x0 + h u1 along a straight line, and a rotation by
/// exp(h omega1), which is exact for a fixed axis.
void move(RigidMotion& motion, double h, const Vec6& u);
/// Returns the equation of a linearly implicit Euler step for the change of u over a tick.
StepEquation linearly_implicit_step(SimbodyBody& body, const TickInput& input, const RigidMotion& motion);

using MakeTickScheme = std::unique_ptr<TickScheme> (*)(SimbodyBody&);
/// Returns the integrators by the name in `tool.integrator`.
const Registry<MakeTickScheme>& tick_scheme_registry();

std::unique_ptr<TickScheme> make_semi_implicit_euler(SimbodyBody& body);
std::unique_ptr<TickScheme> make_linearly_implicit_euler(SimbodyBody& body);
std::unique_ptr<TickScheme> make_runge_kutta_merson(SimbodyBody& body);
std::unique_ptr<TickScheme> make_semi_explicit_euler2(SimbodyBody& body);
std::unique_ptr<TickScheme> make_cpodes(SimbodyBody& body);

}  // namespace palpate::tool
