#pragma once
#include <cmath>
#include <complex>
#include <limits>
#include <vector>

#include "palpate/tool/tool.h"

/// What the tool's tests share: a one-degree-of-freedom oscillator in closed form, continuous and discrete, and a few makers.
namespace palpate::tool::testing {

/// m y'' + b y' + k y = 0 from y = y0 at rest; underdamped.
struct Oscillator {
  double m, b, k;
  /// y(t) = y0 e^{-g t} (cos w t + g/w sin w t), g = b/2m, w^2 = k/m - g^2.
  double displacement(double y0, double t) const {
    const double g = b / (2 * m), w = std::sqrt(k / m - g * g);
    return y0 * std::exp(-g * t) * (std::cos(w * t) + g / w * std::sin(w * t));
  }
  /// y_n of a two-term recurrence a2 y_{n+1} + a1 y_n + a0 y_{n-1} = 0 with its first two values: A z1^n + B z2^n over the roots.
  static double recurrence(double a2, double a1, double a0, double y0, double y1, int n) {
    const std::complex<double> root = std::sqrt(std::complex<double>(a1 * a1 - 4 * a2 * a0, 0.0));
    const auto z1 = (-a1 + root) / (2 * a2), z2 = (-a1 - root) / (2 * a2);
    const auto B = (y1 - y0 * z1) / (z2 - z1), A = y0 - B;
    return (A * std::pow(z1, n) + B * std::pow(z2, n)).real();
  }
  // Backward Euler, y_{n+1} = y_n + h u_{n+1} and m (u_{n+1} - u_n) = -h (b u_{n+1} + k y_{n+1}); with u = differences of y over h:
  //   (m + h b + h^2 k) y_{n+1} - (2 m + h b) y_n + m y_{n-1} = 0, started by u_0 = 0: (m + h b + h^2 k) y_1 = (m + h b) y_0.
  double backward_euler(double y0, double h, int n) const {
    const double a = m + h * b + h * h * k;
    return recurrence(a, -(2 * m + h * b), m, y0, (m + h * b) / a * y0, n);
  }
  // Semi-implicit Euler, m (u_{n+1} - u_n) = -h (b u_n + k y_n):
  //   m y_{n+1} - (2 m - h b - h^2 k) y_n + (m - h b) y_{n-1} = 0, started by m y_1 = (m - h^2 k) y_0.
  double semi_implicit_euler(double y0, double h, int n) const {
    return recurrence(m, -(2 * m - h * b - h * h * k), m - h * b, y0, (1 - h * h * k / m) * y0, n);
  }
  double discrete(const std::string& scheme, double y0, double h, int n) const {
    return scheme == "linearly-implicit-euler" ? backward_euler(y0, h, n) : semi_implicit_euler(y0, h, n);
  }
};

inline ToolSpec spec_for(const std::string& integrator) {
  ToolSpec spec;
  spec.integrator = integrator;
  spec.mass_kg = 0.1;
  spec.inertia_kg_m2 = Vec3(3e-5, 4e-5, 5e-5);
  spec.coupling_stiffness_n_m = 300.0;
  spec.coupling_damping_n_s_m = 2.0;
  spec.coupling_rotational_stiffness_n_m_rad = 0.3;
  spec.coupling_rotational_damping_n_m_s_rad = 1e-3;
  return spec;
}

inline HandleMotion held(const Pose& pose) { return {pose, pose, {}, {}}; }

/// A contact that pushes along z with K times the depth below z = 0.
inline dynamics::LinearisedContact wall(double K) {
  dynamics::LinearisedContact record;
  record.version = 1;
  record.source = dynamics::LinearisedContact::Source::kFrozen;
  record.J[6 * 5 + 5] = -K;
  return record;
}

/// Least-squares slope of log(error) against log(h).
inline double slope(const std::vector<double>& h, const std::vector<double>& e) {
  double x = 0, y = 0, xx = 0, xy = 0;
  const double n = static_cast<double>(h.size());
  for (std::size_t i = 0; i < h.size(); ++i) {
    const double a = std::log(h[i]), b = std::log(e[i]);
    x += a, y += b, xx += a * a, xy += a * b;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

}  // namespace palpate::tool::testing
