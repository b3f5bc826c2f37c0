#pragma once
#include "integrate/fakes.h"
#include "palpate/core/pose.h"
#include "palpate/dynamics/rigid_body.h"

/// A rigid body with a known motion, together with a node.
namespace palpate::fakes {

inline constexpr double kI1 = 0.02, kI3 = 0.05, kMass = 2.0, kNodeMass = 0.5, kSpring = 40.0;

inline Mat3 inertia_in_world(const StateView& s, const Block& b) {
  const Mat3 R = Quat(s.q[b.q_offset], s.q[b.q_offset + 1], s.q[b.q_offset + 2], s.q[b.q_offset + 3])
                     .normalized()
                     .toRotationMatrix();
  return R * Vec3(kI1, kI1, kI3).asDiagonal() * R.transpose();
}

/// A symmetric top's mass in world axes, and its gyroscopic force -w x I w.
struct TopInertia final : InertiaTerm {
  int id;
  explicit TopInertia(int i) : id(i) {}
  int block_id() const override { return id; }
  bool diagonal() const override { return false; }
  void add_mass(const StateView& s, double scale, BorderedMatrix& A) const override {
    A.corner.block<3, 3>(0, 0) += scale * inertia_in_world(s, *s.layout->find(id));
    A.corner.block<3, 3>(3, 3) += scale * kMass * Mat3::Identity();
  }
  void apply(const StateView& s, const VecX& x, VecX& y) const override {
    const Block& b = *s.layout->find(id);
    y.segment<3>(b.u_offset) += inertia_in_world(s, b) * x.segment<3>(b.u_offset);
    y.segment<3>(b.u_offset + 3) += kMass * x.segment<3>(b.u_offset + 3);
  }
};

/// Gyroscopic force of the top, and a spring between its centre and node 0.
struct TopForces final : ForceTerm {
  int id;
  bool fast;
  explicit TopForces(int i, bool is_fast = false) : id(i), fast(is_fast) {}
  std::string_view name() const override { return "top"; }
  TermTraits traits() const override { return {.fast = fast, .symmetric_tangent = false}; }
  void add_force(const StateView& s, VecX& f) override {
    const Block& b = *s.layout->find(id);
    const Vec3 w = s.u.segment<3>(b.u_offset);
    f.segment<3>(b.u_offset) -= w.cross(inertia_in_world(s, b) * w);
    const Vec3 pull = kSpring * (s.q.segment<3>(b.q_offset + 4) - s.q.head<3>());
    f.head<3>() += pull;
    f.segment<3>(b.u_offset + 3) -= pull;
  }
  Mat3 gyroscopic(const StateView& s, const Block& b) const {
    const Vec3 w = s.u.segment<3>(b.u_offset);
    const Mat3 I = inertia_in_world(s, b);
    return cross_matrix(w) * I - cross_matrix(I * w);
  }
  void add_tangent(const StateView& s, double k, double d, BorderedMatrix& A) override {
    A.corner.block<3, 3>(0, 0) += d * gyroscopic(s, *s.layout->find(id));
    A.corner.block<3, 3>(3, 3) += k * kSpring * Mat3::Identity();
    A.body.add(A.body.slot(0, 0), k * kSpring * Mat3::Identity());
    A.right.block<3, 3>(0, 3) -= k * kSpring * Mat3::Identity();
    A.bottom.block<3, 3>(3, 0) -= k * kSpring * Mat3::Identity();
  }
  void apply_tangent(const StateView& s, double k, double d, const VecX& x, VecX& y) override {
    const Block& b = *s.layout->find(id);
    y.segment<3>(b.u_offset) += d * (gyroscopic(s, b) * x.segment<3>(b.u_offset));
    const Vec3 stretch = k * kSpring * (x.segment<3>(b.u_offset + 3) - x.head<3>());
    y.head<3>() -= stretch;
    y.segment<3>(b.u_offset + 3) += stretch;
  }
};

/// Torque-free symmetric top: the axis e3 precesses about L at |L|/I1, and the body additionally rotates
/// about e3 by w3 (1 - I3/I1) (Landau and Lifshitz, Mechanics, 33). Its centre and a node swing about their
/// common centre of mass with omega^2 = k (1/m1 + 1/m2).
struct Top {
  State state;
  System system;
  Vec3 w0 = Vec3(1.0, -0.5, 3.0), L, node0 = Vec3(0.2, 0.0, -0.1);
  const Block* body = nullptr;

  /// @param fast  assigns the top's forces to the fast side of a multi-rate method
  explicit Top(bool fast = false) {
    state.insert(BlockSpec{.name = "node", .q_size = 3, .u_size = 3}, node0, VecX::Zero(3));
    VecX q = VecX::Unit(7, 0), u = VecX::Zero(6);
    u.head<3>() = w0;
    const int id = state.insert(rigid_block("top", 1.0, 1.0), q, u);
    L = Vec3(kI1, kI1, kI3).cwiseProduct(w0);
    system.add(std::make_shared<TopForces>(id, fast));
    system.add(std::make_shared<TopInertia>(id));
    system.add(std::make_shared<NodalMass>(0, kNodeMass * MatX::Identity(3, 3)));
    system.prepare(state.view());
    body = state.layout().find(id);
  }
  Quat rotation(double t) const {
    const double spin = w0[2] * (1.0 - kI3 / kI1);
    return quaternion_of(t * L / kI1) * quaternion_of(Vec3(0, 0, t * spin));
  }
  double error() {
    const double t = state.time(), swing = std::cos(t * std::sqrt(kSpring * (1.0 / kMass + 1.0 / kNodeMass)));
    const auto q = state.q(*body);
    const Vec3 centre = kNodeMass / (kMass + kNodeMass) * node0;
    const Vec3 apart = q.tail<3>() - state.q().head<3>(),
               middle = (kMass * q.tail<3>() + kNodeMass * state.q().head<3>()) / (kMass + kNodeMass);
    return rotation_vector(Quat(q[0], q[1], q[2], q[3]) * rotation(t).conjugate()).norm() +
           (apart + swing * node0).norm() + (middle - centre).norm();
  }
};

}  // namespace palpate::fakes
