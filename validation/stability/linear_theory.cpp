#include <cmath>

#include "linear.h"
#include "modal_steps.h"
#include "predicted_course.h"

// Expectations for the linear, contact-free rows, from theory alone. The problem is M q'' + D q' + K q = 0, D
// and K positive, in first order form y' = A y. In the inner product of the energy, Re<y, A y> = -u.D u <= 0.
// It is a direct sum of modes, and a linear method acts on each separately.
//
// 1. Fixed steps.  The whole course follows from the method's formula (modal_steps.h), which is not its code:
//    x_n of every mode, so the energy and the error against the exact motion at every period.  The expected
//    verdict follows from these figures, with the same limits as for the run; where one of them is within 1 %
//    of its limit, the verdicts of both sides.  The run must also agree with the formula, to a fraction of
//    the largest size that its course has reached:
//      - rounding: K x is accurate to eps w_max^2, which affects the slowest mode by eps (w_max/w_1)^2
//        per step;
//      - the Newmark family stores the acceleration, whose rounding is eps (w H)^2 of q;
//      - the remainder of Newton's method and of the inner integrator of a multi-rate method, taken as 10
//        rtol per period;
//    otherwise the verdict is wrong.
//      - An energy beyond kFollowed within the row's periods, still growing: followed until the formula
//        overflows.  The run must then report an error, but not before the formula exceeds 1e10 of the
//        initial energy (linear_cell.cpp).
//          -> error
//      - An energy gain is bounded by the formula's gain, without further limits.
//    For A-stable one-step methods this shows von Neumann's theorem (Hairer and Wanner, Solving ODEs II, thm
//    IV.11.2): the norm of R(H A) is at most sup |R| over Re z <= 0, so the energy never rises; for multistep
//    methods (power bounded, G-stable: Dahlquist 1978), that it rises by a constant factor, once; for
//    generalised-alpha its overshoot in the first step (Hilber and Hughes 1978); for explicit methods, that
//    they are unstable from the limit of their polynomial on, and not below.
// 2. Error control.  The flow never expands the energy's norm, so local errors add up at most: error <=
//    (number of steps) x (error allowed per step).  The second factor is WRMS <= 1 in the weights of the
//    method, converted to the energy's norm (LinearProblem::tolerance).  Multistep methods are stable in
//    another norm; a factor of 10 covers the ratio of the norms and the fact that the estimate covers the
//    leading term alone.  The bound assumes the worst of every step in the stiffest mode; where this makes it
//    useless, the limit is 0.01.
//      -> accurate
//    Explicit methods need steps below about 10/(fastest rate) (no method here has a larger stability
//    region), and take them where they are fewer than the limit of steps per period.  Beyond the limit they
//    must report an error, and must have reached the time covered by that many steps of a tenth of 1/(fastest
//    rate), with the same error as methods that have not failed.
//      -> accurate; error
//    A pair of order p estimates the error of order p - 1, (w h)^p in q's weight rtol atol_q.  So h w is at
//    least (rtol atol_q)^(1/p) while the stiffest mode is present, which makes y (rtol atol_q)^(-1/p) steps
//    per period.  Where this exceeds the limit of steps, the method may report an error instead, after the
//    time covered by a tenth of these steps.
//      -> accurate, error
// 3. Statics has no motion: it finds the equilibrium in which the motion ends.
//      -> accurate
//
// Elements (row_elements.cpp) are linear up to a multiple of their displacement, initially kOfElements of the
// body's size: kNonlinear is added to the accepted difference between run and formula. Growing elements are
// followed to kLinearUpTo of the energy, ten times the displacement.
//   -> bounded, where the formula grows beyond that
//
// Rounding: K x is accurate to eps w_max^2, which affects the slowest mode by eps (w_max/w_1)^2, added to
// every limit.

