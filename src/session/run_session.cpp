#include "session/run_session.h"

#include <cmath>

#include "core/clock.h"
#include "core/counters.h"
#include "core/time_text.h"
#include "loop/choose_scheme.h"
#include "loop/haptic_record.h"
#include "palpate/core/error.h"
#include "report/run_report.h"
#include "session/clock_figures.h"
#include "session/run_files.h"
#include "session/run_remarks.h"
#include "session/run_summary.h"

namespace palpate::session {
namespace fs = std::filesystem;
namespace {

/// Returns the scene with what has to be recorded: the motion of a hand in real time cannot be repeated, and
/// is recorded, so that it can be replayed.
scene::Description with_record(scene::Description description, const Options& options) {
  if (options.real_time && description.tool && !description.record)
    description.record = RecordSpec{.states = false};
  return description;
}

}  // namespace

/// Returns the scene with the chosen scheme, if it leaves the choice to the machine; a remark then gives the
/// reason.
scene::Description RunSession::chosen(const scene::Description& description) {
  if (!description.tool || description.exchange.scheme != scene::ExchangeScheme::kAuto) return description;
  const loop::SchemeChoice choice = loop::choose_scheme(description);
  scheme_remark_ = choice.text();
  return loop::with_scheme(description, choice.scheme);
}

namespace {

/// Checks the options of a run without an end.
void check_endless(const Options& o) {
  if (!std::isinf(o.duration_s)) return;
  if (!o.real_time) fail("--duration-s inf: a run without an end needs the wall clock; add --realtime");
  if (o.against_monolithic)
    fail("--duration-s inf: --against-monolithic keeps every tick in memory; give a finite duration");
  if (o.checkpoint_every_s > 0.0)
    fail("--duration-s inf: a run in real time has no checkpoints; omit --checkpoint-every");
}

}  // namespace

RunSession::RunSession(const Options& options, const scene::Description& description, Resumption* resumption,
                       RunAttachments attachments)
    : options_(options),
      description_(with_record(chosen(description), options)),
      resumption_(resumption),
      attachments_(std::move(attachments)),
      has_checkpoints_(options.checkpoint_every_s > 0.0 || resumption),
      passivity_(device::PassivityController::mode_of(options.passivity)) {
  check_endless(options_);
  const PictureOptions pictures = check_pictures(options_, description_);
  if (has_checkpoints_) check_checkpoints(options_, description_);
  if (options_.against_monolithic) compare::refuse_against_monolithic(description_);
  if (has_checkpoints_ && !attachments_.hands.empty())
    fail("checkpoints: hands that are moved by the calling program cannot be resumed; leave out one of them");
  assemble();
  open_folder();
  attach_observers(pictures);
}

void RunSession::assemble() {
  const double start = wall_seconds();
  counters::reset();
  world_ = loop::assemble(description_, std::move(attachments_.hands));
  ran_.assemble_s = wall_seconds() - start;
  if (has_checkpoints_) prepare_checkpoints();
  loop::check_clock(*world_, options_.real_time);
}

/// Checks that the run can have checkpoints, and that a resumed one is of the same scene.
void RunSession::prepare_checkpoints() {
  identity_ = identity_of(options_, *world_);
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

void RunSession::open_folder() {
  const Options& o = options_;
  if (!description_.record && o.folder.empty() && !o.picture && !o.contact_picture && !o.draws_frames() &&
      !o.report && !o.trace && !has_checkpoints_)
    return;
  ran_.folder = resumption_         ? resumption_->folder
                : !o.folder.empty() ? o.folder
                                    : (fs::path("out") / fs::path(description_.path).stem()).string();
  refuse_own_input(description_, ran_.folder);
  lock_ = store::FolderLock(ran_.folder);
  if (!resumption_) {
    remove_run_files(description_, ran_.folder);
    remove_checkpoint(ran_.folder);
  }
  write_summary(
      *world_, ran_, options_,
      Outcome{"unfinished", "the run is in progress or was killed; data written so far are complete"});
}

void RunSession::attach_observers(const PictureOptions& pictures) {
  observers_ = {&ran_.figures, &penetration_warning_};
  pictures_.emplace(*world_, options_, pictures, ran_.folder);
  for (loop::Observer* observer : pictures_->observers()) observers_.push_back(observer);
  if (description_.record) {
    if (has_checkpoints_)
      recorder_.emplace(*world_, ran_.folder, resumption_ != nullptr, options_.duration_s);
    else
      recorder_.emplace(*world_, ran_.folder);
    observers_.push_back(&*recorder_);
  }
  if (options_.trace) trace_.emplace(*world_, path("trace.csv"));
  if (options_.against_monolithic) observers_.push_back(&memory_);
  observers_.insert(observers_.end(), attachments_.observers.begin(), attachments_.observers.end());
}

void RunSession::simulate(const Callbacks& callbacks) {
  loop::RunOptions options;
  options.duration_s = options_.duration_s;
  options.real_time = options_.real_time;
  options.passivity = passivity_;
  options.observers = observers_;
  options.progress = callbacks.progress;
  options.stop = callbacks.stop;
  options.pause = attachments_.pause;
  options.waiting = callbacks.waiting;
  try {
    ran_.result = has_checkpoints_
                      ? loop::run_with_checkpoints(
                            world_, options, checkpoint_plan(identity_, description_, ran_.folder),
                            ran_.checkpoints, resumption_ ? &resumption_->from : nullptr)
                      : loop::run(*world_, options);
  } catch (const Error& e) {
    if (ran_.folder.empty()) throw;
    try {
      if (world_) write_summary(*world_, ran_, options_, Outcome{"failed", e.what()});
    } catch (const Error&) {}  // on the same disk; its summary says that the run is unfinished
    if (penetration_warning_.rejected_start()) throw;
    fail("{} (data written so far are complete, in {})", e.what(), ran_.folder);
  }
  close_records();
  ran_.remarks = run_remarks(*world_, ran_.result);
  check_poses_arrived(*world_, ran_.result, ran_.missing);
  if (!scheme_remark_.empty()) ran_.remarks.insert(ran_.remarks.begin(), scheme_remark_);
}

/// Closes the recorder, which then writes its sidecar, and the trace.
void RunSession::close_records() {
  if (recorder_) {
    try {
      recorder_->close();
    } catch (const Error& e) { ran_.missing.add("sidecar " + path("run.xdmf"), e.what()); }
    recorder_.reset();
  }
  if (!trace_) return;
  trace_->close();
  ran_.trace = TracedSteps{trace_->attempts(), trace_->rejected()};
}

void RunSession::compare_with_monolithic(const Callbacks& callbacks) {
  if (!options_.against_monolithic || !ran_.is_complete()) return;
  ran_.against = compare::against_monolithic(*world_, memory_.records(), options_.real_time,
                                             callbacks.progress, callbacks.stop);
  if (!ran_.against->stopped && !ran_.against->trouble.empty())
    ran_.missing.add("error against the monolithic solution", ran_.against->trouble);
}

/// Reads the hands' motions from the files of the run, so that a run in real time keeps no ticks in memory.
void RunSession::compare_with_every_tick(const Callbacks& callbacks) {
  if (!ran_.is_complete() || !ran_.result.real_time || ran_.result.real_time->skipped_ticks == 0) return;
  std::vector<loop::HapticRecord> records;
  try {
    records = loop::read_haptic_records(ran_.folder, description_);
  } catch (const Error& e) { return ran_.missing.add("error of skipped ticks", e.what()); }
  ran_.against_every_tick = compare::against_every_tick(*world_, records, callbacks.progress, callbacks.stop);
  if (!ran_.against_every_tick->stopped && !ran_.against_every_tick->trouble.empty())
    ran_.missing.add("error of skipped ticks", ran_.against_every_tick->trouble);
}

void RunSession::compare_with_references(const Callbacks& callbacks) {
  compare_with_monolithic(callbacks);
  compare_with_every_tick(callbacks);
}

void RunSession::write_results() {
  if (ran_.folder.empty()) return;
  ran_.largest_value = pictures_->largest_value();
  write_summary(*world_, ran_, options_);
  if (ran_.is_complete()) remove_checkpoint(ran_.folder);
  if (ran_.result.real_time) write_clock(*ran_.result.real_time, ran_.folder);
  pictures_->save_pictures(*world_, ran_.missing);
  if (options_.report) report::add_missing(report::write_run_report(ran_.folder), ran_.missing);
}

void RunSession::draw_frames(const Callbacks& callbacks) {
  Callbacks drawing = callbacks;
  if (ran_.result.stopped) drawing.stop = nullptr;
  ran_.frames = pictures_->draw_frames(*world_, drawing, ran_.missing);
}

void RunSession::run(const Callbacks& callbacks) {
  simulate(callbacks);
  compare_with_references(callbacks);
  write_results();
  draw_frames(callbacks);
}

store::Summary RunSession::summary() const { return summary_of(*world_, ran_, options_); }

std::string RunSession::failure() const {
  const dynamics::StepResult& status = ran_.result.status;
  if (status.ok()) return {};
  return fmt::format(
      "{} failed at t = {} s: {}{}; a smaller tolerance or step often helps (--set integrator.rtol=..., "
      "integrator.step_s=...)",
      description_.integrator.name, time_text(status.t), status.message,
      ran_.folder.empty() ? "" : " (data written so far are complete)");
}

}  // namespace palpate::session
