#include "codec.h"

#include <array>
#include <optional>

#include "core/bytes.h"

namespace palpate::compare {
namespace {

constexpr std::array<PointStatus, 7> kStatuses = {
    PointStatus::kOk,      PointStatus::kFailed,   PointStatus::kOutOfTime, PointStatus::kCrashed,
    PointStatus::kRefused, PointStatus::kNotTried, PointStatus::kMissing};

// One list of members per record serves writing, reading and naming.
template <class Error, class Visit>
void visit_error(Error& e, Visit visit) {
  visit("position_error_rel_l2", e.position_rel_l2);
  visit("position_error_max_m", e.position_max_m);
  visit("force_error_rms_n", e.force_rms_n);
  visit("force_error_max_n", e.force_max_n);
  visit("torque_error_rms_n_m", e.torque_rms_n_m);
  visit("torque_error_max_n_m", e.torque_max_n_m);
  visit("energy_error_j", e.energy_j);
}

// A RunResult contains, in addition to its numbers, a status, a flag (padded to a word), the members that
// put_result writes explicitly, and members that a comparison does not have: the real-time clock (runs are in
// virtual time), the energy at the device port, buzz, and the results of further hands.
static_assert(dynamics::bytes_of_counters<loop::RunResult>() + sizeof(dynamics::StepResult) + sizeof(double) +
                      sizeof(std::vector<long>) + sizeof(std::optional<loop::EnergyBalance>) +
                      sizeof(std::string) + sizeof(dynamics::StepperCounters::most_halvings) +
                      sizeof(std::optional<loop::RealTimeResult>) + sizeof(std::optional<loop::PortEnergy>) +
                      sizeof(std::optional<double>) + sizeof(std::vector<loop::HandResult>) ==
                  sizeof(loop::RunResult),
              "the codec leaves out a member of RunResult");

constexpr std::size_t energies() {
  std::size_t n = 0;
  const loop::EnergyBalance none;
  loop::visit_energies([&](const char*, double) { ++n; }, none);
  return n;
}
static_assert((energies() + 1) * sizeof(double) == sizeof(loop::EnergyBalance),
              "beside the energies that it visits a balance has its time, and nothing else");

template <class Record>
auto writing(ByteWriter& out, const Record&) {
  return [&out](const char*, const auto& value) { out.put(value); };
}
auto reading(ByteReader& in) {
  return [&in](const char*, auto& value) { value = in.get<std::remove_reference_t<decltype(value)>>(); };
}

void put_status(ByteWriter& out, const dynamics::StepResult& s) {
  out.put(s.status).put(s.t).put(s.h).put(s.order).put(s.iterations).put(s.residual).put(s.message);
}

dynamics::StepResult get_status(ByteReader& in) {
  dynamics::StepResult s;
  s.status = in.get<dynamics::StepStatus>();
  s.t = in.get<double>();
  s.h = in.get<double>();
  s.order = in.get<int>();
  s.iterations = in.get<int>();
  s.residual = in.get<double>();
  s.message = in.get<std::string>();
  return s;
}

void put_result(ByteWriter& out, const loop::RunResult& r) {
  put_status(out, r.status);
  out.put(r.stopped);
  loop::visit_counters(writing(out, r), r);
  out.put(r.counters.solver.ordering);
  out.put(r.counters.most_halvings);
  out.put(r.tunnelled.size());
  for (const long vertices : r.tunnelled) out.put(vertices);
  out.put(r.energy.has_value());
  if (!r.energy) return;
  out.put(r.energy->time);
  loop::visit_energies(writing(out, *r.energy), *r.energy);
}

loop::RunResult get_result(ByteReader& in) {
  loop::RunResult r;
  r.status = get_status(in);
  r.stopped = in.get<bool>();
  loop::visit_counters(reading(in), r);
  r.counters.solver.ordering = in.get<std::string>();
  r.counters.most_halvings = in.get<long>();
  r.tunnelled.resize(in.get<std::size_t>());
  for (long& vertices : r.tunnelled) vertices = in.get<long>();
  if (!in.get<bool>()) return r;
  r.energy.emplace().time = in.get<double>();
  loop::visit_energies(reading(in), *r.energy);
  return r;
}

void put_trajectory(ByteWriter& out, const Trajectory& t) {
  out.put(t.period_times).put(t.energies).put(t.tick_times).put(t.node_weights).put(t.start);
  out.put(t.bodies.size());
  for (const Trajectory::Body& body : t.bodies) out.put(body.first).put(body.size);
  out.put(t.positions.size());
  for (const VecX& x : t.positions) out.put(x);
  out.put(t.device.size());
  for (const Wrench& w : t.device)
    for (int i = 0; i < 3; ++i) out.put(w.force[i]).put(w.moment[i]);
}

Trajectory get_trajectory(ByteReader& in) {
  Trajectory t;
  t.period_times = in.get<std::vector<double>>();
  t.energies = in.get<std::vector<double>>();
  t.tick_times = in.get<std::vector<double>>();
  t.node_weights = in.get<VecX>();
  t.start = in.get<VecX>();
  t.bodies.resize(in.get<std::size_t>());
  for (Trajectory::Body& body : t.bodies) {
    body.first = in.get<Eigen::Index>();
    body.size = in.get<Eigen::Index>();
  }
  t.positions.resize(in.get<std::size_t>());
  for (VecX& x : t.positions) x = in.get<VecX>();
  t.device.resize(in.get<std::size_t>());
  for (Wrench& w : t.device)
    for (int i = 0; i < 3; ++i) {
      w.force[i] = in.get<double>();
      w.moment[i] = in.get<double>();
    }
  return t;
}

}  // namespace

const char* to_string(PointStatus status) {
  switch (status) {
    case PointStatus::kOk: return "ok";
    case PointStatus::kFailed: return "failed";
    case PointStatus::kOutOfTime: return "out of time";
    case PointStatus::kCrashed: return "crashed";
    case PointStatus::kRefused: return "refused";
    case PointStatus::kNotTried: return "not tried";
    case PointStatus::kMissing: return "missing";
  }
  return "unknown";
}

std::string bytes_of(const Run& run) {
  ByteWriter out;
  put_trajectory(out, run.trajectory);
  put_result(out, run.result);
  out.put(run.setup_s).put(run.record_s);
  return out.take();
}

Run run_of(const std::string& bytes) {
  ByteReader in(bytes);
  Run run;
  run.trajectory = get_trajectory(in);
  run.result = get_result(in);
  run.setup_s = in.get<double>();
  run.record_s = in.get<double>();
  return run;
}

std::string bytes_of(const Trajectory& trajectory) {
  ByteWriter out;
  put_trajectory(out, trajectory);
  return out.take();
}

Trajectory trajectory_of(const std::string& bytes) {
  ByteReader in(bytes);
  return get_trajectory(in);
}

std::string bytes_of(const PointRun& run) {
  ByteWriter out;
  out.put(run.reference).put(run.status).put(run.reason);
  visit_error(run.error, writing(out, run));
  out.put(run.setup_s).put(run.record_s);
  put_result(out, run.result);
  return out.take();
}

PointRun point_run_of(const std::string& bytes) {
  ByteReader in(bytes);
  PointRun run;
  run.reference = in.get<ReferenceUsed>();
  run.status = in.get<PointStatus>();
  run.reason = in.get<std::string>();
  visit_error(run.error, reading(in));
  run.setup_s = in.get<double>();
  run.record_s = in.get<double>();
  run.result = get_result(in);
  return run;
}

const std::vector<std::string>& run_columns() {
  static const std::vector<std::string> columns = [] {
    std::vector<std::string> out = {"limit_s", "reference_used", "setup_s", "record_s"};
    PointRun none;
    const auto name = [&](const char* column, const auto&) { out.push_back(column); };
    visit_error(none.error, name);
    loop::visit_counters(name, none.result);
    return out;
  }();
  return columns;
}

store::StudyRun row_of(const PointRun& run, double limit_s) {
  store::StudyRun row;
  row.status = to_string(run.status);
  row.reason = run.reason;
  row.numbers = {limit_s, static_cast<double>(run.reference), run.setup_s, run.record_s};
  const auto add = [&](const char*, const auto& value) { row.numbers.push_back(static_cast<double>(value)); };
  visit_error(run.error, add);
  loop::visit_counters(add, run.result);
  return row;
}

PointRun point_run_of(const store::StudyRun& row) {
  PointRun run;
  run.reason = row.reason;
  for (PointStatus one : kStatuses)
    if (row.status == to_string(one)) run.status = one;
  run.reference = static_cast<ReferenceUsed>(static_cast<int>(row.numbers[1]));
  run.setup_s = row.numbers[2];
  run.record_s = row.numbers[3];
  std::size_t i = 4;
  const auto take = [&](const char*, auto& value) {
    value = static_cast<std::remove_reference_t<decltype(value)>>(row.numbers[i++]);
  };
  visit_error(run.error, take);
  loop::visit_counters(take, run.result);
  return run;
}

double limit_of(const store::StudyRun& row) { return row.numbers[0]; }

std::string bytes_of(const ExchangeStudy& study) {
  ByteWriter out;
  out.put(study.made_by).put(study.checked_by).put(study.trouble);
  visit_error(study.own_error, writing(out, study));
  out.put(study.points.size());
  for (const ExchangePoint& p : study.points) {
    out.put(p.exchange_period_s).put(p.cpu_s).put(p.trouble);
    out.put(p.unresolved).put(p.force_unresolved).put(p.torque_unresolved);
    visit_error(p.error, writing(out, p));
  }
  return out.take();
}

ExchangeStudy exchange_of(const std::string& bytes) {
  ByteReader in(bytes);
  ExchangeStudy study;
  for (std::string* text : {&study.made_by, &study.checked_by, &study.trouble}) *text = in.get<std::string>();
  visit_error(study.own_error, reading(in));
  study.points.resize(in.get<std::size_t>());
  for (ExchangePoint& p : study.points) {
    p.exchange_period_s = in.get<double>();
    p.cpu_s = in.get<double>();
    p.trouble = in.get<std::string>();
    for (bool* flag : {&p.unresolved, &p.force_unresolved, &p.torque_unresolved}) *flag = in.get<bool>();
    visit_error(p.error, reading(in));
  }
  return study;
}

std::string bytes_of(const std::vector<MethodPoint>& points) {
  ByteWriter out;
  out.put(points.size());
  for (const MethodPoint& p : points) {
    out.put(p.method).put(p.peak_force_n).put(p.most_samples).put(p.query_s).put(p.cpu_s).put(p.trouble);
    visit_error(p.difference, writing(out, p));
  }
  return out.take();
}

std::vector<MethodPoint> methods_of(const std::string& bytes) {
  ByteReader in(bytes);
  std::vector<MethodPoint> points(in.get<std::size_t>());
  for (MethodPoint& p : points) {
    p.method = in.get<std::string>();
    p.peak_force_n = in.get<double>();
    p.most_samples = in.get<long>();
    p.query_s = in.get<double>();
    p.cpu_s = in.get<double>();
    p.trouble = in.get<std::string>();
    visit_error(p.difference, reading(in));
  }
  return points;
}

}  // namespace palpate::compare
