#include "experiments/study/figures.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/clock.h"
#include "experiments/median.h"
#include "loop/run_figures.h"
#include "palpate/core/error.h"
#include "palpate/loop/run.h"
#include "store/content_hash.h"

namespace palpate::study {
namespace {

using experiments::Status;
using Times = std::vector<std::pair<std::string, std::vector<double>>>;

/// Returns a number such that it reads back exactly, and "nan" where it is not finite.
template <class Number>
std::string text_of(Number value) {
  if constexpr (std::is_floating_point_v<Number>)
    if (!std::isfinite(value)) return "nan";
  return fmt::format("{}", value);
}

/// Collects a study's figures of a run: the largest force and torque on any hand, the largest displacement of
/// a node, and the final state.
class FigureObserver : public loop::Observer {
 public:
  explicit FigureObserver(bool energy) : energy_(energy) {}

  void period(loop::World& world, double /*t*/) override {
    const VecX now = world.state.q().head(world.state.layout().nodal_size);
    if (start_.size() != now.size()) start_ = now;
    for (Eigen::Index i = 0; i + 3 <= now.size(); i += 3) {
      const double moved = (now.segment<3>(i) - start_.segment<3>(i)).norm();
      // NaN is taken, and stays: it compares as false with all later values.
      if (moved > largest_displacement_m || std::isnan(moved)) largest_displacement_m = moved;
    }
  }
  void tick_of(std::size_t hand, const loop::TickRecord& tick) override {
    of_hands.tick_of(hand, tick);
    tools_[hand] = tick.tool;
  }
  bool wants_energy() const override { return energy_; }

  /// Returns a hash of the final state of bodies and tools: equal for bitwise equal states.
  std::string end_state(const loop::World& world) const {
    store::ContentHash hash;
    add(hash, world.state.q());
    add(hash, world.state.u());
    for (const auto& [hand, pose] : tools_) {
      add(hash, pose.translation);
      add(hash, pose.rotation.coeffs());
    }
    return hash.hex();
  }

  loop::RunFigures of_hands;
  double largest_displacement_m = 0.0;

 private:
  template <class Vector>
  static void add(store::ContentHash& hash, const Vector& values) {
    const VecX v = values;
    hash.add({reinterpret_cast<const char*>(v.data()), static_cast<std::size_t>(v.size()) * sizeof(double)});
  }
  bool energy_;
  VecX start_;
  std::map<std::size_t, Pose> tools_;
};

Columns figures_of(const loop::World& world, const loop::RunResult& result, const FigureObserver& seen) {
  Columns out;
  const auto put = [&out](const char* name, auto value) { out.emplace_back(name, text_of(value)); };
  put("simulated_s", result.time);
  long long nodes = 0, tets = 0;
  for (const loop::Body& body : world.bodies) nodes += body.rest.nodes.cols(), tets += body.rest.tets.cols();
  put("nodes", nodes);
  put("tetrahedra", tets);
  if (!seen.of_hands.peaks().empty()) {
    const loop::PeakWrench peak = seen.of_hands.largest();
    put("peak_force_n", peak.force_n);
    put("peak_force_at_s", peak.force_at_s);
    put("peak_torque_n_m", peak.torque_n_m);
  }
  if (!world.bodies.empty()) put("largest_displacement_m", seen.largest_displacement_m);
  if (result.buzz_n) put("buzz_above_30_hz_rms_n", *result.buzz_n);
  if (!result.tunnelled.empty()) {
    long long through = 0;
    for (const long n : result.tunnelled) through += n;
    put("vertices_gone_through", through);
  }
  if (result.energy) loop::visit_energies(put, *result.energy);
  const auto add = [&put]<class T>(const char* name, const T& value) {
    if constexpr (std::is_integral_v<T>) put(name, value);
  };
  loop::visit_counters(add, result);
  out.emplace_back("end_state", seen.end_state(world));
  return out;
}

void add_times(Times& times, const loop::RunResult& result, double assemble_s) {
  const auto put = [&times](const char* name, double value) {
    const auto at = std::find_if(times.begin(), times.end(), [&](const auto& t) { return t.first == name; });
    (at == times.end() ? times.emplace_back(name, std::vector<double>{}) : *at).second.push_back(value);
  };
  put("assemble_s", assemble_s);
  const auto add = [&put]<class T>(const char* name, const T& value) {
    if constexpr (std::is_floating_point_v<T>)
      if (std::string_view(name) != "simulated_s") put(name, value);
  };
  loop::visit_counters(add, result);
}

/// Runs the scene once, and adds its times to `times`.
SceneRun run_once(const scene::Description& d, const std::atomic<bool>& out_of_time, Times& times) {
  const double start = wall_seconds();
  const auto world = loop::assemble(d);
  const double assemble_s = wall_seconds() - start;
  FigureObserver seen(d.record && d.record->energy);
  loop::RunOptions options;
  options.observers = {&seen};
  options.stop = &out_of_time;
  const loop::RunResult result = loop::run(*world, options);
  SceneRun out;
  if (result.stopped) {  // The point where time ran out is not a property of the scene.
    out.status = Status::kOutOfTime;
    return out;
  }
  add_times(times, result, assemble_s);
  out.figures = figures_of(*world, result, seen);
  const dynamics::StepResult& last = result.status;
  if (!last.ok()) {
    out.status = last.status == dynamics::StepStatus::kBadSettings ? Status::kRefused : Status::kFailed;
    out.reason = fmt::format("{} at t = {:g} s: {}", dynamics::to_string(last.status), last.t, last.message);
  } else if (!world->state.q().allFinite() || !world->state.u().allFinite()) {
    out.status = Status::kFailed;
    out.reason = "not finite: the run reached its end without a usable state";
  }
  return out;
}

}  // namespace

void SceneRun::archive(Archive& a) {
  const auto column = [&a](auto& one) {
    a("name", one.first);
    a("value", one.second);
  };
  a.list("figures", figures, column);
  a.list("times", times, column);
}

SceneRun run_scene(const scene::Description& d, int repeats, const std::atomic<bool>& out_of_time) {
  SceneRun out;
  Times times;
  try {
    for (int i = 0; i < repeats && out.status == Status::kOk; ++i) {
      SceneRun one = run_once(d, out_of_time, times);
      if (i > 0 && one.status == Status::kOk && one.figures != out.figures) {
        one.status = Status::kFailed;
        one.reason = "not reproducible: two runs of this scene differ";
      }
      out = std::move(one);
    }
  } catch (const Error& refusal) {
    out = {};
    out.status = Status::kRefused;
    out.reason = refusal.what();
  }
  for (const auto& [name, values] : times) out.times.emplace_back(name, text_of(experiments::median(values)));
  out.times.emplace_back("peak_memory_mib", text_of(peak_memory_mib()));
  return out;
}

}  // namespace palpate::study
