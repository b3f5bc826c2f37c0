#include "validation_pool.h"

#include <algorithm>
#include <numeric>

#include "core/archive_bytes.h"
#include "core/clock.h"

namespace palpate::cli {
namespace {

using validation::Measurement;
using validation::ValidationCase;

constexpr double kLimitS = 7200.0;  // [s] of CPU time, after which a case counts as hanging.

/// Input of a case's process.
struct Job {
  std::size_t index = 0;
  std::string fault;

  void archive(Archive& a) {
    a("index", index);
    a("fault", fault);
  }
};

/// A ProcessPool::Work: runs a case.
std::string run_job(const std::string& input, const std::atomic<bool>&) {
  const auto job = restored<Job>(input);
  const double start = wall_seconds(), cpu_start = cpu_seconds();
  CaseEnd end;
  experiments::Result result;
  try {
    end.measurements = validation::validation_cases().at(job.index).run(job.fault);
  } catch (const std::bad_alloc&) { throw; } catch (const std::exception& e) {
    end.broken = e.what();
    result.status = experiments::Status::kFailed;
    result.reason = e.what();
  }
  end.wall_s = end.broken.empty() ? wall_seconds() - start : 0.0;
  result.cpu_s = cpu_seconds() - cpu_start;
  result.bytes = archived(end);
  return archived(result);
}

/// Runs of cases as tasks, the longest first.
class Cases : public experiments::Experiment {
 public:
  Cases(const std::vector<CaseRun>& runs, std::vector<std::optional<CaseEnd>>& ends)
      : runs_(runs), ends_(ends), order_(runs.size()) {
    ends_.resize(runs.size());
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    std::stable_sort(order_.begin(), order_.end(), [&](std::size_t i, std::size_t j) {
      return runs[i].one->about_s > runs[j].one->about_s;
    });
  }

  std::size_t size() const override { return order_.size(); }
  experiments::Task task(std::size_t i) override {
    return {"validate", key_of(i), run_of(i).one->name + (fault_of(i).empty() ? "" : ", " + fault_of(i)),
            run_job, kLimitS};
  }
  std::string input(std::size_t i) override {
    const auto index = run_of(i).one - validation::validation_cases().data();
    return archived(Job{static_cast<std::size_t>(index), fault_of(i)});
  }
  void take(std::size_t i, const experiments::Result& result) override {
    CaseEnd& end = ends_[order_[i]].emplace();
    if (result.bytes.empty())
      end.broken = result.reason;
    else
      end = restored<CaseEnd>(result.bytes);
  }
  std::string progress_text(std::size_t i) override { return run_of(i).one->name; }
  std::string key() override {
    std::string keys;
    for (std::size_t i = 0; i < size(); ++i) keys += key_of(i);
    return experiments::key_of({"validate", keys});
  }

 private:
  const CaseRun& run_of(std::size_t i) const { return runs_[order_[i]]; }
  std::string fault_of(std::size_t i) const { return run_of(i).fault ? run_of(i).fault->name : ""; }
  std::string key_of(std::size_t i) const {
    return experiments::key_of({"validate", run_of(i).one->name, fault_of(i)});
  }

  const std::vector<CaseRun>& runs_;
  std::vector<std::optional<CaseEnd>>& ends_;
  std::vector<std::size_t> order_;
};

}  // namespace

void CaseEnd::archive(Archive& a) {
  a("wall_s", wall_s);
  a("broken", broken);
  a.list("measurements", measurements, [&a](Measurement& m) {
    a("quantity", m.quantity);
    a("computed", m.computed);
    a("exact", m.exact);
    a("error", m.error);
    a("bar", m.bar);
    a("order", m.order);
    a("order_low", m.order_low);
    a("order_high", m.order_high);
    a("note", m.note);
    a("size_label", m.refinement.size_label);
    a("size", m.refinement.size);
    a("size_error", m.refinement.error);
    a("wall_s", m.refinement.wall_s);
  });
}

CaseEnds run_cases(const std::vector<CaseRun>& runs, const experiments::Place& place,
                   const experiments::EngineOptions& options) {
  CaseEnds out;
  Cases cases(runs, out.ends);
  out.outcome = experiments::run(cases, place, options);
  return out;
}

}  // namespace palpate::cli
