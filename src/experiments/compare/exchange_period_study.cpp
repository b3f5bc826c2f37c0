#include "palpate/experiments/exchange_period_study.h"

#include <algorithm>
#include <cmath>

#include "palpate/core/error.h"

namespace palpate::compare {
namespace {

constexpr double kRtol = 1e-6;
const std::string kMethod = "cvode-bdf", kCheck = "ark-dirk-esdirk547", kCheckSolver = "umfpack";
constexpr int kTicks = 10;  ///< Ticks per exchange period.

/// Returns the longest time of which every period is a multiple: an integer fraction of the shortest.
double common_refresh(const std::vector<double>& periods) {
  const double shortest = *std::min_element(periods.begin(), periods.end());
  for (int parts = 1; parts <= 1000; ++parts) {
    const double refresh = shortest / parts;
    if (std::all_of(periods.begin(), periods.end(),
                    [&](double p) { return std::abs(p / refresh - std::round(p / refresh)) < 1e-6; }))
      return refresh;
  }
  fail(
      "compare: exchange_periods_s have no common divisor as contact refresh period; use multiples of the "
      "shortest, {} s",
      shortest);
}

scene::Description with_scheme(scene::Description d, scene::ExchangeScheme scheme, double period,
                               double refresh) {
  d.exchange.scheme = scheme;
  d.exchange.exchange_period_s = period;
  d.exchange.contact_refresh_s = refresh;
  d.tool->tick_s = period / kTicks;
  d.integrator.name = kMethod;
  d.integrator.rtol = kRtol;
  return d;
}

/// Returns the scene with the check's method.
scene::Description checked(scene::Description d) {
  d.integrator.name = kCheck;
  d.integrator.linear_solver = kCheckSolver;
  return d;
}

}  // namespace

int exchange_runs(const scene::Description& d) {
  return d.tool && !d.compare.exchange_periods_s.empty()
             ? static_cast<int>(d.compare.exchange_periods_s.size()) + 2
             : 0;
}

ExchangeStudy compare_exchange(const scene::Description& d, const ExchangeOptions& options) {
  ExchangeStudy out;
  if (exchange_runs(d) == 0) return out;
  const auto done = [&](const std::string& what) {
    if (options.done) options.done(what);
  };
  const std::vector<double>& periods = d.compare.exchange_periods_s;
  const double refresh = common_refresh(periods),
               shortest = *std::min_element(periods.begin(), periods.end());
  const scene::Description whole = with_scheme(d, scene::ExchangeScheme::kMonolithic, shortest, refresh);
  const Run reference = run_once(whole, d.compare.duration_s, options.stop);
  if (reference.result.stopped) return out;
  const bool comparable = reference.result.status.ok();
  done("monolithic");
  const Run check = run_once(checked(whole), d.compare.duration_s, options.stop);
  if (check.result.stopped) return out;
  done("monolithic, checked");
  out.made_by = fmt::format("{} at rtol {:g}", kMethod, kRtol);
  out.checked_by = fmt::format("{} at rtol {:g} by {}", kCheck, kRtol, kCheckSolver);
  if (!check.result.status.ok())
    out.trouble = "the check failed: " + check.result.status.message;
  else if (comparable)
    out.own_error = distance(check.trajectory, reference.trajectory);
  for (double period : periods) {
    if (options.stop && options.stop->load()) return out;
    const Run run = run_once(with_scheme(d, scene::ExchangeScheme::kPartitioned, period, refresh),
                             d.compare.duration_s, options.stop, options.seed_defect);
    done(fmt::format("exchange period {:g} s", period));
    if (run.result.stopped) return out;
    ExchangePoint point{period, no_distance(), run.result.cpu_s};
    if (!comparable)
      point.trouble = "the monolithic run failed: " + reference.result.status.message;
    else if (!run.result.status.ok())
      point.trouble = run.result.status.message.empty() ? "the run failed" : run.result.status.message;
    else
      point.error = distance(run.trajectory, reference.trajectory);
    const TrajectoryError& own = out.own_error;
    point.unresolved = point.error.position_rel_l2 < kResolution * own.position_rel_l2;
    point.force_unresolved = point.error.force_rms_n < kResolution * own.force_rms_n;
    point.torque_unresolved = point.error.torque_rms_n_m < kResolution * own.torque_rms_n_m;
    out.points.push_back(point);
  }
  return out;
}

}  // namespace palpate::compare
