#include "compare/haptic.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>
#include <thread>

#include "codec.h"
#include "core/process_pool.h"
#include "haptic_plan.h"
#include "loop/result_key.h"
#include "palpate/core/error.h"
#include "plan.h"
#include "run.h"
#include "work.h"

namespace palpate::compare {
namespace {

using Outcome = ProcessPool::Outcome;

/// Outcome of one run.
struct Ended {
  PointStatus status = PointStatus::kMissing;
  std::string reason;
  Run run;  ///< Valid where the status is kOk.
};

/// Run to be made.
struct Job {
  const scene::Description* description;
  int repeat;
  std::function<void(const Ended&)> take;
  std::function<bool()> requested = {};  ///< Evaluated when the job is due; empty: always run.
};

PointStatus status_of(const std::string& text) {
  for (const PointStatus one : {PointStatus::kOk, PointStatus::kFailed, PointStatus::kOutOfTime,
                                PointStatus::kCrashed, PointStatus::kRefused})
    if (text == to_string(one)) return one;
  return PointStatus::kCrashed;
}

/// Runs jobs and stores their results.
class Runner {
 public:
  Runner(const CompareOptions& options, long jobs_in_all)
      : options_(options),
        in_all_(jobs_in_all),
        database_(options.database.empty() ? ":memory:" : options.database, run_columns()) {}

  bool stopped() const { return options_.stop && options_.stop->load(); }
  long reused() const { return reused_; }

  /// Runs jobs to their end.
  /// @param side_by_side  number of parallel jobs
  /// @param limit_s  CPU limit per job [s]
  void run(std::deque<Job> jobs, int side_by_side, double limit_s) {
    ProcessPool pool(side_by_side);
    while (!stopped() && !(jobs.empty() && pool.idle())) {
      while (!jobs.empty() && pool.has_room()) {
        const Job job = std::move(jobs.front());
        jobs.pop_front();
        if (!job.requested || job.requested()) begin(pool, job, limit_s);
      }
      if (!pool.idle()) pool.wait(0.2);
    }
  }

 private:
  void begin(ProcessPool& pool, const Job& job, double limit_s) {
    const std::string key = loop::result_key(*job.description, fmt::format("haptic {}", job.repeat));
    const auto kept = database_.artefact(key);
    if (kept && !(kept->status == to_string(PointStatus::kOutOfTime) && kept->cpu_s < limit_s)) {
      ++reused_;
      finish(job, *kept);
      return;
    }
    pool.start(run_job, encode_job(WorkKind::kHaptic, *job.description, limit_s, nullptr), limit_s,
               [this, job, key, limit_s](const Outcome& outcome) {
                 if (stopped()) return;  // The run may have been interrupted.
                 const store::StudyArtefact made = artefact_of(key, outcome, limit_s);
                 database_.put(made);
                 finish(job, made);
               });
  }

  static store::StudyArtefact artefact_of(const std::string& key, const Outcome& outcome, double limit_s) {
    store::StudyArtefact out{key, "haptic", to_string(PointStatus::kOk), "", 0.0, outcome.bytes};
    const auto failed = [&](PointStatus status, const std::string& why) {
      out.status = to_string(status);
      out.reason = why;
      out.bytes.clear();
    };
    switch (outcome.end) {
      case Outcome::End::kError: failed(PointStatus::kRefused, outcome.bytes); return out;
      case Outcome::End::kCrash: failed(PointStatus::kCrashed, outcome.bytes); return out;
      case Outcome::End::kOutOfTime: failed(PointStatus::kOutOfTime, outcome.bytes); break;
      case Outcome::End::kDone: {
        const loop::RunResult result = run_of(outcome.bytes).result;
        out.cpu_s = result.cpu_s;
        if (result.stopped)
          failed(PointStatus::kOutOfTime,
                 fmt::format("out of time: {:g} s (at t = {:.4g} s)", limit_s, result.time));
        else if (!result.status.ok())
          failed(PointStatus::kFailed,
                 fmt::format("{}: {}", dynamics::to_string(result.status.status), result.status.message));
      }
    }
    // A longer limit causes a new attempt.
    if (out.status == to_string(PointStatus::kOutOfTime)) out.cpu_s = limit_s;
    return out;
  }

  void finish(const Job& job, const store::StudyArtefact& kept) {
    Ended ended{status_of(kept.status), kept.reason, {}};
    if (ended.status == PointStatus::kOk) ended.run = run_of(kept.bytes);
    job.take(ended);
    ++done_;
    if (options_.progress)
      options_.progress(std::min(1.0, static_cast<double>(done_) / static_cast<double>(in_all_)),
                        fmt::format("{} of {} runs", done_, in_all_));
  }

