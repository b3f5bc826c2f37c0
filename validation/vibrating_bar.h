#pragma once
#include "palpate/dynamics/matrix.h"
#include "palpate/dynamics/spec.h"
#include "palpate/fem/material.h"
#include "palpate/mesh/mesh.h"

namespace palpate::dynamics {
class State;
}

namespace palpate::validation {

/// Clamped bar of corotational tetrahedra at rest, its K and M, and some of its modes from a dense solver of
/// Eigen that no integrator uses. M q'' + D q' + K (q - q0) = 0 with K phi_j = w_j^2 M phi_j and D = beta K
/// decouples into one oscillator per mode,
///     q(t) = q0 + sum_j phi_j e^{-g_j t} (cos v_j t + (g_j/v_j) sin v_j t),
///     g_j = beta w_j^2/2,   v_j^2 = w_j^2 - g_j^2,
/// exact in time, so no reference run is needed.
struct VibratingBar {
  static constexpr int kModes = 3;
  TetMesh rest;
  fem::Material material;
  VecX q0, mass;  ///< Rest positions [m]; lumped masses [kg], one per direction.
  VecX omega;     ///< Frequencies of the excited modes [rad/s], ascending: the lowest three, or all.
  MatX phi;       ///< Their shapes, zero where clamped, largest entry 1.
  double highest_omega = 0.0;  ///< Highest frequency of the spectrum [rad/s].
  dynamics::BorderedMatrix K;
  std::vector<int> clamped;  ///< Directions of u.

  explicit VibratingBar(bool all_modes = false);
  double period() const { return 2.0 * 3.14159265358979323846 / omega[0]; }  ///< Lowest mode's [s].
  int insert(dynamics::State& state, double amplitude) const;
  VecX displacement(double t, double beta) const;
  double norm(const VecX& d) const;  ///< Mass-weighted norm.

 private:
  void find_modes(bool all);
};

struct VibrationTrial {
  double T = 0.0;     ///< [s]
  int samples = 1;    ///< Number of times at which the error is evaluated, the last at T.
  double beta = 0.0;  ///< Stiffness damping [s].
  /// Amplitude [m] of the corotational body; 0: the linear body at amplitude 1, so that rounding does not
  /// hide a small error.
  double amplitude = 0.0;
};

/// Returns the mass-weighted relative error of q, RMS over the samples; NaN if the integrator fails. Faults:
/// "force-off-by-one-percent", "first-order-rule" (backward Euler for any requested method),
/// "tolerance-ignored".
double vibration_error(const VibratingBar& bar, const IntegratorSpec& spec, const VibrationTrial& trial,
                       const std::string& fault);

}  // namespace palpate::validation
