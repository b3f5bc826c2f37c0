#pragma once
#include "palpate/dynamics/system.h"

namespace palpate::modes {

/// Which modes are wanted.
struct ModesOptions {
  /// Which end of the spectrum.
  enum class End { kLowest, kHighest };
  int count = 10;          ///< modes wanted; as many as there are free directions where that is fewer
  End end = End::kLowest;  ///< of the spectrum
};

/// Solutions of K phi = w^2 M phi, the free vibrations of a system about a state: x = x0 + phi cos(w t).
struct Modes {
  /// w^2 [1/s^2]; from the end of the spectrum inwards.  Negative where the state is an unstable equilibrium;
  /// 0 of a rigid motion
  VecX omega_squared;
  /// u_size x modes, along u-directions: M-orthonormal, the largest entry positive; driven directions move
  /// with their master, else not at all
  MatX shapes;
  /// |K phi - w^2 M phi| / |K phi|; of a rigid motion |K phi| over the norm of its summands
  VecX residuals;
  bool converged = false;               ///< every residual is at most 1e-8, or at rounding
  long factorisations = 0, solves = 0;  ///< numeric factorisations, and solves with them

  /// Number of modes that were found.
  int count() const { return static_cast<int>(omega_squared.size()); }
  double omega(int mode) const;         ///< [rad/s]; 0 where w^2 is not positive
  double frequency_hz(int mode) const;  ///< w / 2 pi
};

/// The lowest or highest modes of the system at a state, damping left out.  K is the tangent there (contact
/// and gravity's effect on it included), M lumped or consistent; driven directions are held.  Deterministic:
/// a fixed start vector, no random numbers. Derivation and method: src/integrate/modes.cpp.
/// @throws Error where the tangent is unsymmetric, there is no free direction, or the numbers are not finite
Modes find_modes(dynamics::System& system, const dynamics::StateView& state,
                 const ModesOptions& options = {});

}  // namespace palpate::modes
