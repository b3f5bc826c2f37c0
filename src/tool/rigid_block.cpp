#include "palpate/tool/rigid_block.h"

#include "palpate/core/error.h"
#include "parameters.h"
#include "rigid_force.h"

namespace palpate::tool {
namespace {

using dynamics::BorderedMatrix;
using dynamics::StateView;

class RigidInertia : public dynamics::InertiaTerm {
 public:
  RigidInertia(int block_id, double mass, const Vec3& inertia) : block_id_(block_id), mass_(mass), inertia_(inertia) {
    check_inertia(mass, inertia, "rigid body");
  }
  int block_id() const override { return block_id_; }
  bool diagonal() const override { return false; }
  void add_mass(const StateView& state, double scale, BorderedMatrix& A) const override {
    const auto& block = rigid_block_of(state, block_id_);
    const int at = block.u_offset - state.layout->nodal_size;
    A.corner.block<3, 3>(at, at) += scale * world_inertia(motion_of(state, block).pose, inertia_);
    A.corner.diagonal().segment<3>(at + 3).array() += scale * mass_;
  }
  void apply(const StateView& state, const VecX& x, VecX& y) const override {
    const auto& block = rigid_block_of(state, block_id_);
    y.segment<3>(block.u_offset) += world_inertia(motion_of(state, block).pose, inertia_) * x.segment<3>(block.u_offset);
    y.segment<3>(block.u_offset + 3) += mass_ * x.segment<3>(block.u_offset + 3);
  }

 private:
  int block_id_;
  double mass_;
  Vec3 inertia_;
};

class Gyroscopic : public RigidForce {
 public:
  Gyroscopic(int block_id, const Vec3& inertia, bool tangent) : RigidForce(block_id), inertia_(inertia), tangent_(tangent) {
    check_inertia(1.0, inertia, "rigid body");
  }
  std::string_view name() const override { return "gyroscopic"; }
  dynamics::TermTraits traits() const override { return {.stiff = false, .symmetric_tangent = !tangent_, .has_tangent = tangent_}; }
  Vec6 force(double, const RigidMotion& m) const override {
    Vec6 f = Vec6::Zero();
    f.head<3>() = -m.twist.angular.cross(world_inertia(m.pose, inertia_) * m.twist.angular);
    return f;
  }
  Mat6 tangent(double, const RigidMotion& m, double k_scale, double d_scale) const override {
    return tangent_ ? gyroscopic_tangent(m, inertia_, k_scale, d_scale) : Mat6(Mat6::Zero());
  }

 private:
  Vec3 inertia_;
  bool tangent_;
};

class Weight : public RigidForce {
 public:
  Weight(int block_id, double mass, const Vec3& gravity) : RigidForce(block_id), weight_(mass * gravity) {}
  std::string_view name() const override { return "rigid weight"; }
  dynamics::TermTraits traits() const override { return {.stiff = false, .conservative = true}; }
  Vec6 force(double, const RigidMotion&) const override {
    Vec6 f = Vec6::Zero();
    f.tail<3>() = weight_;
    return f;
  }
  Mat6 tangent(double, const RigidMotion&, double, double) const override { return Mat6::Zero(); }
  double energy(const StateView& state) override { return -weight_.dot(motion(state).pose.translation); }

 private:
  Vec3 weight_;
};

class CouplingTerm : public RigidForce {
 public:
  CouplingTerm(int block_id, const CouplingGains& gains, HandlePath handle, bool symmetric)
      : RigidForce(block_id), gains_(gains), handle_(std::move(handle)), symmetric_(symmetric) {}
  std::string_view name() const override { return "virtual coupling"; }
  dynamics::TermTraits traits() const override { return {.fast = true, .symmetric_tangent = symmetric_, .conservative = true}; }
  Vec6 force(double t, const RigidMotion& m) const override { return coupling_wrench(gains_, m, handle(t)); }
  Mat6 tangent(double t, const RigidMotion& m, double k_scale, double d_scale) const override {
    Mat6 K = coupling_stiffness(gains_, m.pose, handle(t).pose);
    if (symmetric_) K = (0.5 * (K + K.transpose())).eval();
    return k_scale * K + d_scale * coupling_damping(gains_);
  }
  double energy(const StateView& state) override { return coupling_energy(gains_, motion(state).pose, handle(state.time).pose); }
  double dissipated_power(const StateView& state) override {
    return coupling_dissipation(gains_, motion(state).twist, handle(state.time).twist);
  }

 private:
  RigidMotion handle(double t) const {
    const HandleState h = handle_(t);
    return {h.pose, h.twist};
  }

  CouplingGains gains_;
  HandlePath handle_;
  bool symmetric_;
};

}  // namespace

dynamics::BlockSpec rigid_block(std::string name, double length, double speed) {
  PALPATE_CHECK(length > 0.0 && speed > 0.0, "scales of rigid block \"{}\": {} m, {} m/s", name, length, speed);
  return {std::move(name), dynamics::BlockKind::kRigidBody, 7, 6, length, speed, dynamics::free_body_kinematics()};
}

std::shared_ptr<dynamics::InertiaTerm> make_rigid_inertia(int block_id, double mass, const Vec3& inertia) {
  return std::make_shared<RigidInertia>(block_id, mass, inertia);
}
std::shared_ptr<dynamics::ForceTerm> make_gyroscopic(int block_id, const Vec3& inertia, bool tangent) {
  return std::make_shared<Gyroscopic>(block_id, inertia, tangent);
}
std::shared_ptr<dynamics::ForceTerm> make_rigid_weight(int block_id, double mass, const Vec3& gravity) {
  return std::make_shared<Weight>(block_id, mass, gravity);
}
Wrench coupling_on_hand(const ToolSpec& spec, const HandleState& tool, const HandleState& handle) {
  const Wrench on_tool = wrench_of(coupling_wrench(coupling_gains(spec), {tool.pose, tool.twist}, {handle.pose, handle.twist}));
  return {-on_tool.moment, -on_tool.force};
}
std::shared_ptr<dynamics::ForceTerm> make_coupling_term(int block_id, const ToolSpec& spec, HandlePath handle, bool symmetric) {
  return std::make_shared<CouplingTerm>(block_id, coupling_gains(spec), std::move(handle), symmetric);
}

}  // namespace palpate::tool
