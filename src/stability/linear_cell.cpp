#include <cmath>

#include "linear.h"
#include "palpate/core/error.h"

namespace palpate::stability {
namespace {

constexpr int kLastPeriod = 20000;  ///< an explicit run that grows is followed to here
constexpr double kGrowing = 1e3;    ///< times the energy of the start
constexpr double kRounding = 1e-9;
constexpr double kMultistepNorm = 10.0, kUseful = 1e4 * kLinearRtol;

struct Course {
  dynamics::StepResult result;
  double highest = 1.0;  ///< energy over that of the start
  double error = 0.0;    ///< largest; for fixed steps and statics over the second half
  double speed = 0.0;    ///< largest root mean square of u seen [m/s]
  bool finite = true, interrupted = false;
};

Course follow(const Lab& lab, const LinearProblem& problem, LinearProblem::Instance& run,
              dynamics::Stepper& stepper, double H) {
  // stiff transients of a fixed step are over by then
  const bool settles = lab.column.fixed || is_static(lab.column);
  const bool followed = lab.column.fixed && is_explicit(lab.column);
  Course course;
  for (int i = 1; i <= kLinearPeriods || (followed && course.highest > kGrowing && i <= kLastPeriod); ++i) {
    if (lab.time_is_up()) course.interrupted = true;
    if (course.interrupted) break;
    course.result = stepper.advance_to(i * H);
    if (!course.result.ok()) break;
    course.finite = run.state.q().allFinite() && run.state.u().allFinite();
    if (!course.finite) break;
    course.highest = std::max(course.highest, problem.energy(run.state));
    course.speed = std::max(course.speed, problem.speed_rms(run.state));
    if (i > (settles ? kLinearPeriods / 2 : 0) && i <= kLinearPeriods)
      course.error = std::max(course.error, is_static(lab.column) ? problem.from_rest(run.state)
                                                                  : problem.error(run.state, i * H));
  }
  return course;
}

}  // namespace

StabilityCell linear_cell(const Lab& lab, const LinearProblem& problem, double H) {
  StabilityCell cell;
  const IntegratorSpec spec = spec_of(lab.column, kLinearRtol, H);
  const auto run = problem.start();
  const auto stepper = make_stepper(lab.column, run->system, run->state, spec);
  stepper->set_interrupt(lab.expired);
  const Course course = follow(lab, problem, *run, *stepper, H);
  cell.steps = stepper->counters().steps;

  // Between two samples the speed is at most that of the whole energy as kinetic energy.
  const double speed =
      std::max(course.speed, std::sqrt(std::min(course.highest, 1e300)) * problem.largest_speed_rms());
  const double kept = kRounding * std::sqrt(problem.condition()) +
                      static_cast<double>(cell.steps) * problem.tolerance(spec, speed);
  const double rounding = 2.3e-16 * problem.condition();
  const auto& traits = lab.column.entry->traits;
  const double bar = rounding + (lab.column.fixed || is_static(lab.column)
                                     ? kAccurate
                                     : std::min(kUseful, kept * (traits.multistep ? kMultistepNorm : 1.0)));
  const double most = bounded_gain(lab.column, problem, H);
  cell.gain = course.highest - 1.0;
  cell.error = course.error;
  cell.figure = fmt::format("energy {:+.1e}, error {:.1e} of {:.1e}", cell.gain, cell.error, bar);

  if (ended_early(lab.column, course.result, course.finite, course.interrupted, cell.gain > most, cell))
    return cell;
  if (cell.error <= bar && cell.gain <= most) {
    cell.verdict = Verdict::kAccurate;
  } else {
    cell.verdict = cell.gain <= 2.0 * kept ? Verdict::kStable
                   : cell.gain <= most     ? Verdict::kBounded
                                           : Verdict::kGrew;
  }
  return cell;
}

SubCase linear_case(std::string name, std::function<LinearProblem()> make, double H) {
  return {std::move(name), [make, H](const Lab& lab) { return expect_linear(lab, make(), H); },
          [make, H](const Lab& lab) { return linear_cell(lab, make(), H); }};
}

}  // namespace palpate::stability