  const CompareOptions& options_;
  long in_all_, done_ = 0, reused_ = 0;
  store::StudyDb database_;
};

int cores() { return std::max(1, static_cast<int>(std::thread::hardware_concurrency())); }

ReferenceRun reference_run_of(const Ended& ended) {
  if (ended.status == PointStatus::kOk) return {ended.run, ""};
  return {std::nullopt, ended.reason};
}

/// Runs reference and check; returns the trajectory of the reference if there is one.
std::optional<Trajectory> run_references(const scene::Description& d, Runner& runner,
                                         const CompareOptions& options, HapticComparison& out) {
  const MonolithicScene primary = monolithic_scene(d), check = monolithic_scene(d, 2.0);
  ReferenceRun primary_run, check_run;
  runner.run({{&primary.description, 0, [&](const Ended& e) { primary_run = reference_run_of(e); }},
              {&check.description, 0, [&](const Ended& e) { check_run = reference_run_of(e); }}},
             options.jobs > 0 ? options.jobs : cores(), options.reference_limit_s);
  if (runner.stopped()) return {};
  out.reference =
      settle({primary.made_by, check.made_by, {}, {}, {}, {}}, primary_run, check_run, wrench_distance);
  if (!out.reference.available) return {};
  const Trajectory reference = (primary_run.run ? primary_run : check_run).run->trajectory;
  out.peak_force_n = out.reference.peak_force_n;
  out.peak_torque_n_m = out.reference.peak_torque_n_m;
  return reference;
}

void take(HapticPoint& point, int repeat, const Ended& ended, const std::optional<Trajectory>& reference) {
  if (ended.status == PointStatus::kOk) point.cpu_s.push_back(ended.run.result.cpu_s);
  if (repeat > 0) return;
  point.status = ended.status;
  point.reason = ended.reason;
  if (ended.status != PointStatus::kOk) return;
  point.result = ended.run.result;
  if (!reference) return;
  try {
    point.error = wrench_distance(ended.run.trajectory, *reference);
    if (!std::isfinite(point.error.force_rms_n)) fail("not finite: the force on the hand is not usable");
  } catch (const Error& e) {  // Or there are no common ticks.
    point.error = no_distance();
    point.status = PointStatus::kFailed;
    point.reason = e.what();
  }
}

/// Whether a point is repeated, to measure the spread of its time.
bool is_short(const HapticPoint& point, double limit_s) {
  double spent = 0.0;
  for (const double s : point.cpu_s) spent += s;
  return point.status == PointStatus::kOk && spent <= 0.2 * limit_s;
}

std::deque<Job> jobs_of(std::vector<HapticPoint*> points, const CompareOptions& options,
                        const std::optional<Trajectory>& reference) {
  std::deque<Job> jobs;
  for (int repeat = 0; repeat < std::max(1, options.repeats); ++repeat)
    for (HapticPoint* point : points) {
      Job job{&point->description, repeat,
              [point, repeat, &reference](const Ended& e) { take(*point, repeat, e, reference); }};
      if (repeat > 0) job.requested = [point, limit = options.limit_s] { return is_short(*point, limit); };
      jobs.push_back(std::move(job));
    }
  return jobs;
}

/// Copies the point with the scene's settings, which is run once, to all variables.
void copy_own(std::vector<HapticPoint>& points, const HapticPoint& own) {
  for (HapticPoint& point : points) {
    if (!point.own) continue;
    HapticPoint copy = own;
    copy.variable = point.variable;
    copy.value = point.value;
    copy.setting = point.setting;
    point = copy;
  }
}

}  // namespace

HapticComparison compare_haptic(const scene::Description& description, const CompareOptions& options) {
  const scene::Description d = with_overrides(description, {});  // Only the text counts.
  refuse_against_monolithic(d);
  HapticComparison out;
  out.scene = d.name;
  out.path = d.path;
  out.points = plan_haptic(d, options.integrators);

  std::vector<HapticPoint*> to_run;
  HapticPoint* own = nullptr;
  for (HapticPoint& point : out.points) {
    if (point.status != PointStatus::kMissing || (point.own && own)) continue;
    if (point.own) own = &point;
    to_run.push_back(&point);
  }
  Runner runner(options, 2 + std::max(1, options.repeats) * std::ssize(to_run));
  const std::optional<Trajectory> reference = run_references(d, runner, options, out);
  const int jobs = std::max(1, options.jobs);
  runner.run(jobs_of(to_run, options, reference), jobs, options.limit_s);

  if (own) copy_own(out.points, HapticPoint(*own));
  for (HapticPoint& point : out.points) summarise(point, out.reference.own_error);
  out.orders = haptic_orders(out);
  out.stopped = runner.stopped();
  out.reused = runner.reused();
  out.rules = fmt::format(
      "Each run had a separate process, {} at a time, and at most {:g} CPU seconds ({:g} for the reference "
      "and its check). A point was run up to {} times, as long as its runs took less than {:g} CPU seconds "
      "in total; times are medians.",
      jobs, options.limit_s, options.reference_limit_s, options.repeats, 0.2 * options.limit_s);
  return out;
}

}  // namespace palpate::compare
