#include "session/clock_figures.h"

#include <fmt/format.h>

#include <array>
#include <filesystem>

#include "store/csv.h"

namespace palpate::session {

std::vector<std::string> clock_remarks(const loop::RunResult& result, const std::string& linearisation) {
  const loop::RealTimeResult& clock = *result.real_time;
  std::vector<std::string> out;
  const auto add = [&out]<class... Args>(fmt::format_string<Args...> format, Args&&... args) {
    out.push_back(fmt::format(format, std::forward<Args>(args)...));
  };
  add("real time: {} of {} ticks late by a tick or more; bodies and contact at {:.1f} Hz (target {:g} Hz)",
      clock.missed_ticks, clock.timed_ticks, clock.exchanges_per_s(), 1.0 / clock.period_s);
  if (clock.skipped_ticks > 0)
    add("real time: {} ticks were skipped, because steps took longer than ticks; longer steps covered them",
        clock.skipped_ticks);
  if (clock.left_out_ticks > 0)
    add("real time: the clock was restarted after ticks that were more than {:g} ms late; {} ticks were "
        "skipped",
        1e3 * clock.stall_s, clock.left_out_ticks);
  if (clock.stalls > 0)
    add("real time: no wrench was sent for more than {:g} ms, {} times; each time the force was ramped in "
        "again",
        1e3 * clock.stall_s, clock.stalls);
  if (const double exchanges = static_cast<double>(clock.timed_exchanges); exchanges > 0.0) {
    const dynamics::StepperCounters& c = result.counters;
    const double step = c.force_s + c.tangent_s + c.solver.symbolic_s + c.solver.factor_s + c.solver.solve_s,
                 query = result.query_s, linearise = result.linearise_s;
    add("real time: an exchange takes {:.1f} ms on average: query {:.1f}, linearisation {:.1f}, step of the "
        "bodies {:.1f}",
        1e3 * (query + linearise + step) / exchanges, 1e3 * query / exchanges, 1e3 * linearise / exchanges,
        1e3 * step / exchanges);
  }
  if (clock.stretched_periods > 0)
    add("real time: {} periods reused the contact query of the previous period to catch up",
        clock.stretched_periods);
  if (clock.dropped_periods > 0)
    add("real time: the bodies were not advanced in {} periods ({:.3g} s in total), because they are slower "
        "than real time",
        clock.dropped_periods, clock.dropped_s());
  // Without soft bodies nothing is linearised.
  if (clock.stretched_periods + clock.dropped_periods > 0 && linearisation != "frozen" &&
      result.linearise_s > 0.0)
    add("real time: --set exchange.linearisation={} makes an exchange cheaper{}",
        linearisation == "condensed" ? "points" : "frozen",
        linearisation == "condensed" ? "" : ", but the error of the force much larger");
  if (clock.unrecorded_ticks > 0)
    add("real time: {} ticks were not recorded, because the queue of the recorder was full",
        clock.unrecorded_ticks);
  return out;
}

void write_clock(const loop::RealTimeResult& clock, const std::string& folder) {
  store::CsvWriter file((std::filesystem::path(folder) / "clock.csv").string(),
                        {"time_s", "late_us", "work_us"});
  const double first = static_cast<double>(clock.timed_ticks) - static_cast<double>(clock.lateness_s.size());
  for (std::size_t i = 0; i < clock.lateness_s.size(); ++i)
    file.row(std::array{(first + static_cast<double>(i + 1)) * clock.tick_s,
                        1e6 * static_cast<double>(clock.lateness_s[i]),
                        1e6 * static_cast<double>(clock.work_s[i])});
  file.close();
}

}  // namespace palpate::session
