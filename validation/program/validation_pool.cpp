#include "validation_pool.h"

#include <algorithm>
#include <numeric>

#include "cli/stop.h"
#include "core/bytes.h"
#include "core/clock.h"
#include "core/process_pool.h"

namespace palpate::cli {
namespace {

using validation::Measurement;
using validation::ValidationCase;

constexpr double kLimitS = 7200.0;  // [s] of CPU time, after which a case counts as hanging.

std::string encode_job(const CaseRun& run) {
  ByteWriter out;
  out.put(run.one - validation::validation_cases().data());
  out.put(run.fault ? run.fault->name : std::string());
  return out.take();
}

/// A ProcessPool::Work: runs the case encoded by encode_job().
std::string run_job(const std::string& order, const std::atomic<bool>&) {
  ByteReader in(order);
  const ValidationCase& one =
      validation::validation_cases().at(static_cast<std::size_t>(in.get<std::ptrdiff_t>()));
  const auto fault = in.get<std::string>();
  const double start = wall_seconds();
  CaseEnd out{one.run(fault), 0.0, {}};
  out.wall_s = wall_seconds() - start;
  return bytes_of(out);
}

}  // namespace

std::string bytes_of(const CaseEnd& end) {
  ByteWriter out;
  out.put(end.wall_s).put(end.broken).put(end.measurements.size());
  for (const Measurement& m : end.measurements) {
    out.put(m.quantity).put(m.computed).put(m.exact).put(m.error).put(m.bar);
    out.put(m.order).put(m.order_low).put(m.order_high).put(m.note);
    out.put(m.refinement.size_label).put(m.refinement.size).put(m.refinement.error).put(m.refinement.wall_s);
  }
  return out.take();
}

CaseEnd case_end_of(const std::string& bytes) {
  ByteReader in(bytes);
  CaseEnd out;
  out.wall_s = in.get<double>();
  out.broken = in.get<std::string>();
  out.measurements.resize(in.get<std::size_t>());
  for (Measurement& m : out.measurements) {
    m.quantity = in.get<std::string>();
    for (double* value : {&m.computed, &m.exact, &m.error, &m.bar, &m.order, &m.order_low, &m.order_high})
      *value = in.get<double>();
    m.note = in.get<std::string>();
    m.refinement.size_label = in.get<std::string>();
    for (std::vector<double>* list : {&m.refinement.size, &m.refinement.error, &m.refinement.wall_s})
      *list = in.get<std::vector<double>>();
  }
  return out;
}

std::vector<std::optional<CaseEnd>> run_cases(
    const std::vector<CaseRun>& runs, int jobs,
    const std::function<void(double, const std::string&)>& progress) {
  std::vector<std::size_t> order(runs.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t i, std::size_t j) { return runs[i].one->about_s > runs[j].one->about_s; });
  std::vector<std::optional<CaseEnd>> out(runs.size());
  std::size_t next = 0, done = 0;
  ProcessPool pool(jobs);
  const auto start = [&](std::size_t index) {
    pool.start(run_job, encode_job(runs[index]), kLimitS, [&, index](const ProcessPool::Outcome& outcome) {
      out[index] = outcome.end == ProcessPool::Outcome::End::kDone ? case_end_of(outcome.bytes)
                                                                   : CaseEnd{{}, 0.0, outcome.bytes};
      progress(static_cast<double>(++done) / static_cast<double>(runs.size()), runs[index].one->name);
    });
  };
  while (!stop_flag()) {
    while (next < runs.size() && pool.has_room()) start(order[next++]);
    if (pool.idle()) break;
    pool.wait(0.2);
  }
  return out;
}

}  // namespace palpate::cli
