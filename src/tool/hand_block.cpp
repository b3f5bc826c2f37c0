#include "tool/hand_block.h"

#include <cmath>

#include "core/so3.h"
#include "coupling.h"
#include "palpate/core/error.h"

namespace palpate::tool {

// With R_h = exp(theta) R_0 and J the left Jacobian at theta, the handle turns with omega = J theta', and a
// moment M on it has the power M . omega: the generalised force along theta is J^T M. With (M, F) the
// coupling's wrench on the tool, the generalised force on the hand is therefore (-J^T M, -F). With d the
// rotation vector from tool to handle, J_d its left Jacobian, e a rotation of the tool and J' v =
// d(J v)/dtheta,
//     dM = k_r (J_d^-1 J dtheta - J_{-d}^-1 e) + b_r (J dtheta'' + J' theta' dtheta - domega_t),
//     d(J^T M) = J^T dM + (J^T)' M dtheta,
// where dtheta'' denotes the change of theta'. The arm's spring acts on theta, not on the rotation, as in
// src/device/hand.cpp; about one axis the two are the same.
namespace {

using dynamics::BorderedMatrix;
using dynamics::StateView;

constexpr double kSmooth = 1e-5, kSmoothRotation = 1e-4;  ///< v_r [m/s, rad/s]

const dynamics::Block& block_of(const StateView& state, int id) {
  const dynamics::Block* block = state.layout->find(id);
  PALPATE_CHECK(block && block->u_size == 6 && block->q_size == 6, "block {} is not a hand", id);
  return *block;
}

/// Returns d(J v)/dtheta (sign = 1) or d(J^T v)/dtheta (sign = -1) of the left Jacobian
///     J = a 1 + b [theta]x + c theta theta^T,   a = sin p/p,  b = (1 - cos p)/p^2,  c = (p - sin p)/p^3,
/// p = |theta|. The gradient of each coefficient is its derivative by p, divided by p, times theta.
Mat3 jacobian_derivative(const Vec3& theta, const Vec3& v, double sign) {
  const double p = theta.norm(), p2 = p * p;
  double b = 0.5 - p2 / 24.0, c = 1.0 / 6.0 - p2 / 120.0;
  double da = -1.0 / 3.0 + p2 / 30.0, db = -1.0 / 12.0 + p2 / 180.0, dc = -1.0 / 60.0 + p2 / 1260.0;
  if (p > 0.02) {
    const double s = std::sin(p), co = std::cos(p);
    b = (1.0 - co) / p2;
    c = (p - s) / (p * p2);
    da = (p * co - s) / (p * p2);
    db = (p * s - 2.0 * (1.0 - co)) / (p2 * p2);
    dc = (3.0 * s - p * (2.0 + co)) / (p * p2 * p2);
  }
  const double along = theta.dot(v);
  return (da * v + sign * db * theta.cross(v) + dc * along * theta) * theta.transpose() -
         sign * b * cross_matrix(v) + c * (along * Mat3::Identity() + theta * v.transpose());
}

class HandInertia : public dynamics::InertiaTerm {
 public:
  HandInertia(int hand_id, const HandBlock& hand) : hand_id_(hand_id) {
    mass_ << Vec3::Constant(hand.rotation.mass), Vec3::Constant(hand.translation.mass);
  }
  int block_id() const override { return hand_id_; }
  bool diagonal() const override { return true; }
  void add_mass(const StateView& state, double scale, BorderedMatrix& A) const override {
    const int at = block_of(state, hand_id_).u_offset - state.layout->nodal_size;
    A.corner.diagonal().segment<6>(at) += scale * mass_;
  }
  void apply(const StateView& state, const VecX& x, VecX& y) const override {
    const int at = block_of(state, hand_id_).u_offset;
    y.segment<6>(at) += mass_.cwiseProduct(x.segment<6>(at));
  }

 private:
  int hand_id_;
  Vec6 mass_;
};

/// Force of the arm and friction of the device, axis by axis.
class ArmTerm : public dynamics::ForceTerm, public dynamics::CornerTerm {
 public:
  ArmTerm(int hand_id, const HandBlock& hand)
      : hand_id_(hand_id), requested_(hand.requested), first_(hand.requested(0.0).pose.rotation) {
    const auto fill = [](Vec6& out, double rotation, double translation) {
      out << Vec3::Constant(rotation), Vec3::Constant(translation);
    };
    fill(k_, hand.rotation.stiffness, hand.translation.stiffness);
    fill(b_, hand.rotation.arm_damping, hand.translation.arm_damping);
    fill(c_, hand.rotation.damping, hand.translation.damping);
    fill(f_, hand.rotation.friction, hand.translation.friction);
    fill(smooth_, kSmoothRotation, kSmooth);
  }
  std::string_view name() const override { return "arm"; }
  dynamics::TermTraits traits() const override { return {.fast = true, .conservative = true}; }

