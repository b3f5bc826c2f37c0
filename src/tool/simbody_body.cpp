#include "simbody_body.h"

#include <exception>
#include <limits>

#include "core/counters.h"

namespace palpate::tool {
namespace {

SimTK::Vec3 to(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

SimTK::Body::Rigid make_body(const RigidParameters& p) {
  return SimTK::Body::Rigid(SimTK::MassProperties(
      p.mass, SimTK::Vec3(0), SimTK::Inertia(p.inertia.x(), p.inertia.y(), p.inertia.z())));
}

RigidMotion motion_of(const SimTK::Vector& q, const SimTK::Vector& u) {
  RigidMotion m;
  m.pose.rotation = Quat(q[0], q[1], q[2], q[3]).normalized();
  m.pose.translation = {q[4], q[5], q[6]};
  m.twist = {{u[0], u[1], u[2]}, {u[3], u[4], u[5]}};
  return m;
}

}  // namespace

/// Coupling and contact as one Simbody force. The tick's input is a discrete variable of the State: a change
/// invalidates all results that depend on it, and all trial states of an integrator use the same tick.
class SimbodyBody::TickForce : public SimTK::Force::Custom::Implementation {
 public:
  TickForce(const SimTK::GeneralForceSubsystem& forces, const SimTK::MobilizedBody& body)
      : forces_(forces), body_(body) {}

  void realizeTopology(SimTK::State& state) const override {
    index_ = forces_.allocateDiscreteVariable(state, SimTK::Stage::Dynamics, new SimTK::Value<TickInput>());
  }
  void calcForce(const SimTK::State& state, SimTK::Vector_<SimTK::SpatialVec>& body_forces,
                 SimTK::Vector_<SimTK::Vec3>&, SimTK::Vector&) const override {
    const auto& input = SimTK::Value<TickInput>::downcast(forces_.getDiscreteVariable(state, index_)).get();
    if (input.h <= 0.0) return;  // no tick yet
    const Vec6 w = applied_wrench(input, state.getTime(), motion_of(state.getQ(), state.getU()));
    body_forces[body_.getMobilizedBodyIndex()] += SimTK::SpatialVec(to(w.head<3>()), to(w.tail<3>()));
  }
  SimTK::Real calcPotentialEnergy(const SimTK::State&) const override { return 0.0; }

  void set(SimTK::State& state, const TickInput& input) const {
    SimTK::Value<TickInput>::updDowncast(forces_.updDiscreteVariable(state, index_)).upd() = input;
  }

 private:
  const SimTK::GeneralForceSubsystem& forces_;
  const SimTK::MobilizedBody& body_;
  mutable SimTK::DiscreteVariableIndex index_;
};

SimbodyBody::SimbodyBody(const RigidParameters& parameters)
    : parameters_(parameters),
      matter_(system_),
      forces_(system_),
      body_(matter_.Ground(), make_body(parameters)) {
  counters::count("tool.simbody_system");
  force_ = new TickForce(forces_, body_);
  SimTK::Force::Custom(forces_, force_);  // takes ownership
  if (!parameters_.gravity.isZero(0.0))
    SimTK::Force::UniformGravity(forces_, matter_, to(parameters_.gravity));
  state_ = system_.realizeTopology();
  system_.realizeModel(state_);
}

void SimbodyBody::write(SimTK::State& state, double t, const RigidMotion& motion) const {
  state.setTime(t);
  SimTK::Vector& q = state.updQ();
  const Quat& r = motion.pose.rotation;
  q[0] = r.w(), q[1] = r.x(), q[2] = r.y(), q[3] = r.z();
  for (int i = 0; i < 3; ++i) q[4 + i] = motion.pose.translation[i];
  SimTK::Vector& u = state.updU();
  for (int i = 0; i < 3; ++i) u[i] = motion.twist.angular[i], u[3 + i] = motion.twist.linear[i];
}

RigidMotion SimbodyBody::read(const SimTK::State& state) const {
  return motion_of(state.getQ(), state.getU());
}

void SimbodyBody::set_input(SimTK::State& state, const TickInput& input) const { force_->set(state, input); }

Vec6 SimbodyBody::acceleration(double t, const RigidMotion& motion, const TickInput& input) {
  write(state_, t, motion);
  force_->set(state_, input);
  system_.realize(state_, SimTK::Stage::Acceleration);
  const SimTK::Vector& a = state_.getUDot();
  Vec6 out;
  for (int i = 0; i < 6; ++i) out[i] = a[i];
  return out;
}

// I w' = m - w x I w,  m v' = f + m g,  about the centre of mass, which is the origin.
Vec6 SimbodyBody::right_hand_side(double t, const RigidMotion& motion, const TickInput& input) const {
  Vec6 f = applied_wrench(input, t, motion);
  const Mat3 R = motion.pose.rotation.toRotationMatrix();
  const Vec3& w = motion.twist.angular;
  const Vec3 angular_momentum = R * parameters_.inertia.cwiseProduct(R.transpose() * w);
  f.head<3>() -= w.cross(angular_momentum);
  f.tail<3>() += parameters_.mass * parameters_.gravity;
  return f;
}

Mat6 SimbodyBody::calc_mass(const RigidMotion& motion) {
  if (!is_somewhere(0.0, motion)) return Mat6::Constant(std::numeric_limits<double>::quiet_NaN());
  matter_.calcM(state_, mass_);
  Mat6 M;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) M(i, j) = mass_(i, j);
  return M;
}

// A diverging explicit method requests motions that Simbody cannot realise and for which it throws.
bool SimbodyBody::is_somewhere(double t, const RigidMotion& motion) {
  write(state_, t, motion);
  force_->set(state_, {});
  try {
    system_.realize(state_, SimTK::Stage::Dynamics);
  } catch (const std::exception&) { return false; }
  return true;
}

// Inverse dynamics returns the residual r = M u' + C(q, u) - f_applied; at u' = 0 the right-hand side of
// M u' = f is -r.
Vec6 SimbodyBody::calc_force(double t, const RigidMotion& motion) {
  if (!is_somewhere(t, motion)) return Vec6::Constant(std::numeric_limits<double>::quiet_NaN());
  zero_.resize(6);
  zero_.setToZero();
  matter_.calcResidualForceIgnoringConstraints(
      state_, zero_, system_.getRigidBodyForces(state_, SimTK::Stage::Dynamics), zero_, residual_);
  Vec6 f;
  for (int i = 0; i < 6; ++i) f[i] = -residual_[i];
  return f;
}

double SimbodyBody::calc_potential_energy(const RigidMotion& motion) {
  if (!is_somewhere(0.0, motion)) return std::numeric_limits<double>::quiet_NaN();
  return system_.calcPotentialEnergy(state_);
}

Mat6 SimbodyBody::mass_matrix(const Pose& pose) const {
  const Mat3 R = pose.rotation.toRotationMatrix();
  Mat6 M = Mat6::Zero();
  M.topLeftCorner<3, 3>() = R * parameters_.inertia.asDiagonal() * R.transpose();
  M.bottomRightCorner<3, 3>().diagonal().setConstant(parameters_.mass);
  return M;
}

}  // namespace palpate::tool
