#include "clock_figures.h"

#include <fmt/format.h>

#include <array>
#include <filesystem>

#include "palpate/store/csv.h"

namespace palpate::cli {
namespace {

constexpr const char* kFile = "clock.csv";

void print_series(const char* what, const std::vector<float>& values, double unit, const char* name) {
  fmt::print("  {:<18}{:>9.1f} {:>9.1f} {:>9.1f} {:>9.1f} {}\n", what, loop::quantile(values, 0.5) / unit,
             loop::quantile(values, 0.99) / unit, loop::quantile(values, 0.999) / unit,
             loop::quantile(values, 1.0) / unit, name);
}

}  // namespace

void print_clock(const loop::RunResult& result, const std::string& linearisation) {
  const loop::RealTimeResult& clock = *result.real_time;
  fmt::print("ticks in real time: {}, {}, memory {}\n", clock.scheduling,
             clock.cpu < 0 ? std::string("on any processor") : fmt::format("on processor {}", clock.cpu),
             clock.memory);
  fmt::print("  {:<18}{:>9} {:>9} {:>9} {:>9}\n", "", "p50", "p99", "p99.9", "max");
  print_series("tick late", clock.lateness_s, 1e-6, "us");
  print_series("tick's work", clock.work_s, 1e-6, "us");
  print_series("exchange's latency", clock.latency_s, 1e-3, "ms");
  fmt::print("  {} of {} ticks late by a tick or more; bodies and contact at {:.1f} Hz (wanted {:g})\n",
             clock.missed_ticks, clock.lateness_s.size(), clock.exchanges_per_s(), 1.0 / clock.period_s);
  if (clock.left_out_ticks > 0)
    fmt::print(
        "  the clock started anew after ticks that were more than {:g} ms late: {} ticks were left out\n",
        1e3 * clock.stall_s, clock.left_out_ticks);
  if (clock.stalls > 0)
    fmt::print("  no wrench went out for more than {:g} ms, {} times: the force set in anew\n",
               1e3 * clock.stall_s, clock.stalls);
  if (const double exchanges = static_cast<double>(clock.latency_s.size()); exchanges > 0.0) {
    const dynamics::StepperCounters& c = result.counters;
    const double step = c.force_s + c.tangent_s + c.solver.symbolic_s + c.solver.factor_s + c.solver.solve_s,
                 query = result.query_s, linearise = result.linearise_s;
    fmt::print(
        "  an exchange took the bodies {:.1f} ms in the mean: query {:.1f}, linearisation {:.1f}, step "
        "{:.1f}\n",
        1e3 * (query + linearise + step) / exchanges, 1e3 * query / exchanges, 1e3 * linearise / exchanges,
        1e3 * step / exchanges);
  }
  if (clock.stretched_periods > 0)
    fmt::print("  bodies fell behind: {} periods shared the contact query of the one before\n",
               clock.stretched_periods);
  if (clock.dropped_periods > 0)
    fmt::print("  bodies fell behind too far: they stood still in {} periods, {:.3g} s in all\n",
               clock.dropped_periods, clock.dropped_s());
  if (clock.stretched_periods + clock.dropped_periods > 0 && linearisation != "frozen")
    fmt::print("  --set exchange.linearisation={} makes an exchange cheaper{}\n",
               linearisation == "condensed" ? "points" : "frozen",
               linearisation == "condensed" ? "" : ", and the force err by far more");
  if (clock.unrecorded_ticks > 0)
    fmt::print("  {} ticks are not recorded: the recorder fell behind by more than its queue\n",
               clock.unrecorded_ticks);
}

void keep_clock(const loop::RealTimeResult& clock, const std::string& folder) {
  store::CsvWriter file((std::filesystem::path(folder) / kFile).string(), {"time_s", "late_us", "work_us"});
  for (std::size_t i = 0; i < clock.lateness_s.size(); ++i)
    file.row(std::array{static_cast<double>(i + 1) * clock.tick_s,
                        1e6 * static_cast<double>(clock.lateness_s[i]),
                        1e6 * static_cast<double>(clock.work_s[i])});
  file.close();
}

}  // namespace palpate::cli
