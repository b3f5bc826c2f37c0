#include "haptic_stability/haptic_theory.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "palpate/core/error.h"

// Loop at tick k. The device is sampled, x_k = x(kT); its velocity is the backward difference w_k = (x_k -
// x_{k-1})/T; the tool advances over the tick (y, u); the coupling force is F_k = -K (x_k - y_k) - B (w_k -
// u_k); the motors hold F_k over [kT + n T, (k+1)T + n T).
//
// Passivity of the wall (y = u = 0). E is the work that the hand does on device and wall up to tick N, in
// terms of the samples. With D_k = x_k - x_{k-1}, the work of the held force is F_{k-1-n} D_k exactly, and
// the device dissipates at least b D_k^2/T over a tick (Cauchy-Schwarz inequality), so
//     E >= sum -F_{k-1-n} D_k + b D_k^2/T.
// For n = 0, K x_{k-1} D_k = K/2 (x_k^2 - x_{k-1}^2) - K/2 D_k^2 and B D_{k-1} D_k/T >= -|B| (D_k^2 +
// D_{k-1}^2)/2T:  E >= K/2 (x_N^2 - x_0^2) + (b/T - K/2 - |B|/T) sum D^2. A delay moves the sample of K by n
// differences, x_{k-1-n} = x_{k-1} - D_{k-1} - ... - D_{k-n}, each of which costs at most a further K D^2:
//     b > (2n + 1) K T/2 + |B|.
// The condition is also necessary for B >= 0 and n = 0 (triangle wave of period 2T) and for B = 0 (n = 0, or
// a slow sine): Colgate and Schenkel (1997). With both a delay and B it is sufficient.
//
// Delay bound. A zero-order hold delays by T/2 on average; with t = T/2 + n T the loop is
//     m s^2 + b s + (K + B s) exp(-s t) = 0,   exp(-s t) = 1 - s t + ...:
//     (m + ...) s^2 + (b + B - K t) s + K = 0,
// whose roots have negative real parts for K < (b + B)/t. The neglected terms are O((b + B) t/m).
//
// Spectral radius. The state (x, v, w, y, u, q_0 .. q_n) holds the device, its measured velocity, the tool,
// and the forces in transit; q_0 is held in the coming tick. A step is linear in the state, so the columns of
// its matrix are the steps of the unit vectors. The device is integrated exactly (arm_transition), the tool
// by its scheme (tool/fixed_tick.cpp).

namespace palpate::haptic_stability {
namespace {

constexpr double kRounding = 1e-12;
enum State { kX, kV, kW, kY, kU, kQ };

/// Advances the state of the loop by one tick.
class Step {
 public:
  explicit Step(const OneAxisLoop& loop)
      : l_(loop),
        a_(device::arm_transition(loop.device.arm(), loop.tick_s)),
        implicit_(loop.tool_integrator == "linearly-implicit-euler") {
    if (!loop.tool_held && !implicit_ && loop.tool_integrator != "semi-implicit-euler")
      fail(
          "haptic stability: tool.integrator = \"{}\" has no fixed linear map; take "
          "\"linearly-implicit-euler\" or \"semi-implicit-euler\"",
          loop.tool_integrator);
    PALPATE_CHECK(loop.tick_s > 0.0 && loop.device.mass_kg > 0.0 && loop.delay_ticks >= 0,
                  "tick {} s, mass {} kg, delay {} ticks", loop.tick_s, loop.device.mass_kg,
                  loop.delay_ticks);
  }
  int size() const { return kQ + l_.delay_ticks + 1; }

  VecX operator()(const VecX& s) const {
    VecX out = VecX::Zero(s.size());
    const double F = s[kQ];
    out.head<2>() = a_ * Eigen::Vector4d(s[kX], s[kV], F, 0.0);
    out[kW] = (out[kX] - s[kX]) / l_.tick_s;
    if (!l_.tool_held) tool(s, out);
    const int n = l_.delay_ticks;
    for (int i = 0; i < n; ++i) out[kQ + i] = s[kQ + i + 1];
    out[kQ + n] =
        -l_.coupling_stiffness_n_m * (out[kX] - out[kY]) - l_.coupling_damping_n_s_m * (out[kW] - out[kU]);
    return out;
  }

