#pragma once
#include "palpate/dynamics/system.h"

namespace palpate::modes {

/// Selection of modes.
struct ModesOptions {
  /// End of the spectrum.
  enum class End { kLowest, kHighest };
  int count = 10;          ///< Number of modes; limited to the number of free directions.
  End end = End::kLowest;  ///< End of the spectrum to compute.
};

/// Solutions of K phi = w^2 M phi, the free vibrations of a system about a state: x = x0 + phi cos(w t).
struct Modes {
  /// w^2 [1/s^2], from the end of the spectrum inwards. Negative where the state is an unstable equilibrium;
  /// 0 for a rigid motion.
  VecX omega_squared;
  /// Mode shapes, u_size x modes, along u-directions: M-orthonormal on the free directions, the largest entry
  /// there positive. Driven directions move with their master; without a master they are zero.
  MatX shapes;
  /// |K phi - w^2 M phi| / |K phi|; for a rigid motion |K phi| over the norm of its summands.
  VecX residuals;
  bool converged = false;               ///< Every residual is at most 1e-8, or at rounding.
  long factorisations = 0, solves = 0;  ///< Numeric factorisations, and solves with them.

  /// Returns the number of modes found.
  int count() const { return static_cast<int>(omega_squared.size()); }
  double omega(int mode) const;         ///< Returns w [rad/s]; 0 where w^2 is not positive.
  double frequency_hz(int mode) const;  ///< Returns w / 2 pi [Hz].
};

/// Computes the lowest or highest modes of the system at a state, without damping. K is the tangent at that
/// state (including contact and the effect of gravity), M is lumped or consistent; driven directions are
/// held. Deterministic: the start vector is fixed, no random numbers are used. Derivation and method:
/// src/modes/modes.cpp.
/// @throws Error where the tangent is unsymmetric, there is no free direction, options.count is less than 1,
///   the mass is not positive definite, or the numbers are not finite
Modes find_modes(dynamics::System& system, const dynamics::StateView& state,
                 const ModesOptions& options = {});

}  // namespace palpate::modes
