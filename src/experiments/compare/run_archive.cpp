#include "experiments/compare/run_archive.h"

#include <optional>

#include "palpate/experiments/comparison.h"

namespace palpate::compare {
namespace {

// A RunResult contains, in addition to its numbers, a status, a flag (padded to a word), the members that
// archive_result() lists, and members that a comparison does not have: the real-time clock (runs are in
// virtual time), the energy at the device port, buzz, ticks without a pose, and the results of further hands.
static_assert(dynamics::bytes_of_counters<loop::RunResult>() + sizeof(dynamics::StepResult) + sizeof(double) +
                      sizeof(std::vector<long>) + sizeof(std::optional<loop::EnergyBalance>) +
                      sizeof(std::string) + sizeof(dynamics::StepperCounters::most_halvings) +
                      sizeof(std::optional<loop::RealTimeResult>) + sizeof(std::optional<loop::PortEnergy>) +
                      sizeof(std::optional<double>) + sizeof(loop::RunResult::ticks_without_pose) +
                      sizeof(std::vector<loop::HandResult>) ==
                  sizeof(loop::RunResult),
              "archive_result() leaves out a member of RunResult");

constexpr std::size_t energies() {
  std::size_t n = 0;
  const loop::EnergyBalance none;
  loop::visit_energies([&](const char*, double) { ++n; }, none);
  return n;
}
static_assert((energies() + 1) * sizeof(double) == sizeof(loop::EnergyBalance),
              "beside the energies that it visits a balance has its time, and nothing else");

void archive_status(Archive& a, dynamics::StepResult& s) {
  const Archive::Group group(a, "status");
  a("status", s.status);
  a("t", s.t);
  a("h", s.h);
  a("order", s.order);
  a("iterations", s.iterations);
  a("residual", s.residual);
  a("message", s.message);
}

/// Archives a list of vectors of one size as a matrix.
void archive_columns(Archive& a, const char* name, std::vector<VecX>& list) {
  MatX all(list.empty() ? 0 : list.front().size(), static_cast<Eigen::Index>(list.size()));
  for (std::size_t i = 0; i < list.size(); ++i) all.col(static_cast<Eigen::Index>(i)) = list[i];
  a(name, all);
  if (!a.is_restoring()) return;
  for (Eigen::Index i = 0; i < all.cols(); ++i) list.emplace_back(all.col(i));
}

}  // namespace

void archive_result(Archive& a, loop::RunResult& r) {
  const Archive::Group group(a, "result");
  archive_status(a, r.status);
  a("stopped", r.stopped);
  const auto one = [&a](const char* name, auto& value) { a(name, value); };
  loop::visit_counters(one, r);
  a("ordering", r.counters.solver.ordering);
  a("most_halvings", r.counters.most_halvings);
  a.list("tunnelled", r.tunnelled, [&a](long& vertices) { a("vertices", vertices); });
  bool with_energy = r.energy.has_value();
  a("with_energy", with_energy);
  if (!with_energy) return;
  if (!r.energy) r.energy.emplace();
  a("energy_time", r.energy->time);
  loop::visit_energies(one, *r.energy);
}

void TrajectoryError::archive(Archive& a) {
  a("position_rel_l2", position_rel_l2);
  a("position_max_m", position_max_m);
  a("force_rms_n", force_rms_n);
  a("force_max_n", force_max_n);
  a("torque_rms_n_m", torque_rms_n_m);
  a("torque_max_n_m", torque_max_n_m);
  a("energy_j", energy_j);
}

void Trajectory::archive(Archive& a) {
  a("period_times", period_times);
  a("energies", energies);
  a("tick_times", tick_times);
  a("node_weights", node_weights);
  a("start", start);
  a.list("bodies", bodies, [&a](Body& body) {
    a("first", body.first);
    a("size", body.size);
  });
  archive_columns(a, "positions", positions);
  std::size_t ticks = device.size();
  a("ticks", ticks);
  device.resize(ticks);
  a.rows("device", device, [](auto&& f, Wrench& wrench) { f(wrench); });
}

void Run::archive(Archive& a) {
  a("trajectory", trajectory);
  archive_result(a, result);
  a("setup_s", setup_s);
  a("record_s", record_s);
}

void ExchangePoint::archive(Archive& a) {
  a("exchange_period_s", exchange_period_s);
  a("cpu_s", cpu_s);
  a("trouble", trouble);
  a("unresolved", unresolved);
  a("force_unresolved", force_unresolved);
  a("torque_unresolved", torque_unresolved);
  a("error", error);
}

void ExchangeStudy::archive(Archive& a) {
  a("made_by", made_by);
  a("checked_by", checked_by);
  a("trouble", trouble);
  a("own_error", own_error);
  a.list("points", points, [&a](ExchangePoint& point) { point.archive(a); });
}

void MethodPoint::archive(Archive& a) {
  a("method", method);
  a("peak_force_n", peak_force_n);
  a("most_samples", most_samples);
  a("query_s", query_s);
  a("cpu_s", cpu_s);
  a("trouble", trouble);
  a("difference", difference);
}

}  // namespace palpate::compare