 private:
  void tool(const VecX& s, VecX& out) const {
    const double h = l_.tick_s, k = l_.coupling_stiffness_n_m, b = l_.coupling_damping_n_s_m,
                 K = l_.contact_stiffness_n_m, B = l_.contact_damping_n_s_m;
    const VecX& handle = implicit_ ? out : s;  // at the end of the tick, or at its start
    const double f = k * (handle[kX] - s[kY]) + b * (handle[kW] - s[kU]) - K * s[kY] - B * s[kU];
    const double du = implicit_
                          ? h * (f - h * (k + K) * s[kU]) / (l_.tool_mass_kg + h * (b + B) + h * h * (k + K))
                          : h * f / l_.tool_mass_kg;
    out[kU] = s[kU] + du;
    out[kY] = s[kY] + h * out[kU];
  }

  const OneAxisLoop& l_;
  Eigen::Matrix<double, 2, 4> a_;
  bool implicit_;
};

double loop_delay(const OneAxisLoop& loop) { return (0.5 + loop.delay_ticks) * loop.tick_s; }

/// Returns the largest K on a geometric sequence of ratio `ratio` before the first unstable one, refined by
/// bisection.
double largest_stiffness(OneAxisLoop& loop, const std::function<bool()>& stable, double ratio, double width) {
  double& k = loop.coupling_stiffness_n_m;
  double low = 0.0, high = kSoftest;
  while (k = high, stable()) {
    if (high >= kStiffest) return std::numeric_limits<double>::infinity();
    low = high;
    high = std::min(high * ratio, kStiffest);
  }
  if (low == 0.0) return 0.0;
  while (high > (1.0 + width) * low) {
    k = std::sqrt(low * high);
    (stable() ? low : high) = k;
  }
  return low;
}

}  // namespace

double passive_stiffness(const OneAxisLoop& loop, double damping) {
  return std::max(0.0, (loop.device.damping_n_s_m - std::abs(damping)) / loop_delay(loop));
}

bool is_passive(const OneAxisLoop& loop) {
  return loop.device.damping_n_s_m >
         loop_delay(loop) * loop.coupling_stiffness_n_m + std::abs(loop.coupling_damping_n_s_m);
}

double delay_bound_stiffness(const OneAxisLoop& loop, double damping) {
  return std::max(0.0, (loop.device.total_damping() + damping) / loop_delay(loop));
}

MatX loop_matrix(const OneAxisLoop& loop) {
  const Step step(loop);
  MatX A(step.size(), step.size());
  for (int i = 0; i < step.size(); ++i) A.col(i) = step(VecX::Unit(step.size(), i));
  return A;
}

double spectral_radius(const OneAxisLoop& loop) {
  // units: metres, ticks, and the coupling force; the similarity transform keeps the eigenvalues and reduces
  // rounding errors
  MatX A = loop_matrix(loop);
  const double rate = 1.0 / loop.tick_s;
  VecX unit = VecX::Constant(
      A.rows(), loop.coupling_stiffness_n_m + std::abs(loop.coupling_damping_n_s_m) * rate + 1e-30);
  unit.head<kQ>() << 1.0, rate, rate, 1.0, rate;
  A = unit.cwiseInverse().asDiagonal() * A * unit.asDiagonal();
  return Eigen::EigenSolver<MatX>(A, false).eigenvalues().cwiseAbs().maxCoeff();
}

bool is_stable(const OneAxisLoop& loop) {
  // without arm and wall the loop drifts: the eigenvalue 1 of the drift may be increased by rounding
  const bool drifts =
      !loop.tool_held && loop.contact_stiffness_n_m <= 0.0 && loop.device.arm_stiffness_n_m <= 0.0;
  return spectral_radius(loop) <= 1.0 + (drifts ? 1e3 * kRounding : kRounding);
}

double spectral_stiffness(OneAxisLoop loop, double damping) {
  loop.coupling_damping_n_s_m = damping;
  return largest_stiffness(
      loop, [&] { return is_stable(loop); }, 1.1, 1e-9);
}

double simulated_stiffness(OneAxisLoop loop, double damping, double duration_s, double width) {
  loop.coupling_damping_n_s_m = damping;
  return largest_stiffness(
      loop, [&] { return loop::simulate_virtual_wall(loop, duration_s).stable; }, 2.0, width);
}

double largest_damping(OneAxisLoop loop) {
  loop.coupling_stiffness_n_m = kSoftest;
  double low = 0.0, high = 1e-3;
  const auto stable = [&](double damping) {
    loop.coupling_damping_n_s_m = damping;
    return is_stable(loop);
  };
  while (stable(high)) {
    if (high > kStiffest) return std::numeric_limits<double>::infinity();
    low = high;
    high *= 1.5;
  }
  while (high - low > 1e-6 * high) (stable(0.5 * (low + high)) ? low : high) = 0.5 * (low + high);
  return low;
}

}  // namespace palpate::haptic_stability
