#include "palpate/study/compare.h"

#include <algorithm>
#include <cmath>

#include "palpate/core/error.h"
#include "palpate/core/log.h"

namespace palpate::study {
namespace {

scene::Description with_setting(scene::Description d, const std::string& integrator, const std::string& setting, double value) {
  d.integrator.name = integrator;
  (setting == "rtol" ? d.integrator.rtol : d.integrator.step_s) = value;
  return d;
}

/// Says where the work stands and whether it should go on.
class Progress {
 public:
  Progress(const CompareOptions& options, int total) : options_(options), total_(total) {}
  bool stopped() const { return options_.stop && options_.stop->load(); }
  void done(const std::string& what) {
    ++done_;
    if (options_.progress) options_.progress(std::min(1.0, static_cast<double>(done_) / total_), what);
  }

 private:
  const CompareOptions& options_;
  int total_, done_ = 0;
};

std::vector<ComparePoint> ladder_points(const scene::Description& d, const CompareOptions& options) {
  std::vector<ComparePoint> points;
  for (const scene::LadderSpec& ladder : d.compare.ladders) {
    const auto& wanted = options.integrators;
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), ladder.integrator) == wanted.end()) continue;
    for (double value : ladder.values) {
      ComparePoint point;
      point.integrator = ladder.integrator;
      point.setting_name = ladder.setting;
      point.setting = value;
      points.push_back(point);
    }
  }
  return points;
}

Trajectory make_reference(const scene::Description& d, Reference& reference, Progress& progress, const std::atomic<bool>* stop) {
  const double duration = d.compare.duration_s;
  const Run truth = run_once(with_setting(d, "cvode-bdf", "rtol", d.compare.reference_rtol), duration, stop);
  if (!truth.result.status.ok()) fail("scene \"{}\": the reference run failed: {}", d.name, truth.result.status.message);
  progress.done("reference");
  const Run check = run_once(with_setting(d, d.compare.reference_check, "rtol", d.compare.reference_check_rtol), duration, stop);
  if (!check.result.status.ok()) fail("scene \"{}\": the check of the reference by {} failed: {}", d.name, d.compare.reference_check, check.result.status.message);
  progress.done("check of the reference");
  reference.description = fmt::format("cvode-bdf at rtol {:g}, checked against {} at rtol {:g}", d.compare.reference_rtol, d.compare.reference_check,
                                      d.compare.reference_check_rtol);
  reference.own_error = distance(check.trajectory, truth.trajectory);
  reference.cpu_s = truth.result.cpu_s;
  return truth.trajectory;
}

void run_point(const scene::Description& d, ComparePoint& point, const Trajectory& truth, const Reference& reference, const std::atomic<bool>* stop) {
  const Run run = run_once(with_setting(d, point.integrator, point.setting_name, point.setting), d.compare.duration_s, stop);
  if (run.result.stopped) return;
  point.cpu_s.push_back(run.result.cpu_s);
  if (point.cpu_s.size() > 1) return;
  point.result = run.result;
  point.error = run.result.status.ok() ? distance(run.trajectory, truth) : no_distance();
  const TrajectoryError& own = reference.own_error;  // NaN is never below
  point.below_reference = point.error.position_rel_l2 <= own.position_rel_l2;
  point.force_below_reference = point.error.force_rms_n <= own.force_rms_n;
  point.torque_below_reference = point.error.torque_rms_n_m <= own.torque_rms_n_m;
}

void summarise_times(ComparePoint& point) {
  if (point.cpu_s.empty()) return;
  std::vector<double> sorted = point.cpu_s;
  std::sort(sorted.begin(), sorted.end());
  point.cpu_min_s = sorted.front();
  point.cpu_max_s = sorted.back();
  point.cpu_median_s = sorted[sorted.size() / 2];
}

}  // namespace

Comparison compare(const scene::Description& d, const CompareOptions& options) {
  Comparison out;
  out.scene = d.name;
  out.points = ladder_points(d, options);
  if (out.points.empty()) fail("scene \"{}\": nothing to compare; add [[compare.ladder]] tables with an integrator and its rtol or step_s values", d.name);
  Progress progress(options, 2 + options.repeats * static_cast<int>(out.points.size()) + exchange_runs(d));
  const Trajectory truth = make_reference(d, out.reference, progress, options.stop);
  for (int repeat = 0; repeat < options.repeats; ++repeat)
    for (ComparePoint& point : out.points) {
      if (progress.stopped()) break;
      run_point(d, point, truth, out.reference, options.stop);
      progress.done(fmt::format("{} {} = {:g}", point.integrator, point.setting_name, point.setting));
    }
  for (ComparePoint& point : out.points) summarise_times(point);
  if (!progress.stopped()) out.exchange = compare_exchange(d, {[&](const std::string& what) { progress.done(what); }, options.stop});
  if (!progress.stopped()) out.methods = compare_contact_methods(d, options.stop);
  out.stopped = progress.stopped();
  return out;
}

}  // namespace palpate::study
