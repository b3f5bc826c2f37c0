#include "experiments/compare/haptic.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "core/archive_bytes.h"
#include "experiments/compare/haptic_plan.h"
#include "experiments/compare/monolithic.h"
#include "experiments/compare/plan.h"
#include "experiments/compare/run.h"
#include "experiments/compare/task_process.h"
#include "loop/result_key.h"
#include "palpate/core/error.h"

namespace palpate::compare {
namespace {

/// Whether a point is repeated, to measure the spread of its time.
bool is_short(const HapticPoint& point, double limit_s) {
  double spent = 0.0;
  for (const double s : point.cpu_s) spent += s;
  return point.status == Status::kOk && spent <= 0.2 * limit_s;
}

/// Runs of a haptic comparison: the reference, its check, and the repeats of all points.
class HapticRuns : public experiments::Experiment {
 public:
  HapticRuns(const scene::Description& d, const CompareOptions& options,
             const std::vector<HapticPoint*>& points, HapticComparison& out)
      : options_(options),
        points_(points),
        out_(out),
        primary_(monolithic_scene(d)),
        check_(monolithic_scene(d, 2.0)) {
    for (std::size_t i = 0; i < kReferences + points.size(); ++i)
      keys_.push_back(loop::result_key(description_of(i), "haptic"));
  }

  std::size_t size() const override {
    return kReferences + points_.size() * static_cast<std::size_t>(std::max(1, options_.repeats));
  }
  bool is_ready(std::size_t i) override {
    if (is_reference(i)) return true;
    return references_.size() == kReferences && (repeat_of(i) == 0 || point_of(i).status != Status::kMissing);
  }
  bool is_wanted(std::size_t i) override {
    return is_reference(i) || repeat_of(i) == 0 || point_of(i).status == Status::kMissing ||
           is_short(point_of(i), options_.limit_s);
  }
  experiments::Task task(std::size_t i) override {
    const bool alone = !is_reference(i) && options_.jobs <= 0;
    return {"haptic",
            fmt::format("{} repeat {}", keys_[place_of(i)], repeat_of(i)),
            is_reference(i) ? "reference" : point_of(i).variable + " " + point_of(i).value,
            run_job,
            limit_of(i),
            alone,
            std::max(1, description_of(i).integrator.threads)};
  }
  std::string input(std::size_t i) override {
    return encode_job(WorkKind::kHaptic, description_of(i), limit_of(i), nullptr);
  }
  void take(std::size_t i, const experiments::Result& result) override {
    ++done_;
    if (is_reference(i))
      take_reference(i, result);
    else
      take_point(point_of(i), repeat_of(i), result);
  }
  bool has_dependencies() const override { return true; }
  std::size_t group(std::size_t i) override { return place_of(i); }
  std::string progress_text(std::size_t) override { return fmt::format("{} of {} runs", done_, size()); }
  std::string key() override {
    std::string keys;
    for (const std::string& one : keys_) keys += one;
    return experiments::key_of({"haptic", fmt::format("{}", options_.repeats), keys});
  }

 private:
  static constexpr std::size_t kReferences = 2;

  static bool is_reference(std::size_t i) { return i < kReferences; }
  /// Returns the index of the scene: references, then points.
  std::size_t place_of(std::size_t i) const {
    return is_reference(i) ? i : kReferences + (i - kReferences) % points_.size();
  }
  int repeat_of(std::size_t i) const {
    return is_reference(i) ? 0 : static_cast<int>((i - kReferences) / points_.size());
  }
  HapticPoint& point_of(std::size_t i) const { return *points_[place_of(i) - kReferences]; }
  const scene::Description& description_of(std::size_t i) const {
    return i == 0 ? primary_.description : i == 1 ? check_.description : point_of(i).description;
  }
  double limit_of(std::size_t i) const {
    return is_reference(i) ? options_.reference_limit_s : options_.limit_s;
  }

  void take_reference(std::size_t i, const experiments::Result& result) {
    ReferenceRun& run = references_[i];
    if (result.status == Status::kOk)
      run.run = restored<Run>(result.bytes);
    else
      run.trouble = result.reason;
    if (references_.size() < kReferences) return;
    out_.reference = settle({primary_.made_by, check_.made_by, {}, {}, {}, {}}, references_[0],
                            references_[1], wrench_distance);
    if (!out_.reference.available) return;
    reference_ = (references_[0].run ? references_[0] : references_[1]).run->trajectory;
    out_.peak_force_n = out_.reference.peak_force_n;
    out_.peak_torque_n_m = out_.reference.peak_torque_n_m;
  }

  void take_point(HapticPoint& point, int repeat, const experiments::Result& result) const {
    Run run;
    if (result.status == Status::kOk) {
      run = restored<Run>(result.bytes);
      point.cpu_s.push_back(run.result.cpu_s);
    }
    if (repeat > 0) return;
    // A process that was killed is a crash in this table, and runs again in the next call.
    point.status = result.status == Status::kMissing ? Status::kCrashed : result.status;
    point.reason = result.reason;
    if (result.status != Status::kOk) return;
    point.result = run.result;
    if (!reference_) return;
    try {
      point.error = wrench_distance(run.trajectory, *reference_);
      if (!std::isfinite(point.error.force_rms_n)) fail("not finite: the force on the hand is not usable");
    } catch (const Error& e) {  // Or there are no common ticks.
      point.error = no_distance();
      point.status = Status::kFailed;
      point.reason = e.what();
    }
  }

  const CompareOptions& options_;
  const std::vector<HapticPoint*>& points_;
  HapticComparison& out_;
  MonolithicScene primary_, check_;
  std::vector<std::string> keys_;                   ///< By place_of().
  std::map<std::size_t, ReferenceRun> references_;  ///< Those that have ended.
  std::optional<Trajectory> reference_;
  std::size_t done_ = 0;
};

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

HapticComparison compare_haptic(const scene::Description& description, const CompareOptions& options,
                                const experiments::Place& place, experiments::EngineOutcome& outcome) {
  const scene::Description d = with_overrides(description, {});  // Only the text counts.
  refuse_against_monolithic(d);
  HapticComparison out;
  out.scene = d.name;
  out.path = d.path;
  out.points = plan_haptic(d, options.integrators);

  std::vector<HapticPoint*> to_run;
  HapticPoint* own = nullptr;
  for (HapticPoint& point : out.points) {
    if (point.status != Status::kMissing || (point.own && own)) continue;
    if (point.own) own = &point;
    to_run.push_back(&point);
  }
  HapticRuns runs(d, options, to_run, out);
  experiments::EngineOptions engine;
  engine.jobs = experiments::jobs_or_cores(options.jobs);
  engine.stop = options.stop;
  engine.progress = options.progress;
  outcome = experiments::run(runs, place, engine);

  if (own) copy_own(out.points, HapticPoint(*own));
  for (HapticPoint& point : out.points) summarise(point, out.reference.own_error);
  out.orders = haptic_orders(out);
  out.stopped = outcome.stopped;
  out.reused = static_cast<long>(outcome.reused);
  out.rules = fmt::format(
      "Each run had a separate process, {} at a time, and at most {:g} CPU seconds ({:g} for the reference "
      "and its check). A point was run up to {} times, as long as its runs took less than {:g} CPU seconds "
      "in total; times are medians.",
      std::max(1, options.jobs), options.limit_s, options.reference_limit_s, options.repeats,
      0.2 * options.limit_s);
  return out;
}

}  // namespace palpate::compare
