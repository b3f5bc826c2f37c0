#include "experiments/compare/run.h"

#include <cmath>

#include "core/archive_bytes.h"
#include "core/rounding.h"
#include "experiments/compare/run_archive.h"
#include "loop/run_figures.h"
#include "palpate/core/error.h"

namespace palpate::compare {

void PointRun::archive(Archive& a) {
  a("error", error);
  a("setup_s", setup_s);
  a("record_s", record_s);
  archive_result(a, result);
}

std::string out_of_time_reason(double limit_s, const loop::RunResult& result) {
  return fmt::format("out of time: {:g} s (at t = {:.4g} s)", limit_s, result.time);
}

experiments::Result run_point(const scene::Description& d, double limit_s, const Trajectory* reference,
                              const std::atomic<bool>* out_of_time) {
  const Run run = run_once(d, d.compare.duration_s, out_of_time);
  const dynamics::StepResult& last = run.result.status;
  experiments::Result out;
  PointRun point{no_distance(), run.setup_s, run.record_s, run.result};
  if (run.result.stopped) {
    out.status = Status::kOutOfTime;
    out.reason = out_of_time_reason(limit_s, run.result);
  } else if (!last.ok()) {
    out.status = last.status == dynamics::StepStatus::kBadSettings ? Status::kRefused : Status::kFailed;
    out.reason = fmt::format("{}: {}", dynamics::to_string(last.status), last.message);
  } else if (reference) {
    point.error = distance(run.trajectory, *reference);
    if (!std::isfinite(point.error.position_rel_l2)) {
      out.status = Status::kFailed;
      out.reason = "not finite: the run reached its end without a usable state";
      point.error = no_distance();
    }
  }
  out.cpu_s = run.result.cpu_s;
  out.bytes = archived(point);
  return out;
}

Reference settle(const PlannedReference& planned, const ReferenceRun& primary, const ReferenceRun& check,
                 TrajectoryError (*measure)(const Trajectory&, const Trajectory&)) {
  Reference out;
  out.available = primary.run || check.run;
  if (primary.run && check.run) {
    out.description = fmt::format("{}, checked against {}", planned.made_by, planned.checked_by);
    out.own_error = measure(check.run->trajectory, primary.run->trajectory);
  } else if (primary.run) {
    out.description = planned.made_by + ", not checked";
    out.trouble = fmt::format("the check by {} failed ({}): the error of the reference is unknown",
                              planned.checked_by, check.trouble);
  } else if (check.run) {
    out.description = planned.checked_by + ", not checked";
    out.trouble =
        fmt::format("the reference by {} failed ({}): the check replaces it, and its error is unknown",
                    planned.made_by, primary.trouble);
  } else {
    out.description = "none";
    out.trouble = fmt::format(
        "there is no reference: {} failed ({}), and so did {} ({}); the points have costs, but no errors",
        planned.made_by, primary.trouble, planned.checked_by, check.trouble);
  }
  if (!out.available) return out;
  const Run& used = *(primary.run ? primary : check).run;
  out.cpu_s = used.result.cpu_s;
  const loop::PeakWrench peak = loop::peak_of(used.trajectory.device, used.trajectory.tick_times);
  out.peak_force_n = peak.force_n;
  // Without positions, wrenches are compared: haptic scenes are of the size of a metre.
  const VecX& start = used.trajectory.start;
  const double size_m = start.size() > 0 ? start.cwiseAbs().maxCoeff() : 1.0;
  if (peak.torque_n_m > torque_rounding(peak.force_n, size_m)) out.peak_torque_n_m = peak.torque_n_m;
  return out;
}

}  // namespace palpate::compare
