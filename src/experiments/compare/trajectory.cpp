#include "palpate/experiments/trajectory.h"

#include <cmath>
#include <limits>

#include "core/clock.h"
#include "core/rigid_fit.h"
#include "palpate/core/error.h"

namespace palpate::compare {
namespace {

/// Adds the CPU time of its lifetime to a sum [s].
class Spent {
 public:
  explicit Spent(double& sum) : sum_(sum), start_(thread_cpu_seconds()) {}
  ~Spent() { sum_ += thread_cpu_seconds() - start_; }
  Spent(const Spent&) = delete;
  Spent& operator=(const Spent&) = delete;

 private:
  double& sum_;
  double start_;
};

VecX nodal_positions(const loop::World& world) {
  return world.state.q().head(world.state.layout().nodal_size);
}

/// Returns the nodes of all bodies; for a scene without bodies, the tool's origin.
VecX positions_of(const loop::World& world, const Vec3& tool_origin) {
  if (world.bodies.empty() && world.description.tool) return tool_origin;
  return nodal_positions(world);
}

/// Returns the mean spacing of ascending times; for a single time its absolute value.
double spacing(const std::vector<double>& times) {
  if (times.size() < 2) return times.empty() ? 0.0 : std::abs(times[0]);
  return (times.back() - times.front()) / static_cast<double>(times.size() - 1);
}

/// Returns the larger of two numbers; NaN is kept, where std::max would drop it.
double worse(double a, double b) { return b > a || std::isnan(b) ? b : a; }

/// Tolerance of equal times, relative to the shorter spacing.  Times are multiples of the two runs' periods:
/// this is far above their rounding and far below any ratio of periods.
constexpr double kSameTime = 1e-6;

/// Calls visit(i, j) for every pair of equal times of two ascending lists; returns the number of pairs.
template <class Visit>
int for_common_times(const std::vector<double>& a, const std::vector<double>& b, Visit visit) {
  std::size_t i = 0, j = 0;
  int common = 0;
  const double alike = kSameTime * std::min(spacing(a), spacing(b));
  while (i < a.size() && j < b.size()) {
    if (std::abs(a[i] - b[j]) <= alike) {
      visit(i++, j++);
      ++common;
    } else if (a[i] < b[j]) {
      ++i;
    } else {
      ++j;
    }
  }
  return common;
}

/// Returns the mass-weighted sum of squares of a state's displacement after removal of each body's rigid
/// motion.
double deformation2(const Trajectory& t, const VecX& x) {
  double sum = 0.0;
  for (const Trajectory::Body& body : t.bodies) {
    const auto points = [&](const VecX& all) {
      return Points(Eigen::Map<const Points>(all.data() + body.first, 3, body.size / 3));
    };
    const VecX mass =
        Eigen::Map<const VecX, 0, Eigen::InnerStride<3>>(t.node_weights.data() + body.first, body.size / 3);
    const Points before = points(t.start), after = points(x);
    const Pose rigid = rigid_fit(before, after, mass);
    const Points left = after - ((rigid.rotation.toRotationMatrix() * before).colwise() + rigid.translation);
    sum += left.colwise().squaredNorm().dot(mass);
  }
  return sum;
}

/// A deformation below this share of the displacement is rounding.
constexpr double kLeastDeformation = 1e-9;

/// Adds force and torque errors; returns the number of common ticks.  Without any, the errors are unchanged.
int add_wrench_distance(const Trajectory& computed, const Trajectory& reference, TrajectoryError& error) {
  double force2 = 0.0, torque2 = 0.0, force_max = 0.0, torque_max = 0.0;
  const int ticks =
      for_common_times(computed.tick_times, reference.tick_times, [&](std::size_t i, std::size_t j) {
        const double force = (computed.device[i].force - reference.device[j].force).norm();
        const double torque = (computed.device[i].moment - reference.device[j].moment).norm();
        force2 += force * force;
        torque2 += torque * torque;
        force_max = worse(force_max, force);
        torque_max = worse(torque_max, torque);
      });
  if (ticks == 0) return 0;
  error.force_rms_n = std::sqrt(force2 / ticks);
  error.torque_rms_n_m = std::sqrt(torque2 / ticks);
  error.force_max_n = force_max;
  error.torque_max_n_m = torque_max;
  return ticks;
}

}  // namespace

void TrajectoryRecorder::period(loop::World& world, double t) {
  const Spent spent(cpu_s_);
  if (trajectory_.period_times.empty()) {
    if (world.description.tool) tool_origin_ = world.description.tool->position_m;
    trajectory_.start = positions_of(world, tool_origin_);
    trajectory_.node_weights.setOnes(trajectory_.start.size());
    for (const loop::Body& body : world.bodies) {
      const int first = world.state.layout().find(body.block_id)->u_offset;
      for (Eigen::Index i = 0; i < body.masses.size(); ++i)
        trajectory_.node_weights.segment<3>(first + 3 * i).setConstant(body.masses[i]);
      trajectory_.bodies.push_back({first, 3 * body.masses.size()});
    }
  }
  trajectory_.period_times.push_back(t);
  trajectory_.positions.push_back(positions_of(world, tool_origin_));
  trajectory_.energies.push_back(world.bodies.empty() ? 0.0 : world.mechanical_energy());
}

void TrajectoryRecorder::tick(const loop::TickRecord& tick) {
  const Spent spent(cpu_s_);
  trajectory_.tick_times.push_back(tick.time);
  trajectory_.device.push_back(tick.device);
  tool_origin_ = tick.tool.translation;
}

void WrenchRecorder::tick(const loop::TickRecord& tick) {
  const Spent spent(cpu_s_);
  trajectory_.tick_times.push_back(tick.time);
  trajectory_.device.push_back(tick.device);
}

TrajectoryError distance(const Trajectory& computed, const Trajectory& reference) {
  TrajectoryError error;
  double difference = 0.0, displacement = 0.0, deformation = 0.0;
  const int common =
      for_common_times(computed.period_times, reference.period_times, [&](std::size_t i, std::size_t j) {
        const VecX& x = computed.positions[i];
        const VecX& y = reference.positions[j];
        PALPATE_CHECK(x.size() == y.size(), "trajectories of {} and {} coordinates", x.size(), y.size());
        if (x.size() > 0) {
          difference += reference.node_weights.dot((x - y).cwiseAbs2());
          displacement += reference.node_weights.dot((y - reference.start).cwiseAbs2());
          deformation += deformation2(reference, y);
          for (Eigen::Index n = 0; n < x.size(); n += 3)
            error.position_max_m = worse(error.position_max_m, (x.segment<3>(n) - y.segment<3>(n)).norm());
        }
        error.energy_j = worse(error.energy_j, std::abs(computed.energies[i] - reference.energies[j]));
      });
  PALPATE_CHECK(common > 0, "two trajectories without a common time");
  const double size =
      deformation > kLeastDeformation * kLeastDeformation * displacement ? deformation : displacement;
  error.position_rel_l2 = size > 0.0 ? std::sqrt(difference / size) : std::sqrt(difference);
  add_wrench_distance(computed, reference, error);
  return error;
}

TrajectoryError wrench_distance(const Trajectory& computed, const Trajectory& reference) {
  TrajectoryError error = no_distance();
  if (add_wrench_distance(computed, reference, error) == 0)
    fail("two runs of {} and {} ticks have no tick in common", computed.tick_times.size(),
         reference.tick_times.size());
  return error;
}

TrajectoryError no_distance() {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  return {none, none, none, none, none, none, none};
}

namespace {

/// Assembles and runs a description.  @tparam Recorder  observer with a trajectory()
template <class Recorder>
Run run_with(const scene::Description& description, double duration_s, const std::atomic<bool>* stop,
             const std::function<void(loop::World&)>& seed_defect = {}) {
  Run run;
  const double start = thread_cpu_seconds();
  const auto world = loop::assemble(description);
  run.setup_s = thread_cpu_seconds() - start;
  if (seed_defect) seed_defect(*world);
  Recorder recorder;
  loop::RunOptions options;
  options.duration_s = duration_s;
  options.observers = {&recorder};
  options.stop = stop;
  run.result = loop::run(*world, options);
  run.trajectory = recorder.trajectory();
  run.record_s = recorder.cpu_s();
  run.result.cpu_s -= run.record_s;
  return run;
}

}  // namespace

Run run_once(const scene::Description& description, double duration_s, const std::atomic<bool>* stop,
             const std::function<void(loop::World&)>& seed_defect) {
  return run_with<TrajectoryRecorder>(description, duration_s, stop, seed_defect);
}

Run run_for_wrenches(const scene::Description& description, double duration_s,
                     const std::atomic<bool>* stop) {
  return run_with<WrenchRecorder>(description, duration_s, stop);
}

}  // namespace palpate::compare
