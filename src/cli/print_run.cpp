#include "print_run.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

#include "cli/scene_of.h"
#include "core/clock.h"
#include "core/rounding.h"
#include "core/time_text.h"
#include "loop/registries.h"
#include "palpate/scene/hands.h"
#include "session/command_line.h"
#include "session/reference_remarks.h"
#include "session/run_files.h"

namespace palpate::cli {
namespace {

/// Returns the size of a scene's coordinates [m]: bodies at the start, tools, and their handles.
double size_of(const loop::World& world) {
  double out = 0.0;
  for (const loop::Body& body : world.bodies)
    if (body.placed.size() > 0) out = std::max(out, body.placed.cwiseAbs().maxCoeff());
  for (const scene::Hand& hand : scene::hands_of(world.description))
    out = std::max(out, hand.tool->position_m.cwiseAbs().maxCoeff());
  return out;
}

void print_hand(const std::string& who, const loop::PeakWrench& peak, double size_m, long ticks,
                long limited) {
  std::string out = fmt::format("on {}: ", who);
  if (peak.force_n > 0.0)
    out += fmt::format("at most {:.4g} N (at {} s)", peak.force_n, time_text(peak.force_at_s));
  else
    out += "no force";
  if (peak.torque_n_m > torque_rounding(peak.force_n, size_m))
    out += fmt::format(" and {:.4g} N m (at {} s)", peak.torque_n_m, time_text(peak.torque_at_s));
  else
    out += ", no torque";
  out += fmt::format(", in {} ticks", ticks);
  if (limited > 0) out += fmt::format("; {} of them held at the device's limit", limited);
  fmt::print("{}\n", out);
}

/// Prints the requested tolerance, and the tolerance of the error test that the method derives from it.
void print_tolerance(const IntegratorSpec& spec) {
  const auto& method = find(loop::steppers(), spec.name, "integrator");
  if (method.error_test_rtol && !spec.fixed_step)
    fmt::print("{}: rtol {:g}, error test at {:.3g}\n", spec.name, spec.rtol, method.error_test_rtol(spec));
}

void print_series(const char* what, const std::vector<float>& values, double unit, const char* name) {
  fmt::print("  {:<18}{:>9.1f} {:>9.1f} {:>9.1f} {:>9.1f} {}\n", what, loop::quantile(values, 0.5) / unit,
             loop::quantile(values, 0.99) / unit, loop::quantile(values, 0.999) / unit,
             loop::quantile(values, 1.0) / unit, name);
}

void print_clock(const loop::RealTimeResult& clock) {
  fmt::print("ticks in real time: {}, {}, memory {}\n", clock.scheduling,
             clock.cpu < 0 ? std::string("on any processor") : fmt::format("on processor {}", clock.cpu),
             clock.memory);
  fmt::print("  {:<18}{:>9} {:>9} {:>9} {:>9}\n", "", "p50", "p99", "p99.9", "max");
  print_series("tick lateness", clock.lateness_s, 1e-6, "us");
  print_series("tick work", clock.work_s, 1e-6, "us");
  print_series("exchange latency", clock.latency_s, 1e-3, "ms");
}

void print_checkpoints(const loop::CheckpointCost& cost, double every_s) {
  fmt::print(
      "checkpoints: {}, one per {:g} s of simulated time; {:.3g} s to write them and {:.3g} s to reassemble "
      "the scene, with integrator, factors and initial guesses, after each\n",
      cost.written, every_s, cost.keep_s, cost.assemble_s);
}

}  // namespace

void print_outcome(const loop::World& world, const session::RunOutput& ran, const session::Options& options) {
  const loop::RunResult& result = ran.result;
  const std::vector<loop::PeakWrench>& peaks = ran.figures.peaks();
  fmt::print("{}: {} s simulated in {:.2f} s, assembled in {:.2f} s, peak memory {:.0f} MiB\n",
             short_name(world.description), time_text(result.time), result.wall_s, ran.assemble_s,
             peak_memory_mib());
  const double size_m = size_of(world);
  if (!peaks.empty()) print_hand("the hand", peaks[0], size_m, result.ticks, result.limited_ticks);
  for (std::size_t i = 0; i < result.more_hands.size() && i + 1 < peaks.size(); ++i)
    print_hand(fmt::format("hand \"{}\"", world.description.hands[i].name), peaks[i + 1], size_m,
               result.more_hands[i].ticks, result.more_hands[i].limited_ticks);
  if (world.stepper) {
    const dynamics::StepperCounters& c = result.counters;
    fmt::print("{}: {} steps, {} force and {} tangent evaluations, {} factorisations{}\n",
               world.stepper->name(), c.steps, c.force_evaluations, c.tangent_evaluations,
               c.solver.factorisations,
               result.contact_queries > 0 ? fmt::format(", {} contact queries", result.contact_queries) : "");
    print_tolerance(world.description.integrator);
  }
  if (ran.trace)
    fmt::print("trace: {} attempted steps, {} rejected; an error of 1 is the tolerance of the error test\n",
               ran.trace->attempted, ran.trace->rejected);
  if (result.real_time) print_clock(*result.real_time);
  for (const std::string& remark : ran.remarks) fmt::print("{}\n", remark);
  if (options.checkpoint_every_s > 0.0) print_checkpoints(ran.checkpoints, options.checkpoint_every_s);
}

void print_against_references(const loop::World& world, const session::RunOutput& ran) {
  for (const auto& against : {ran.against, ran.against_every_tick})
    if (against)
      for (const std::string& line : session::reference_remarks(world.description, *against))
        fmt::print("{}\n", line);
}

void print_files(const loop::World& world, const session::RunOutput& ran) {
  if (ran.folder.empty()) {
    fmt::print("no file was written, because the scene has no [record]\n");
    return;
  }
  fmt::print("in {}: {}\n", ran.folder, fmt::join(session::run_files(world.description, ran.folder), ", "));
  if (!world.description.record)
    fmt::print(
        "states{} were not written, because the scene has no [record]; --set record.states=true writes "
        "them\n",
        world.description.tool ? " and the force over time" : "");
}

void print_frames(const session::DrawnFrames& frames) {
  if (!frames.folder.empty()) {
    fmt::print("{} of {} frames in {}, one every {:g} s of simulated time; to make a movie in real time:\n",
               frames.in_folder, frames.count, frames.folder, frames.between_s);
    fmt::print("  ffmpeg -framerate {:g} -i {}/%04d.png -pix_fmt yuv420p {}.mp4\n", 1.0 / frames.between_s,
               frames.folder, frames.folder);
  }
  if (!frames.movie.empty())
    fmt::print("{} of {} frames in {}, one every {:g} s of simulated time; {:.4g} per second when played\n",
               frames.in_movie, frames.count, frames.movie, frames.between_s, 1.0 / frames.shown_s);
}

bool print_stop(const session::RunOutput& ran) {
  if (ran.result.stopped) {
    fmt::print(stderr, "palpate: stopped at t = {} s{}\n", time_text(ran.result.time),
               ran.folder.empty() ? "" : "; data written so far are complete");
    if (ran.checkpoints.written > 0)
      fmt::print(stderr, "palpate: `palpate resume {}` resumes it\n", session::quoted(ran.folder));
    return true;
  }
  const bool frames_stopped = ran.frames && ran.frames->stopped;
  const bool monolithic_stopped = ran.against && ran.against->stopped;
  if (frames_stopped)
    fmt::print(stderr, "palpate: stopped while drawing frames; those written are complete\n");
  if (monolithic_stopped)
    fmt::print(stderr,
               "palpate: stopped before the monolithic solution was complete; the run itself is complete\n");
  return frames_stopped || monolithic_stopped;
}

}  // namespace palpate::cli
