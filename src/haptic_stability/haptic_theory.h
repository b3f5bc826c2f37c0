#pragma once
#include "loop/haptic_loop_model.h"
#include "palpate/core/types.h"

/// What theory says of one axis of a haptic loop (docs/theory/passivity.md).  K and B below are stiffness and
/// damping of the coupling; with the tool held they are those of the virtual wall.
namespace palpate::haptic_stability {

using loop::HapticLoopModel;

/// Colgate and Schenkel (1997): the wall is passive at the handle, whatever passive arm holds it, where
/// b > K T/2 + |B|.  With n ticks of delay, b > (2n + 1) K T/2 + |B|; b is the device's alone.
/// @return K at B [N/m], 0 where no K is passive
double passive_stiffness(const HapticLoopModel& loop, double damping);
bool is_passive(const HapticLoopModel& loop);  ///< with the coupling of `loop` as the wall

/// Gil, Sanchez, Hulin, Preusche and Hirzinger (2009): K < (b + B)/(T/2 + t_d), t_d the delay.  Asymptotic
/// for (b + B) (T/2 + t_d) << m, where it is necessary and sufficient; too large beyond.
/// @return K at B [N/m]
double delay_bound_stiffness(const HapticLoopModel& loop, double damping);

/// The exact linear map of a tick of the loop, the wall two-sided.
/// @throws Error for a tool integrator that is not one of the two with a fixed tick
MatX loop_matrix(const HapticLoopModel& loop);
double spectral_radius(const HapticLoopModel& loop);
bool is_stable(const HapticLoopModel& loop);  ///< spectral radius <= 1, to rounding

/// Where the search of the largest K begins and ends [N/m].
inline constexpr double kSoftest = 1.0, kStiffest = 1e8;

/// The largest K at B below which every K >= kSoftest is stable; 0 where kSoftest is not, infinite where
/// kStiffest is.
double spectral_stiffness(HapticLoopModel loop, double damping);
/// The same by simulation (loop::simulate_virtual_wall), to the relative width `width` of the bisection.
double simulated_stiffness(HapticLoopModel loop, double damping, double duration_s, double width = 2e-3);
/// The largest B at which kSoftest is stable: Z-width ends there.
double largest_damping(HapticLoopModel loop);

}  // namespace palpate::haptic_stability
