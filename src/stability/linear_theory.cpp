#include <cmath>

#include "linear.h"

// Expectations of the linear, contact-free rows, from theory alone.  The problem is M q'' + D q' + K q = 0, D
// and K positive, in first order form y' = A y.  In the inner product of the energy, Re<y, A y> = -u.D u <=
// 0.
//
// 1. A-stable one-step methods, any step.  y1 = R(H A) y0 with |R| <= 1 in the left half plane, and by von
//    Neumann's theorem (Hairer and Wanner, Solving ODEs II, thm IV.11.2) the norm of R(H A) is at most sup
//    |R| over Re z <= 0, that is 1: the energy never rises.
//      -> accurate, stable
// 2. A-stable multistep methods, any step.  They are power bounded (and G-stable: Dahlquist 1978), in a norm
//    that weighs the last steps together; the energy itself may rise by a constant factor, never again and
//    again.
//      -> accurate, stable, bounded
//    Methods of the family of Newmark with dissipation (generalised-alpha) carry the acceleration along, and
//    overshoot in the first step (Hilber and Hughes 1978; "U0-V1" in Zhou and Tamma 2004).  From d0 at rest,
//    a0 = -w^2 d0, with y = w H large, r = 2 z/y (the same for all modes), b and c Newmark's beta and gamma:
//    the equation of the step leaves H^2 a1 = ((1 - c) r + 1/2 - b)/(c r + b) y^2 d0 to leading order, and so
//        v1/(w d0) = (c/2 - b)/(c r + b) y,     d1/d0 = (b - c/2) r/(c r + b) y^2.
//    For every spectral radius |b - c/2| <= b/4 and <= c/6 (0 of Newmark's average acceleration): speeds to
//    y/4, positions to min(r/4, 1/6) y^2 times what was there, damped from then on.  Energy: at most (1 + y/4
//    + min(r/4, 1/6) y^2)^2.
//      -> accurate, stable, bounded
// 3. L-stable methods where every mode has y = w H >= 100: |R(iy)| falls like C/y, and in the 20 steps before
//    the error is sampled a mode falls by (C/y)^20, below the bar for every C <= 86; the exact motion of
//    these modes, damped by e^{-z_1 w_1 t}, has come to rest as well.
//      -> accurate
// 4. Any stable method where every mode is resolved.  The local error of order p is at most |z|^{p+1}, z = w
//    H (its constant is below 1 for all methods in use: 1/2 for Euler's, 1/12 for the trapezoidal rule); the
//    errors add up and are damped:
//        error <= max_t (w t) (w H)^p e^{-z w t} = (w H)^p/(e z),
//        and (w T) (w H)^p where that is less (no damping).
//    Where that is below the bar for every mode:
//      -> accurate
//    For a method whose energy is bounded by its amplification alone, 4 applies within the limit of 5 only.
// 5. Explicit methods at a fixed step.  The system is a direct sum of its modes, and a linear method acts on
//    each alone: it is stable on the system exactly if it is on every (w_j, z_j), one oscillator each.  That
//    amplification r is found by running the method on the oscillator.
//    - r > 1 makes the energy r^(2 n).  Beyond 1e3 in the row's periods, the run is followed to its end:
//      overflow, a force that is not finite, and that must be said.
//        -> error
//    - Less, and it ends where it ends.
//        -> bounded, grew, error
//    - The modes hold 1/n of the energy each: growing amplitudes alone are an error of
//           sqrt(sum_j (r_j^n - 1)^2/n).
//      Where the bar hides that, also:
//        -> accurate, stable
//    - Within (r <= 1, to what shows in the row's periods):
//        -> accurate, stable, bounded
//    A bound that no run can talk away: with s force evaluations a step no explicit method is stable on the
//    imaginary axis beyond w H = 2 s (s - 1 of Runge-Kutta methods, Vichnevetsky 1983; 2 s of methods that
//    alternate positions and speeds, Chawla and Sharma 1981; damping that is taken implicitly stretches it by
//    sqrt(1 + z^2) + z).  Beyond it nothing but an error will do.
// 6. Error control.  The flow never expands the energy's norm, so local errors add up at most: error <=
//    (number of steps) x (what a step may err).  The second factor is WRMS <= 1 in the weights of the method,
//    converted to the energy's norm (LinearProblem::tolerance).  Of a multistep method the norm is another
//    one (2); a factor of 10 covers the norms' ratio and that its estimate is of the leading term alone.  The
//    bound takes the worst of every step in the stiffest mode; where that makes it useless, 1e4 rtol is asked
//    for.
//      -> accurate
//    Explicit ones need steps below about 10/(fastest rate) (no method here has a stability region that
//    reaches farther), and take them where that makes fewer than the limit of steps a period; beyond that
//    they must say so.
//      -> accurate; error
//    A pair of order p estimates the error of order p - 1, (w h)^p in q's weight rtol atol_q.  So h w is at
//    least (rtol atol_q)^(1/p) while the stiffest mode is alive, which makes y (rtol atol_q)^(-1/p) steps a
//    period.  Where that passes the limit of steps, it may say so instead.
//      -> accurate, error
// 7. Statics has no motion to be right about: it finds the equilibrium that the motion ends in.
//      -> accurate
//
// Rounding: K x is right to eps w_max^2, and the slowest mode feels it by eps (w_max/w_1)^2, added to every
// bar.

