#include "palpate/device/passivity.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/device/profile.h"

// Why the observer's sum is a test of passivity.  Let the loop be a wall, F = -K x - B (x_k - x_{k-1})/T,
// with D_k = x_k - x_{k-1}.  Then (src/stability/haptic_theory.cpp)
//     sum -F_{k-1} D_k + b D_k^2/T  >=  K/2 (x_N^2 - x_0^2) + (b/T - K/2 - |B|/T) sum D_k^2,
// which is not negative for x_0 = 0 and b > K T/2 + |B|.  A triangle wave of period 2T and amplitude A
// attains the bound: a cycle changes the sum by (8 A^2/T)(b - K T/2 - B).

namespace palpate::device {

void PassivityObserver::sample(double t, const Pose& handle) {
  dt_ = started_ ? t - time_ : 0.0;
  change_ = started_ ? pose_difference(last_, handle) : Vec6(Vec6::Zero());
  const double in = -held_.force.dot(change_.tail<3>()) - held_.moment.dot(change_.head<3>());
  energy_ += in;
  if (dt_ > 0.0) energy_ += friction(change_);
  work_ += std::abs(in);
  least_ = std::min(least_, energy_);
  last_ = handle;
  time_ = t;
  started_ = true;
}

// Positions that are read in steps r are off by r/2 at most, their difference over a tick by r.
double PassivityObserver::friction(const Vec6& change) const {
  return damping_ * (change.tail<3>().array().abs() - resolution_).cwiseMax(0.0).square().sum() / dt_;
}

void PassivityObserver::archive(Archive& a) {
  a("energy", energy_);
  a("least", least_);
  a("work", work_);
  a("time", time_);
  a("tick", dt_);
  a("started", started_);
  a("last", last_);
  a("change", change_);
  a("held", held_);
}

void PassivityController::archive(Archive& a) {
  a("dissipated", dissipated_);
  a("active", active_);
  a("observer", observer_);
  a("damper", damper_);
}

PassivityController::Mode PassivityController::mode_of(const std::string& name) {
  if (name == "off") return Mode::kOff;
  if (name == "observe") return Mode::kObserve;
  if (name == "control") return Mode::kControl;
  fail("passivity: unknown mode \"{}\"{}", name, suggestion(name, {"off", "observe", "control"}));
}

PassivityController::PassivityController(Mode mode, double max_force_n, double max_torque_n_m,
                                         PassivityObserver observer)
    : mode_(mode), max_force_(max_force_n), max_torque_(max_torque_n_m), observer_(std::move(observer)) {}

Wrench PassivityController::apply(double t, const Pose& handle, const Wrench& limited, bool valid) {
  if (mode_ == Mode::kOff) return limited;
  const Vec6 before = observer_.last_change();
  observer_.sample(t, handle);
  const Vec6 D = observer_.last_change();
  dissipated_ -= damper_.force.dot(D.tail<3>()) + damper_.moment.dot(D.head<3>());
  damper_ = {};
  Wrench out = limited;
  if (mode_ == Mode::kControl && valid && observer_.last_tick() > 0.0) {
    double least = foreseen(limited, D);
    for (const double sign : {-1.0, 1.0}) least = std::min(least, foreseen(limited, D + sign * (D - before)));
    if (least < 0.0) damp(limited, D, -least);
    out += damper_;
  }
  observer_.hold(out);
  return out;
}

double PassivityController::foreseen(const Wrench& wrench, const Vec6& D) const {
  return observer_.energy() - wrench.force.dot(D.tail<3>()) - wrench.moment.dot(D.head<3>()) +
         observer_.friction(D);
}

void PassivityController::damp(const Wrench& limited, const Vec6& D, double missing) {
  // translation and rotation share it as they share the work that the wrench would do
  const double along = std::max(0.0, limited.force.dot(D.tail<3>())),
               about = std::max(0.0, limited.moment.dot(D.head<3>()));
  const double share = along + about > 0.0 ? along / (along + about) : 1.0;
  const auto against = [](const Vec3& d, double energy) {
    return d.squaredNorm() > 0.0 ? Vec3(-d * (energy / d.squaredNorm())) : Vec3(Vec3::Zero());
  };
  const auto cut = [](const Vec3& damper, const Vec3& wrench, double max) {
    const Vec3 sum = wrench + damper;
    return sum.norm() > max ? Vec3(sum * (max / sum.norm()) - wrench) : damper;
  };
  damper_.force = cut(against(D.tail<3>(), missing * share), limited.force, max_force_);
  damper_.moment = cut(against(D.head<3>(), missing * (1.0 - share)), limited.moment, max_torque_);
  ++active_;
}

std::unique_ptr<PassivityController> make_passivity_controller(PassivityController::Mode mode,
                                                               const DeviceSpec& device) {
  if (mode == PassivityController::Mode::kOff) return nullptr;
  const DeviceFigures figures = figures_of(device);
  return std::make_unique<PassivityController>(
      mode, figures.max_force, figures.max_torque,
      PassivityObserver(figures.damping, figures.encoder_resolution));
}

}  // namespace palpate::device
