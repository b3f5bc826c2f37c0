#pragma once
#include "loop/one_axis_loop.h"
#include "palpate/core/types.h"

/// Stability and passivity theory for one axis of a haptic loop (docs/theory/passivity.md). K and B below are
/// stiffness and damping of the coupling; with the tool held they are the stiffness and damping of the
/// virtual wall. T is the tick.
namespace palpate::haptic_stability {

using loop::OneAxisLoop;

/// Returns the largest stiffness at damping B for which the wall is passive at the handle, whatever passive
/// arm holds the handle: b > K T/2 + |B| (Colgate and Schenkel 1997); with n ticks of delay b > (2n + 1) K
/// T/2 + |B|. b is the damping of the device alone, without the arm.
/// @return K at B [N/m], 0 if no K is passive
double passive_stiffness(const OneAxisLoop& loop, double damping);
bool is_passive(const OneAxisLoop& loop);  ///< Whether the coupling of `loop` is passive as a wall

/// Returns the stiffness limit of a delayed loop, K < (b + B)/(T/2 + t_d), where t_d is the delay and b the
/// damping of device and arm (Gil, Sanchez, Hulin, Preusche and Hirzinger 2009). The condition is asymptotic:
/// necessary and sufficient for (b + B) (T/2 + t_d) << m, and too large beyond.
/// @return K at B [N/m]
double delay_bound_stiffness(const OneAxisLoop& loop, double damping);

/// Returns the exact linear map of one tick of the loop, with a two-sided wall; the state is defined in
/// haptic_theory.cpp.
/// @throws Error for a tool integrator that is not one of the two with a fixed tick
MatX loop_matrix(const OneAxisLoop& loop);
/// Returns the spectral radius of loop_matrix().
double spectral_radius(const OneAxisLoop& loop);
bool is_stable(const OneAxisLoop& loop);  ///< Whether the spectral radius is <= 1, to rounding

/// Bounds of the search for the largest K [N/m].
inline constexpr double kSoftest = 1.0, kStiffest = 1e8;

/// Returns the largest K at B [N/m] below which every K >= kSoftest is stable; 0 if kSoftest is unstable,
/// infinite if kStiffest is stable.
double spectral_stiffness(OneAxisLoop loop, double damping);
/// Returns the limit of spectral_stiffness() found by simulation (loop::simulate_virtual_wall) for
/// `duration_s` each, by bisection to the relative width `width`.
double simulated_stiffness(OneAxisLoop loop, double damping, double duration_s, double width = 2e-3);
/// Returns the largest B [N s/m] at which kSoftest is stable; the Z-width ends there.
double largest_damping(OneAxisLoop loop);

}  // namespace palpate::haptic_stability
