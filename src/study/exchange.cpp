#include "palpate/study/exchange.h"

#include "palpate/core/error.h"
#include "palpate/core/log.h"

namespace palpate::study {
namespace {

scene::Description with_exchange_period(scene::Description d, double period) {
  d.coupling.exchange_period_s = d.coupling.contact_refresh_s = period;
  d.integrator.name = "cvode-bdf";
  d.integrator.rtol = 1e-5;
  return d;
}

}  // namespace

int exchange_runs(const scene::Description& d) {
  return d.tool && !d.compare.exchange_periods_s.empty() ? static_cast<int>(d.compare.exchange_periods_s.size()) + 1 : 0;
}

std::vector<ExchangePoint> compare_exchange(const scene::Description& d, const ExchangeOptions& options) {
  std::vector<ExchangePoint> out;
  if (exchange_runs(d) == 0) return out;
  const auto done = [&](const std::string& what) {
    if (options.done) options.done(what);
  };
  const Run truth = run_once(with_exchange_period(d, d.tool->tick_s), d.compare.duration_s, options.stop);
  if (truth.result.stopped) return out;
  const bool comparable = truth.result.status.ok();
  if (!comparable) log::warn("the exchange period has no truth to be held against: the run with a period of one tick failed: {}", truth.result.status.message);
  done("exchange period of one tick");
  for (double period : d.compare.exchange_periods_s) {
    if (options.stop && options.stop->load()) return out;
    const Run run = run_once(with_exchange_period(d, period), d.compare.duration_s, options.stop);
    done(fmt::format("exchange period {:g} s", period));
    if (run.result.stopped) return out;
    const bool ok = comparable && run.result.status.ok();
    out.push_back({period, ok ? distance(run.trajectory, truth.trajectory) : no_distance(), run.result.cpu_s});
  }
  return out;
}

}  // namespace palpate::study