  void add_force(const StateView& state, VecX& f) override {
    const At at(*this, state);
    f.segment<6>(at.u_offset) += k_.cwiseProduct(at.behind) + b_.cwiseProduct(at.rate_behind) -
                                 c_.cwiseProduct(at.rate) - friction(at.rate);
  }
  void add_tangent(const StateView& state, double k_scale, double d_scale, BorderedMatrix& A) override {
    const At at(*this, state);
    A.corner.diagonal().segment<6>(at.u_offset - state.layout->nodal_size) += slope(at, k_scale, d_scale);
  }
  void apply_tangent(const StateView& state, double k_scale, double d_scale, const VecX& x,
                     VecX& y) override {
    const At at(*this, state);
    y.segment<6>(at.u_offset) += slope(at, k_scale, d_scale).cwiseProduct(x.segment<6>(at.u_offset));
  }
  double energy(const StateView& state) override {
    const Vec6 behind = At(*this, state).behind;
    return 0.5 * behind.dot(k_.cwiseProduct(behind));
  }
  double dissipated_power(const StateView& state) override {
    const At at(*this, state);
    return at.rate_behind.dot(b_.cwiseProduct(at.rate_behind)) +
           at.rate.dot(c_.cwiseProduct(at.rate) + friction(at.rate));
  }

 private:
  /// Lag of the hand behind the arm's target, and its rate.
  struct At {
    int u_offset;
    Vec6 behind, rate, rate_behind;
    At(const ArmTerm& arm, const StateView& state) {
      const dynamics::Block& block = block_of(state, arm.hand_id_);
      u_offset = block.u_offset;
      const HandleState requested = arm.requested_(state.time);
      const Vec3 theta = rotation_vector(requested.pose.rotation * arm.first_.conjugate());
      behind << theta, requested.pose.translation;
      rate_behind << left_jacobian_inverse(theta) * requested.twist.angular, requested.twist.linear;
      behind -= state.q.segment<6>(block.q_offset);
      rate = state.u.segment<6>(block.u_offset);
      rate_behind -= rate;
    }
  };
  Vec6 friction(const Vec6& rate) const {
    return f_.array() * rate.array() / (rate.array().square() + smooth_.array().square()).sqrt();
  }
  Vec6 slope(const At& at, double k_scale, double d_scale) const {
    const Vec6 s2 = smooth_.cwiseAbs2(), all = at.rate.cwiseAbs2() + s2;
    const Vec6 sliding = f_.array() * s2.array() / (all.array() * all.array().sqrt());
    return k_scale * k_ + d_scale * (b_ + c_ + sliding);
  }

  int hand_id_;
  HandlePath requested_;
  Quat first_;
  Vec6 k_, b_, c_, f_, smooth_;
};

class HandCoupling : public dynamics::ForceTerm, public dynamics::CornerTerm {
 public:
  HandCoupling(int hand_id, int tool_id, const CouplingGains& gains, const HandBlock& hand)
      : hand_id_(hand_id), tool_id_(tool_id), gains_(gains), hand_(hand) {}
  std::string_view name() const override { return "virtual coupling"; }
  dynamics::TermTraits traits() const override {
    return {.fast = true, .symmetric_tangent = false, .conservative = true};
  }
  void add_force(const StateView& state, VecX& f) override {
    const At at(*this, state);
    const Vec6 wrench = coupling_wrench(gains_, at.tool, at.handle);
    f.segment<6>(at.tool_row) += wrench;
    f.segment<3>(at.hand_row) -= at.J.transpose() * wrench.head<3>();
    f.segment<3>(at.hand_row + 3) -= wrench.tail<3>();
  }
  void add_tangent(const StateView& state, double k_scale, double d_scale, BorderedMatrix& A) override {
    const At at(*this, state);
    const Blocks blocks(*this, at, k_scale, d_scale);
    const int t = at.tool_row - state.layout->nodal_size, h = at.hand_row - state.layout->nodal_size;
    A.corner.block<6, 6>(t, t) += blocks.tool_tool;
    A.corner.block<6, 6>(t, h) += blocks.tool_hand;
    A.corner.block<6, 6>(h, t) += blocks.hand_tool;
    A.corner.block<6, 6>(h, h) += blocks.hand_hand;
  }
  void apply_tangent(const StateView& state, double k_scale, double d_scale, const VecX& x,
                     VecX& y) override {
    const At at(*this, state);
    const Blocks blocks(*this, at, k_scale, d_scale);
    const Vec6 tool = x.segment<6>(at.tool_row), hand = x.segment<6>(at.hand_row);
    y.segment<6>(at.tool_row) += blocks.tool_tool * tool + blocks.tool_hand * hand;
    y.segment<6>(at.hand_row) += blocks.hand_tool * tool + blocks.hand_hand * hand;
  }
  double energy(const StateView& state) override {
    const At at(*this, state);
    return coupling_energy(gains_, at.tool.pose, at.handle.pose);
  }
  double dissipated_power(const StateView& state) override {
    const At at(*this, state);
    return coupling_dissipation(gains_, at.tool.twist, at.handle.twist);
  }

