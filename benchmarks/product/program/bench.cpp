#include "product/bench.h"

#include <fmt/format.h>

#include "bench_contact.h"
#include "bench_continuity.h"
#include "bench_fem.h"
#include "cli/scene_of.h"
#include "cli/stop.h"
#include "options.h"
#include "palpate/core/error.h"
#include "report/table.h"

namespace palpate::cli {
namespace {

using Rows = std::vector<std::vector<std::string>>;

void bench_fem(const BenchArguments& arguments) {
  const bench::FemBench b =
      bench::bench_fem(arguments.cells, arguments.step_s, arguments.steps, arguments.linear_solvers.front());
  fmt::print("one step of {} of {:g} ms: {} nodes, {} tetrahedra, {}; median of {} steps\n\n", b.integrator,
             1e3 * b.step_s, b.nodes, b.tetrahedra, arguments.linear_solvers.front(), b.steps);
  Rows rows;
  const auto add = [&](const std::string& stage, double ms) {
    rows.push_back({stage, fmt::format("{:.2f}", ms), fmt::format("{:.0f}", 100.0 * ms / b.step_ms)});
  };
  add("forces", b.force_ms);
  add("tangent", b.tangent_ms);
  add("factorisation", b.factor_ms);
  add("solve", b.solve_ms);
  add("other", b.other_ms);
  add("step", b.step_ms);
  fmt::print("{}\nassembled in {:.2f} s, peak memory {:.0f} MiB\n",
             report::format_table({"stage", "ms", "% of the step"}, rows), b.assemble_s, b.peak_mib);
}

void bench_leave_out(const std::string& scene, int repeats) {
  const scene::Description description = scene_of({scene, {}, ""});
  Rows rows;
  for (const bench::LeaveOutRow& r : bench::bench_leave_out(description, repeats))
    rows.push_back({r.variant, fmt::format("{:.1f}", r.startup_ms), fmt::format("{:.1f}", r.memory_mib),
                    fmt::format("{:.4g}", r.step_ms), fmt::format("{:.3f}", r.ratio)});
  fmt::print("{}, median of {} runs, each in a separate process\n{}\n", short_name(description), repeats,
             report::format_table(
                 {"variant", "start-up [ms]", "memory [MiB]", "step [ms]", "step / bare loop"}, rows));
}

}  // namespace

int bench(const BenchArguments& arguments) {
  if (arguments.what == "fem") {
    arguments.cells > 0 ? bench_fem(arguments) : bench_fem_sizes(arguments);
    return stop_flag() ? kExitStopped : 0;
  }
  if (arguments.what == "contact") { return bench_contact(arguments); }
  if (arguments.what == "continuity") {
    bench_continuity(arguments);
    return stop_flag() ? kExitStopped : 0;
  }
  if (arguments.what != "leave-out")
    fail("there is no benchmark \"{}\"{}", arguments.what,
         suggestion(arguments.what, {"contact", "continuity", "fem", "leave-out"}));
  const std::vector<std::string> scenes =
      arguments.scenes.empty() ? std::vector<std::string>{"falling-ball", "cantilever"} : arguments.scenes;
  for (const std::string& scene : scenes) {
    if (stop_flag()) return kExitStopped;
    bench_leave_out(scene, arguments.repeats);
  }
  return 0;
}

}  // namespace palpate::cli
