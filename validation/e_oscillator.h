#pragma once
#include <cmath>
#include <complex>
#include <string>

#include "palpate/tool/tool.h"

/// Damped oscillator m y'' + b y' + k y = 0 released at rest from y0: one direction of a virtual coupling, in
/// time and in ticks.
namespace palpate::validation {

struct Oscillator {
  double m, b, k;

  /// Returns y0 e^{-g t} (cos w t + g/w sin w t), g = b/2m, w^2 = k/m - g^2 > 0.
  double at_time(double y0, double t) const {
    const double g = b / (2 * m), w = std::sqrt(k / m - g * g);
    return y0 * std::exp(-g * t) * (std::cos(w * t) + g / w * std::sin(w * t));
  }

  // With u = differences of y over h, eliminate u from y_{n+1} = y_n + h u_{n+1} and the scheme:
  // - backward Euler, m (u_{n+1} - u_n) = -h (b u_{n+1} + k y_{n+1}), gives
  //       (m + hb + h^2 k) y_{n+1} - (2m + hb) y_n + m y_{n-1} = 0;
  // - semi-implicit Euler, m (u_{n+1} - u_n) = -h (b u_n + k y_n), gives
  //       m y_{n+1} - (2m - hb - h^2 k) y_n + (m - hb) y_{n-1} = 0.
  //
  // The start is u_0 = 0. The solution is A z1^n + B z2^n over the roots of the recurrence.
  double after_ticks(const std::string& scheme, double y0, double h, int n) const {
    const double hb = h * b, hhk = h * h * k;
    const bool implicit = scheme == "linearly-implicit-euler";
    const double a2 = implicit ? m + hb + hhk : m, a1 = implicit ? -(2 * m + hb) : -(2 * m - hb - hhk),
                 a0 = implicit ? m : m - hb;
    const double y1 = implicit ? (m + hb) / a2 * y0 : (1 - hhk / m) * y0;
    const std::complex<double> root = std::sqrt(std::complex<double>(a1 * a1 - 4 * a2 * a0));
    const auto z1 = (-a1 + root) / (2 * a2), z2 = (-a1 - root) / (2 * a2);
    const auto B = (y1 - y0 * z1) / (z2 - z1), A = y0 - B;
    return (A * std::pow(z1, n) + B * std::pow(z2, n)).real();
  }
};

/// Returns the tool of a desktop device: 100 g, three different moments of inertia, an underdamped coupling
/// in every direction.
inline ToolSpec desktop_tool(const std::string& integrator) {
  ToolSpec spec;
  spec.integrator = integrator;
  spec.mass_kg = 0.1;
  spec.inertia_kg_m2 = Vec3(3e-5, 4e-5, 5e-5);
  spec.coupling.stiffness_n_m = 300.0;
  spec.coupling.damping_n_s_m = 2.0;
  spec.coupling.rotational_stiffness_n_m_rad = 0.3;
  spec.coupling.rotational_damping_n_m_s_rad = 1e-3;
  return spec;
}

}  // namespace palpate::validation
