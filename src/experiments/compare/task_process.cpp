#include "experiments/compare/task_process.h"

#include <algorithm>

#include "core/archive_bytes.h"
#include "experiments/compare/mesh_run.h"
#include "experiments/compare/methods.h"
#include "experiments/compare/run.h"
#include "palpate/core/error.h"
#include "palpate/experiments/compare.h"
#include "palpate/loop/load.h"

namespace palpate::compare {
namespace {

struct Job {
  WorkKind kind = WorkKind::kPoint;
  std::string source, path;
  double limit_s = 0.0;
  bool has_reference = false;
  Trajectory reference;

  void archive(Archive& a) {
    a("kind", kind);
    a("source", source);
    a("path", path);
    a("limit_s", limit_s);
    a("has_reference", has_reference);
    if (has_reference) a("reference", reference);
  }
};

/// @tparam AnyRun  Run or MeshRun
template <class AnyRun>
experiments::Result result_of(const AnyRun& run, const Job& job) {
  const dynamics::StepResult& last = run.result.status;
  experiments::Result out;
  out.cpu_s = run.result.cpu_s;
  if (run.result.stopped) {
    out.status = Status::kOutOfTime;
    out.reason = out_of_time_reason(job.limit_s, run.result);
  } else if (!last.ok()) {
    out.status = Status::kFailed;
    out.reason = job.kind == WorkKind::kHaptic || job.kind == WorkKind::kMesh
                     ? fmt::format("{}: {}", dynamics::to_string(last.status), last.message)
                     : last.message;
  } else {
    out.bytes = archived(run);
  }
  return out;
}

/// Returns the result of a chart with `made` of `planned` points, which the limit may have cut off.
template <class Chart>
experiments::Result chart_of(Chart chart, std::size_t made, std::size_t planned, const Job& job) {
  experiments::Result out;
  if (made < planned) {
    out.status = Status::kOutOfTime;
    out.reason = fmt::format("out of time: {:g} s (after {} of {} points)", job.limit_s, made, planned);
  }
  out.bytes = archived(std::move(chart));
  return out;
}

experiments::Result run_kind(const Job& job, const std::atomic<bool>& out_of_time) {
  const scene::Description d = loop::parse(job.source, job.path);
  switch (job.kind) {
    case WorkKind::kReference: return result_of(run_once(d, d.compare.duration_s, &out_of_time), job);
    case WorkKind::kHaptic: return result_of(run_for_wrenches(d, d.compare.duration_s, &out_of_time), job);
    case WorkKind::kMesh: return result_of(run_for_mesh(d, d.compare.duration_s, &out_of_time), job);
    case WorkKind::kExchange: {
      ExchangeStudy study = compare_exchange(d, {{}, &out_of_time});
      const std::size_t made = study.points.size(),
                        planned = exchange_runs(d) > 0 ? d.compare.exchange_periods_s.size() : 0;
      return chart_of(std::move(study), made, planned, job);
    }
    case WorkKind::kMethods: {
      Methods methods{compare_contact_methods(d, &out_of_time)};
      const std::size_t made = methods.points.size(), planned = d.compare.contact_methods.size();
      return chart_of(std::move(methods), made, planned, job);
    }
    case WorkKind::kPoint: break;
  }
  return run_point(d, job.limit_s, job.has_reference ? &job.reference : nullptr, &out_of_time);
}

}  // namespace

std::string encode_job(WorkKind kind, const scene::Description& description, double limit_s,
                       const Trajectory* reference) {
  Job job{kind, description.source, description.path, limit_s, reference != nullptr, {}};
  if (reference) job.reference = *reference;
  return archived(std::move(job));
}

std::string run_job(const std::string& input, const std::atomic<bool>& out_of_time) {
  experiments::Result out;
  try {
    out = run_kind(restored<Job>(input), out_of_time);
  } catch (const Error& refusal) {
    out.status = Status::kRefused;
    out.reason = refusal.what();
  }
  return archived(out);
}

}  // namespace palpate::compare