 private:
  struct At {
    RigidMotion tool, handle;
    Vec3 theta, theta_rate;
    Mat3 J;
    int tool_row, hand_row;
    At(const HandCoupling& own, const StateView& state) {
      const dynamics::Block& block = dynamics::rigid_block_of(state, own.tool_id_);
      tool = dynamics::motion_of(state, block);
      tool_row = block.u_offset;
      const dynamics::Block& hand = block_of(state, own.hand_id_);
      hand_row = hand.u_offset;
      theta = state.q.segment<3>(hand.q_offset);
      theta_rate = state.u.segment<3>(hand.u_offset);
      J = left_jacobian(theta);
      const HandleState h = hand_motion(state, own.hand_id_, own.hand_);
      handle = {h.pose, h.twist};
    }
  };
  struct Blocks {
    Mat6 tool_tool, tool_hand = Mat6::Zero(), hand_tool, hand_hand;
    Blocks(const HandCoupling& own, const At& at, double k_scale, double d_scale) {
      const CouplingGains& g = own.gains_;
      const Vec3 d = pose_difference(at.tool.pose, at.handle.pose).head<3>();
      const Vec3 moment = coupling_wrench(g, at.tool, at.handle).head<3>();
      tool_tool =
          k_scale * coupling_stiffness(g, at.tool.pose, at.handle.pose) + d_scale * coupling_damping(g);
      const Mat3 by_theta =
          g.k_r * left_jacobian_inverse(d) * at.J + g.b_r * jacobian_derivative(at.theta, at.theta_rate, 1.0);
      tool_hand.topLeftCorner<3, 3>() = -k_scale * by_theta - d_scale * g.b_r * at.J;
      tool_hand.bottomRightCorner<3, 3>() = -(k_scale * g.k + d_scale * g.b) * Mat3::Identity();
      hand_tool = -tool_tool;
      hand_hand = -tool_hand;
      hand_tool.topRows<3>() = (at.J.transpose() * hand_tool.topRows<3>()).eval();
      hand_hand.topRows<3>() = (at.J.transpose() * hand_hand.topRows<3>()).eval();
      hand_hand.topLeftCorner<3, 3>() += k_scale * jacobian_derivative(at.theta, moment, -1.0);
    }
  };

  int hand_id_, tool_id_;
  CouplingGains gains_;
  HandBlock hand_;
  friend struct At;
};

}  // namespace

dynamics::BlockSpec hand_block(double length, double speed) {
  dynamics::BlockSpec spec;
  spec.name = "hand";
  spec.kind = dynamics::BlockKind::kArticulated;
  spec.q_size = spec.u_size = 6;
  spec.q_scale = length;
  spec.u_scale = speed;
  spec.angles_q = spec.angles_u = {1, 1, 1, 0, 0, 0};
  return spec;
}

VecX hand_at_start(const HandBlock& hand) {
  VecX q = VecX::Zero(6);
  q.tail<3>() = hand.requested(0.0).pose.translation;
  return q;
}

HandleState hand_motion(const StateView& state, int hand_id, const HandBlock& hand) {
  const dynamics::Block& block = block_of(state, hand_id);
  const Vec3 theta = state.q.segment<3>(block.q_offset);
  return {
      {quaternion_of(theta) * hand.requested(0.0).pose.rotation, state.q.segment<3>(block.q_offset + 3)},
      {left_jacobian(theta) * state.u.segment<3>(block.u_offset), state.u.segment<3>(block.u_offset + 3)}};
}

HandTerms make_hand_terms(int hand_id, int tool_id, const ToolSpec& spec, const HandBlock& hand) {
  return {std::make_shared<HandInertia>(hand_id, hand), std::make_shared<ArmTerm>(hand_id, hand),
          std::make_shared<HandCoupling>(hand_id, tool_id, coupling_gains(spec), hand)};
}

}  // namespace palpate::tool
