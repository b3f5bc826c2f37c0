#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/so3.h"
#include "device/check_range.h"
#include "device/hand_model.h"
#include "device/make.h"
#include "device/motions.h"
#include "palpate/core/error.h"
#include "palpate/device/motors.h"
#include "palpate/device/profile.h"

// A simulated device in the hand of a simulated arm. The scene's path is the target motion x_d(t) of the arm
// (the equilibrium point of Hogan 1985); a spring k and a damper b pull arm and device towards it. The grip
// is rigid, so m is the mass of both. Along each axis of the scene
//     m x'' = k (x_d - x) + b (x_d' - x') - c x' - f sgn(x') + F,
// with c and f the device's viscous and Coulomb friction and F the force of its motors. Between two ticks F
// is held (zero-order hold), k x_d + b x_d' is approximated linearly, and the integration is exact otherwise
// (ArmAxis).
//
// The motors hold the wrench that the loop sends, delayed, rounded and limited (Motors). The loop receives
// the pose rounded to the encoders' resolution, and a velocity computed from it: the backward difference
// through a first-order low pass, v_f += (1 - exp(-2 pi f_c h)) (difference - v_f); with f_c = 0, the exact
// velocity. A hand without friction that pushes a wall of stiffness K with a tick T gains energy from the
// hold if K T/2 > c + b (Colgate and Schenkel 1994): a loop that is stable with this device has passed that
// test.
//
// Rotations obey the same law for the rotation vector theta from the first orientation, with the torque
// J(theta)^T tau: exact about one axis, and with an error of O(theta^2) about several. The model is valid
// below one whole turn, as is the rotation vector.
//
// Defaults of the arm: 0.8 kg, 5.5 N s/m, 568 N/m, which Hulin et al. (2008) quote from Hogan (1989). The
// defaults of the wrist have the right order of magnitude, but are not measured.
namespace palpate::device {
namespace {

/// Returns the rotation vector of q nearest to `near`; rotation vectors are unique up to whole turns.
Vec3 unwrapped(const Quat& q, const Vec3& near) {
  const Vec3 theta = rotation_vector(q);
  const double angle = theta.norm();
  if (angle == 0.0) return theta;
  const Vec3 turn = theta * (2.0 * std::numbers::pi / angle);
  return theta + std::round((near - theta).dot(turn) / turn.squaredNorm()) * turn;
}

/// Encoder of a coordinate: rounded values, and their filtered rate.
class Encoder {
 public:
  Encoder(double step, double cutoff) : step_(step), cutoff_(cutoff) {}
  void start(const Vec3& x) { value_ = to_step(x, step_), rate_ = Vec3::Zero(); }
  void read(const Vec3& x, const Vec3& exact_rate, double h) {
    const Vec3 now = to_step(x, step_);
    const double share = -std::expm1(-2.0 * std::numbers::pi * cutoff_ * h);
    rate_ = cutoff_ > 0.0 ? Vec3(rate_ + share * ((now - value_) / h - rate_)) : exact_rate;
    value_ = now;
  }
  const Vec3& value() const { return value_; }
  const Vec3& rate() const { return rate_; }
  void archive(Archive& a) {
    a("value", value_);
    a("rate", rate_);
  }

 private:
  double step_, cutoff_;
  Vec3 value_ = Vec3::Zero(), rate_ = Vec3::Zero();
};

/// Three axes with equal parameters, pulled by the arm towards the target.
class Axes {
 public:
  Axes(const ArmAxis::Parameters& p, double arm_damping)
      : k_(p.stiffness), b_(arm_damping), axes_{ArmAxis(p), ArmAxis(p), ArmAxis(p)} {}
  void place(const Vec3& x) {
    for (int i = 0; i < 3; ++i) axes_[i].place(x[i], 0.0);
  }
  /// Returns the pull of the arm without its part -k x - b x'.
  Vec3 pull(const Vec3& requested, const Vec3& wanted_rate) const {
    return k_ * requested + b_ * wanted_rate;
  }
  void advance(double h, const Vec3& p0, const Vec3& p1) {
    for (int i = 0; i < 3; ++i) axes_[i].advance(h, p0[i], p1[i]);
  }
  Vec3 x() const { return {axes_[0].x(), axes_[1].x(), axes_[2].x()}; }
  Vec3 v() const { return {axes_[0].v(), axes_[1].v(), axes_[2].v()}; }
  void archive(Archive& a) {
    a.each("axis", axes_, [&](ArmAxis& axis) { axis.archive(a); });
  }