namespace palpate::stability {
namespace {

using dynamics::Stability;

/// Thresholds on 2 n ln r, the logarithm of the energy's growth over the row's periods.
constexpr double kFollowed = 6.9;  // ln 1e3
constexpr double kUnseen = 0.1;

/// The family of Newmark, by its registry entry.
bool carries_acceleration(const Column& column) { return column.entry->traits.family == "Newmark"; }

bool resolved(const LinearProblem& problem, int order, double H) {
  for (Eigen::Index j = 0; j < problem.omega().size(); ++j) {
    const double y = problem.omega()[j] * H,
                 longest = std::min(y * kLinearPeriods, 1.0 / (M_E * problem.damping_ratio(j)));
    if (!(longest * std::pow(y, order) < kAccurate)) return false;
  }
  return true;
}

Verdicts expect_explicit_steps(const Column& column, const LinearProblem& problem, double H) {
  double worst = 0.0, hidden = 0.0;
  for (Eigen::Index j = 0; j < problem.omega().size(); ++j) {
    const double w = problem.omega()[j], z = problem.damping_ratio(j);
    const Amplification one = amplification(column, w, z, H);
    if (w * H > 2.0 * std::max(1.0, one.evaluations) * (std::sqrt(1.0 + z * z) + z)) return {Verdict::kError};
    worst = std::max(worst, one.modulus);
    if (one.modulus > 1.0)
      hidden += std::pow(std::pow(one.modulus, kLinearPeriods) - 1.0, 2) /
                static_cast<double>(problem.omega().size());
  }
  const double growth = 2.0 * kLinearPeriods * std::log(worst);
  if (growth > kFollowed) return {Verdict::kError};
  if (growth > kUnseen && std::sqrt(hidden) < kAccurate)
    return {Verdict::kAccurate, Verdict::kStable, Verdict::kBounded, Verdict::kGrew, Verdict::kError};
  // grows, too slowly to tell where it ends
  if (growth > kUnseen) return {Verdict::kBounded, Verdict::kGrew, Verdict::kError};
  if (resolved(problem, column.entry->traits.order, H)) return {Verdict::kAccurate};
  return {Verdict::kAccurate, Verdict::kStable, Verdict::kBounded};
}

Verdicts expect_error_control(const Column& column, const LinearProblem& problem, double H) {
  const double by_accuracy =
      problem.omega()[problem.omega().size() - 1] * H *
      std::pow(kLinearRtol * IntegratorSpec{}.atol_q, -1.0 / column.entry->traits.order);
  if (by_accuracy > kMaxSteps) return {Verdict::kAccurate, Verdict::kError};
  if (!is_explicit(column)) return {Verdict::kAccurate};
  const double rate = problem.fastest_rate() * H;  // per period
  if (rate / 10.0 > kMaxSteps) return {Verdict::kError};
  if (rate / 0.5 < kMaxSteps) return {Verdict::kAccurate};
  return {Verdict::kAccurate, Verdict::kError};
}

}  // namespace

Verdicts expect_linear(const Lab& lab, const LinearProblem& problem, double H) {
  const auto& traits = lab.column.entry->traits;
  if (is_static(lab.column)) return {Verdict::kAccurate};
  if (!lab.column.fixed) return expect_error_control(lab.column, problem, H);
  if (is_explicit(lab.column)) return expect_explicit_steps(lab.column, problem, H);
  if (resolved(problem, traits.order, H)) return {Verdict::kAccurate};
  const bool at_rest = problem.damping_ratio(0) * problem.omega()[0] * H * kLinearPeriods / 2 >= 20.0;
  if (traits.stability == Stability::kL && problem.omega()[0] * H >= 100.0 && at_rest)
    return {Verdict::kAccurate};
  if (traits.multistep || traits.stability == Stability::kAlpha || carries_acceleration(lab.column))
    return {Verdict::kAccurate, Verdict::kStable, Verdict::kBounded};
  return {Verdict::kAccurate, Verdict::kStable};
}

double bounded_gain(const Column& column, const LinearProblem& problem, double H) {
  constexpr double kPowerBound = 100.0;
  if (!carries_acceleration(column)) return kPowerBound;
  const double y = H * problem.omega()[problem.omega().size() - 1],
               r = 2.0 * problem.damping_ratio(0) / (H * problem.omega()[0]);
  return std::max(kPowerBound, std::pow(1.0 + 0.25 * y + std::min(0.25 * r, 1.0 / 6.0) * y * y, 2));
}

Amplification amplification(const Column& column, double omega, double damping_ratio, double H) {
  // the growth between two windows: their largest energies, so that a beat does not count
  constexpr int kSteps = 240, kWindow = 80;
  const LinearProblem one(omega, damping_ratio);
  const auto instance = one.start();
  const auto stepper =
      make_stepper(column, instance->system, instance->state, spec_of(column, kLinearRtol, H));
  Amplification out;
  double first = 0.0, last = 0.0;
  for (int i = 1; i <= kSteps; ++i) {
    const bool ok = stepper->advance_to(i * H).ok();
    const auto& counters = stepper->counters();
    out.evaluations =
        static_cast<double>(counters.force_evaluations) / static_cast<double>(std::max(1L, counters.steps));
    out.modulus = INFINITY;
    if (!ok) return out;
    const double energy = one.energy(instance->state);
    if (i <= kWindow) first = std::max(first, energy);
    if (i > kSteps - kWindow) last = std::max(last, energy);
  }
  out.modulus = std::pow(last / std::max(first, 1e-300), 0.5 / (kSteps - kWindow));
  return out;
}

}  // namespace palpate::stability
