#include "run_summary.h"

#include <fmt/format.h>

#include <filesystem>

#include "against_monolithic.h"
#include "cli/scene_of.h"
#include "clock_figures.h"
#include "core/clock.h"
#include "core/time_text.h"
#include "experiments/compare/summary.h"
#include "loop/registries.h"
#include "loop/summary.h"
#include "palpate/core/log.h"
#include "run_command_line.h"
#include "store/atomic_file.h"

namespace palpate::cli {
namespace {

void print_hand(const std::string& who, const loop::PeakWrench& peak, long ticks, long limited) {
  fmt::print(
      "on {}: at most {:.4g} N (at {} s) and {:.4g} N m (at {} s) in {} ticks; {} held at the device's "
      "limit\n",
      who, peak.force_n, time_text(peak.force_at_s), peak.torque_n_m, time_text(peak.torque_at_s), ticks,
      limited);
}

/// Prints the requested tolerance, and the tolerance of the error test that the method derives from it.
void print_tolerance(const IntegratorSpec& spec) {
  const auto& method = find(loop::steppers(), spec.name, "integrator");
  if (method.error_test_rtol && !spec.fixed_step)
    fmt::print("{}: rtol {:g}, error test at {:.3g}\n", spec.name, spec.rtol, method.error_test_rtol(spec));
}

}  // namespace

void print_outcome(const loop::World& world, const RunOutput& ran) {
  const loop::RunResult& result = ran.result;
  const std::vector<loop::PeakWrench>& peaks = ran.figures.peaks();
  fmt::print("{}: {} s simulated in {:.2f} s, assembled in {:.2f} s, peak memory {:.0f} MiB\n",
             short_name(world.description), time_text(result.time), result.wall_s, ran.assemble_s,
             peak_memory_mib());
  if (world.stepper) {
    const dynamics::StepperCounters& c = result.counters;
    fmt::print("{}: {} steps, {} force and {} tangent evaluations, {} factorisations, {} contact queries\n",
               world.stepper->name(), c.steps, c.force_evaluations, c.tangent_evaluations,
               c.solver.factorisations, result.contact_queries);
    print_tolerance(world.description.integrator);
  }
  if (!peaks.empty()) print_hand("the hand", peaks[0], result.ticks, result.limited_ticks);
  for (std::size_t i = 0; i < result.more_hands.size() && i + 1 < peaks.size(); ++i)
    print_hand(fmt::format("hand \"{}\"", world.description.hands[i].name), peaks[i + 1],
               result.more_hands[i].ticks, result.more_hands[i].limited_ticks);
  if (result.real_time) print_clock(*result.real_time);
  for (const std::string& remark : ran.remarks) fmt::print("{}\n", remark);
}

void keep_summary(const loop::World& world, const RunOutput& ran, const RunArguments& arguments,
                  const std::string& folder, const std::optional<Outcome>& outcome) {
  store::Summary summary = loop::summarise(world, ran.result, ran.assemble_s, ran.figures);
  if (outcome) summary.outcome = outcome->word, summary.message = outcome->message;
  if (ran.against) compare::add_to_summary(summary, world.description, *ran.against);
  if (const double every_s = arguments.checkpoint_every_s; every_s > 0.0)
    loop::add_checkpoints(summary, ran.checkpoints, every_s);
  summary.command = command_of(arguments);
  summary.overrides = arguments.scene.overrides;
  summary.remarks = log::warnings();
  summary.remarks.insert(summary.remarks.end(), ran.remarks.begin(), ran.remarks.end());
  if (ran.against)
    for (std::string& line : against_monolithic_remarks(world.description, *ran.against))
      summary.remarks.push_back(std::move(line));
  store::write_summary((std::filesystem::path(folder) / "summary.json").string(), summary);
  store::write_atomically((std::filesystem::path(folder) / "scene.toml").string(), world.description.source);
}

}  // namespace palpate::cli