 private:
  double k_, b_;
  ArmAxis axes_[3];
};

ArmAxis::Parameters translation_of(const DeviceSpec& s, const DeviceFigures& figures) {
  check_range("arm_mass_kg", s.arm_mass_kg, DeviceRanges::arm);
  check_range("arm_damping_n_s_m", s.arm_damping_n_s_m, DeviceRanges::arm);
  check_range("arm_stiffness_n_m", s.arm_stiffness_n_m, DeviceRanges::arm);
  return {s.arm_mass_kg + figures.mass, s.arm_damping_n_s_m + figures.damping, s.arm_stiffness_n_m,
          figures.friction};
}

ArmAxis::Parameters rotation_of(const DeviceSpec& s) {
  check_range("rotational_inertia_kg_m2", s.rotational_inertia_kg_m2, DeviceRanges::inertia);
  check_range("arm_rotational_damping_n_m_s_rad", s.arm_rotational_damping_n_m_s_rad, DeviceRanges::arm);
  check_range("arm_rotational_stiffness_n_m_rad", s.arm_rotational_stiffness_n_m_rad, DeviceRanges::arm);
  check_range("rotational_friction_n_m", s.rotational_friction_n_m, DeviceRanges::arm);
  return {s.rotational_inertia_kg_m2, s.arm_rotational_damping_n_m_s_rad, s.arm_rotational_stiffness_n_m_rad,
          s.rotational_friction_n_m};
}

class HandDevice : public Device {
 public:
  explicit HandDevice(const DeviceSpec& spec) : HandDevice(spec, hand_model(spec)) {}
  HandDevice(const DeviceSpec& spec, const HandModel& model)
      : requested_(model.requested),
        figures_(figures_of(spec)),
        motors_(motor_figures(spec)),
        translation_(model.translation, model.arm_damping),
        rotation_(model.rotation, model.arm_rotational_damping),
        position_(figures_.encoder_resolution, spec.velocity_cutoff_per_s),
        angle_(spec.encoder_resolution_rad, spec.velocity_cutoff_per_s) {
    check_range("encoder_resolution_rad", spec.encoder_resolution_rad, DeviceRanges::resolution);
    check_range("velocity_cutoff_per_s", spec.velocity_cutoff_per_s, DeviceRanges::resolution);
  }
  DeviceSpecification specification() const override { return figures_.specification; }
  bool can_be_archived() const override { return true; }

 protected:
  void do_archive(Archive& a) override {
    a("translation", translation_);
    a("rotation", rotation_);
    a("position", position_);
    a("angle", angle_);
    a("first", first_);
    a("theta", theta_);
    a("pull", pull_);
    a("arm_torque", twist_);
    a("motors", motors_);
    a("switches", switches_);
    a("tick", time_);
    a("started", started_);
  }
  HandleSample do_sample(double t) override {
    if (!started_)
      start(t);
    else if (t > time_)
      advance(t);
    HandleSample out;
    out.pose = {quaternion_of(angle_.value()) * first_, position_.value()};
    out.twist = {left_jacobian(angle_.value()) * angle_.rate(), position_.rate()};
    out.switches = switches_;
    return out;
  }
  void do_feedback(double t, const Wrench& on_hand) override { motors_.send(t, on_hand); }

 private:
  void start(double t) {
    started_ = true;
    time_ = t;
    motors_.advance(t);
    const HandleSample requested = requested_(t);
    switches_ = requested.switches;
    first_ = requested.pose.rotation;
    translation_.place(requested.pose.translation);
    rotation_.place(Vec3::Zero());
    position_.start(requested.pose.translation);
    angle_.start(Vec3::Zero());
    pull_ = translation_.pull(requested.pose.translation, requested.twist.linear);
  }

  void advance(double t) {
    const double h = t - time_;
    const HandleSample requested = requested_(t);
    switches_ = requested.switches;
    const Vec3 theta = unwrapped(requested.pose.rotation * first_.conjugate(), theta_),
               pull = translation_.pull(requested.pose.translation, requested.twist.linear),
               twist = rotation_.pull(theta, (theta - theta_) / h);
    motors_.advance(t, [&](const Motors::Span& span) {
      const double length = span.to - span.from, s0 = (span.from - time_) / h, s1 = (span.to - time_) / h;
      const Vec3 torque = left_jacobian(rotation_.x()).transpose() * span.wrench.moment;
      translation_.advance(length, pull_ + s0 * (pull - pull_) + span.wrench.force,
                           pull_ + s1 * (pull - pull_) + span.wrench.force);
      rotation_.advance(length, twist_ + s0 * (twist - twist_) + torque,
                        twist_ + s1 * (twist - twist_) + torque);
    });
    pull_ = pull, twist_ = twist, theta_ = theta;
    time_ = t;
    position_.read(translation_.x(), translation_.v(), h);
    angle_.read(rotation_.x(), rotation_.v(), h);
  }

  DevicePath requested_;
  DeviceFigures figures_;
  Motors motors_;
  Axes translation_, rotation_;
  Encoder position_, angle_;
  Quat first_ = Quat::Identity();                    ///< Orientation at the start, the origin of theta.
  Vec3 theta_ = Vec3::Zero();                        ///< Target of theta at the last tick.
  Vec3 pull_ = Vec3::Zero(), twist_ = Vec3::Zero();  ///< Force and torque of the arm at the last tick.
  std::uint32_t switches_ = 0;                       ///< At time_; independent of the forces.
  double time_ = 0.0;
  bool started_ = false;
};

}  // namespace

HandModel hand_model(const DeviceSpec& spec) {
  return {translation_of(spec, figures_of(spec)), rotation_of(spec), spec.arm_damping_n_s_m,
          spec.arm_rotational_damping_n_m_s_rad, path_of(spec)};
}

std::unique_ptr<Device> make_hand(const DeviceSpec& spec, const std::string&) {
  return std::make_unique<HandDevice>(spec);
}

}  // namespace palpate::device