namespace palpate::stability {
namespace {

constexpr double kFollowed = 1e3;  // Relative to the initial energy.
constexpr double kNearABar = 0.01;
constexpr double kUnitRounding = 2.3e-16;
constexpr double kRoundingKept = 1e-9;
constexpr double kNonlinear = 1e-3;
constexpr double kMultistepNorm = 10.0, kUseful = 0.01;
constexpr double kPowerBound = 100.0;  // For multistep methods under error control.

/// Returns the step [s] that error control needs at least to be accurate (see 2 above).
double smallest_step(const Column& column, const LinearProblem& problem) {
  return std::pow(linear_rtol(problem) * IntegratorSpec{}.atol_q, 1.0 / column.entry->traits.order) /
         problem.omega()[problem.omega().size() - 1];
}

Verdicts expect_error_control(const Column& column, const LinearProblem& problem, double H) {
  if (H / smallest_step(column, problem) > kMaxSteps) return {Verdict::kAccurate, Verdict::kError};
  if (!is_explicit(column)) return {Verdict::kAccurate};
  const double rate = problem.fastest_rate() * H;  // Per period.
  if (rate / 10.0 > kMaxSteps) return {Verdict::kError};
  if (rate / 0.5 < kMaxSteps) return {Verdict::kAccurate};
  return {Verdict::kAccurate, Verdict::kError};
}

}  // namespace

double least_progress(const Column& column, const LinearProblem& problem) {
  return 0.1 * kMaxSteps * std::min(1.0 / problem.fastest_rate(), smallest_step(column, problem));
}

LinearOutcome predict_linear(const Column& column, const LinearProblem& problem, double H) {
  PredictedCourse course(column, problem, H);
  LinearOutcome out;
  for (int i = 1; i <= kLinearPeriods; ++i) {
    course.advance();
    if (i <= kLinearPeriods / 2 || !std::isfinite(course.highest())) continue;
    const LinearProblem::Points2 away = course.modes() - problem.modes_at(i * H);
    out.error = std::max(out.error, std::sqrt(problem.energy(away)));
  }
  out.highest = course.highest();
  out.overflows = !std::isfinite(out.highest);
  if (!(out.highest > kFollowed && course.spectral_radius() > 1.0)) return out;
  for (int i = kLinearPeriods; i < kLastPeriod && !out.overflows; ++i) {
    course.advance();
    out.overflows = !std::isfinite(course.highest());
  }
  return out;
}

LinearBars linear_bars(const Column& column, const LinearProblem& problem, double H, double highest,
                       long steps) {
  const auto& traits = column.entry->traits;
  const IntegratorSpec spec = spec_of(column, linear_rtol(problem), H);
  // The speed at which the whole energy would be kinetic.
  const double speed = std::sqrt(std::min(highest, 1e300)) * problem.largest_speed_rms(),
               kept = kRoundingKept * std::sqrt(problem.condition()) +
                      static_cast<double>(steps) * problem.tolerance(spec, speed),
               rounding = kUnitRounding * problem.condition();
  if (is_static(column)) return {rounding + kAccurate, 2.0 * kept, kPowerBound, 0.0};
  if (!has_modal_steps(column)) {
    const double bar = std::min(kUseful, kept * (traits.multistep ? kMultistepNorm : 1.0));
    return {rounding + bar, 2.0 * kept, kPowerBound, 0.0};
  }
  const double y = problem.omega()[problem.omega().size() - 1] * H,
               of_acceleration = traits.family == "Newmark" ? kUnitRounding * y * y : 0.0;
  const double of_elements = problem.is_by_elements() ? kNonlinear : 0.0;
  const double agreement = kLinearPeriods * (10.0 * kLinearRtol + rounding + of_acceleration) + of_elements;
  const double most = predict_linear(column, problem, H).highest;
  return {rounding + kAccurate, 2.0 * kept, most * (1.0 + agreement) - 1.0 + 2.0 * kept, agreement};
}

Verdict verdict_of(const LinearOutcome& outcome, const LinearBars& bars) {
  const double gain = outcome.highest - 1.0;
  if (gain > bars.gain) return Verdict::kGrew;
  if (outcome.error <= bars.error) return Verdict::kAccurate;
  return gain <= bars.kept ? Verdict::kStable : Verdict::kBounded;
}

Verdicts expect_linear(const CaseContext& context, const LinearProblem& problem, double H) {
  if (is_static(context.column)) return {Verdict::kAccurate};
  if (!context.column.fixed) return expect_error_control(context.column, problem, H);
  const LinearOutcome predicted = predict_linear(context.column, problem, H);
  if (predicted.overflows && !problem.is_by_elements()) return {Verdict::kError};
  if (predicted.highest > kLinearUpTo && problem.is_by_elements()) return {Verdict::kBounded};
  const LinearBars bars = linear_bars(context.column, problem, H, predicted.highest, kLinearPeriods);
  Verdicts out;
  for (const double by : {1.0 - kNearABar, 1.0, 1.0 + kNearABar})
    out.add(verdict_of({1.0 + by * (predicted.highest - 1.0), by * predicted.error},
                       {bars.error, bars.kept, INFINITY, 0.0}));
  return out;
}

}  // namespace palpate::stability
