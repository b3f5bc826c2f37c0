#include "run_session.h"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>

#include "against_monolithic.h"
#include "cli/missing_outputs.h"
#include "cli/paths.h"
#include "cli/progress.h"
#include "cli/scene_of.h"
#include "cli/stop.h"
#include "clock_figures.h"
#include "core/clock.h"
#include "core/counters.h"
#include "core/time_text.h"
#include "palpate/core/error.h"
#include "report/run_report.h"
#include "run_command_line.h"
#include "run_files.h"
#include "run_remarks.h"

namespace palpate::cli {
namespace {

/// Runs while a line on the terminal shows the progress.
/// @param checkpoints  null: none
/// @param from         the checkpoint to resume from; null: the start
loop::RunResult run_with_progress(std::unique_ptr<loop::World>& world, const RunArguments& arguments,
                                  std::vector<loop::Observer*> observers,
                                  const loop::CheckpointPlan* checkpoints, loop::CheckpointCost& cost,
                                  loop::Resumed* from) {
  Progress progress(fmt::format("running {}", short_name(world->description)));
  loop::RunOptions options;
  options.duration_s = arguments.duration_s;
  options.real_time = arguments.real_time;
  options.passivity = device::PassivityController::mode_of(arguments.passivity);
  options.observers = std::move(observers);
  options.progress = [&progress](double fraction) { progress(fraction); };
  options.stop = &stop_flag();
  options.waiting = [](const std::string& awaited) {
    fmt::print("waiting for {}\n", awaited);
    std::fflush(stdout);
  };
  return checkpoints ? loop::run_with_checkpoints(world, options, *checkpoints, cost, from)
                     : loop::run(*world, options);
}

}  // namespace

RunSession::RunSession(const RunArguments& arguments, const scene::Description& description,
                       MissingOutputs& missing, Resumption* resumption)
    : arguments_(arguments),
      description_(description),
      missing_(missing),
      resumption_(resumption),
      has_checkpoints_(arguments.checkpoint_every_s > 0.0 || resumption) {}

int RunSession::run() {
  const PictureOptions options = check_pictures(arguments_, description_);
  if (has_checkpoints_) check_checkpoints(arguments_, description_);
  if (arguments_.against_monolithic) compare::refuse_against_monolithic(description_);
  assemble();
  open_folder();
  attach_observers(options);
  simulate();
  close_records();
  ran_.remarks = run_remarks(*world_, ran_.result);
  print_outcome(*world_, ran_);
  if (has_checkpoints_) print_checkpoints(ran_.checkpoints, arguments_.checkpoint_every_s);
  compare_with_monolithic();
  const bool frames_stopped = write_results();
  return exit_status(frames_stopped);
}

void RunSession::assemble() {
  const double start = wall_seconds();
  if (resumption_) counters::reset();
  world_ = loop::assemble(description_);
  ran_.assemble_s = wall_seconds() - start;
  if (has_checkpoints_) prepare_checkpoints();
  loop::check_clock(*world_, arguments_.real_time);
}

/// Checks that the run can have checkpoints, and that a resumed one is of the same scene.
void RunSession::prepare_checkpoints() {
  identity_ = identity_of(arguments_, *world_);
  if (resumption_) {
    if (identity_.bodies != resumption_->identity.bodies)
      fail(
          "{}: a file used by the scene (a mesh, a recording) has changed since the run began; restore it, "
          "or run the scene again",
          identity_.scene_path);
    resumption_->from.counted = counters::snapshot();
  }
  if (const std::string why = loop::why_no_checkpoints(*world_, {}); !why.empty())
    fail("--checkpoint-every: {}", why);
}

/// Locks the folder, and writes the summary that remains if the run is killed.  A scene that records nothing
/// writes no file unless an option requests one.
void RunSession::open_folder() {
  const RunArguments& a = arguments_;
  writes_files_ = description_.record || !a.folder.empty() || a.picture || a.contact_picture || a.frames ||
                  !a.movie.empty() || a.report || a.trace || has_checkpoints_;
  folder_ = resumption_        ? resumption_->folder
            : a.folder.empty() ? default_folder(short_name(description_))
                               : a.folder;
  if (!writes_files_) return;
  refuse_own_input(description_, folder_);
  lock_ = store::ResultFolder(folder_);
  if (!resumption_) {
    remove_run_files(description_, folder_);
    remove_checkpoint(folder_);
  }
  keep_summary(
      *world_, ran_, arguments_, folder_,
      Outcome{"unfinished", "the run is in progress or was killed; data written so far are complete"});
}

void RunSession::attach_observers(const PictureOptions& options) {
  observers_ = {&ran_.figures, &penetration_warning_};
  pictures_.emplace(*world_, arguments_, options, folder_);
  for (loop::Observer* observer : pictures_->observers()) observers_.push_back(observer);
  if (description_.record) {
    if (has_checkpoints_)
      recorder_.emplace(*world_, folder_, resumption_ != nullptr, arguments_.duration_s);
    else
      recorder_.emplace(*world_, folder_);
    observers_.push_back(&*recorder_);
  }
  if (arguments_.trace) trace_.emplace(*world_, path("trace.csv"));
  if (arguments_.against_monolithic) observers_.push_back(&memory_);
}

/// Runs the scene.  After an error, a full disk for example, the summary has its message.
void RunSession::simulate() {
  std::optional<loop::CheckpointPlan> plan;
  if (has_checkpoints_) plan = checkpoint_plan(identity_, description_, folder_);
  try {
    ran_.result = run_with_progress(world_, arguments_, observers_, plan ? &*plan : nullptr, ran_.checkpoints,
                                    resumption_ ? &resumption_->from : nullptr);
  } catch (const Error& e) {
    if (!writes_files_) throw;
    try {
      if (world_) keep_summary(*world_, ran_, arguments_, folder_, Outcome{"failed", e.what()});
    } catch (const Error&) {}  // on the same disk; its summary says that the run is unfinished
    fail("{} (data written so far are complete, in {})", e.what(), folder_);
  }
}

/// Closes the recorder, which then writes its sidecar, and the trace.
void RunSession::close_records() {
  if (recorder_) {
    try {
      recorder_->close();
    } catch (const Error& e) { missing_.add("sidecar " + path("run.xdmf"), e.what()); }
    recorder_.reset();
  }
  if (!trace_) return;
  trace_->close();
  fmt::print("trace: {} attempted steps, {} rejected; an error of 1 is the tolerance of the error test\n",
             trace_->attempts(), trace_->rejected());
}

void RunSession::compare_with_monolithic() {
  if (!arguments_.against_monolithic || !is_complete()) return;
  ran_.against = against_monolithic(*world_, memory_.records(), arguments_.real_time);
  if (!ran_.against->stopped && !ran_.against->trouble.empty())
    missing_.add("error against the monolithic solution", ran_.against->trouble);
}

bool RunSession::write_results() {
  if (!writes_files_) {
    fmt::print("no file was written, because the scene has no [record]\n");
    return false;
  }
  keep_summary(*world_, ran_, arguments_, folder_);
  if (is_complete()) remove_checkpoint(folder_);
  if (ran_.result.real_time) keep_clock(*ran_.result.real_time, folder_);
  pictures_->save_pictures(*world_, missing_);
  if (arguments_.report) missing_.add(report::write_run_report(folder_));
  print_run_files(description_, folder_);
  return pictures_->save_frames(*world_, ran_.result.stopped, missing_);
}

/// Prints what ended the run early.  @throws Error for a run that failed
int RunSession::exit_status(bool frames_stopped) const {
  const loop::RunResult& result = ran_.result;
  if (!result.status.ok())
    fail(
        "{} failed at t = {} s: {}{}; a smaller tolerance or step often helps (--set integrator.rtol=..., "
        "integrator.step_s=...)",
        description_.integrator.name, time_text(result.status.t), result.status.message,
        writes_files_ ? " (data written so far are complete)" : "");
  if (result.stopped) {
    fmt::print(stderr, "palpate: stopped at t = {} s{}\n", time_text(result.time),
               writes_files_ ? "; data written so far are complete" : "");
    if (ran_.checkpoints.written > 0)
      fmt::print(stderr, "palpate: `palpate resume {}` resumes it\n", quoted(folder_));
    return kExitStopped;
  }
  const bool monolithic_stopped = ran_.against && ran_.against->stopped;
  if (frames_stopped)
    fmt::print(stderr, "palpate: stopped while drawing frames; those written are complete\n");
  if (monolithic_stopped)
    fmt::print(stderr,
               "palpate: stopped before the monolithic solution was complete; the run itself is complete\n");
  return frames_stopped || monolithic_stopped ? kExitStopped : 0;
}

}  // namespace palpate::cli
