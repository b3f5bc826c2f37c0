// Nodes carried by a bone: their motion and its derivatives, and conservation laws of tissue and bone at one
// instant.
#include <Eigen/Cholesky>

#include "fem/bone_in_tissue.h"

using namespace palpate;
using namespace palpate::fem;
using namespace palpate::fem::testing;

namespace {

/// Moves the bone's pose by h times a twist, angular part first; nodes follow.
void move_bone(BoneInTissue& b, const VecX& q0, const Vec6& twist, double h) {
  b.state.q() = q0;
  const auto& block = *b.state.layout().find(b.bone);
  auto q = b.state.q(block);
  const Quat r = quaternion_of(h * twist.head<3>()) * Quat(q[0], q[1], q[2], q[3]);
  q.head<4>() << r.w(), r.vec();
  q.tail<3>() += h * twist.tail<3>();
  b.impose();
}

BoneInTissue disturbed(BoneOptions options = {}, unsigned seed = 3) {
  BoneInTissue b(options);
  b.prepare();
  b.disturb(0.004, 1.0, seed);
  return b;
}

Vec6 test_twist() { return (Vec6() << 0.7, -1.1, 0.4, 0.3, 0.2, -0.5).finished(); }

}  // namespace

TEST(Carried, StandsWhereTheFormulaSays) {
  BoneInTissue b = disturbed();
  const auto& block = *b.state.layout().find(b.bone);
  const Quat r(b.state.q(block)[0], b.state.q(block)[1], b.state.q(block)[2], b.state.q(block)[3]);
  ASSERT_GE(b.carried.size(), 4u);
  for (std::size_t i = 0; i < b.carried.size(); ++i) {
    const Vec3 arm = r.normalized() * Vec3(b.local.col(static_cast<Eigen::Index>(i)));
    const Vec3 x = b.state.q(block).tail<3>() + arm,
               v = b.state.u(block).tail<3>() + Vec3(b.state.u(block).head<3>()).cross(arm);
    EXPECT_LT((b.state.view().position(b.carried[i]) - x).norm(), 1e-15);
    EXPECT_LT((b.state.view().velocity(b.carried[i]) - v).norm(), 1e-14);
  }
}

// G is the derivative of the positions, and G u' + gamma is the derivative of the velocities.
TEST(Carried, JacobianAndGammaAreDerivatives) {
  BoneInTissue b = disturbed();
  const VecX q0 = b.state.q();
  const int at = b.state.layout().find(b.bone)->u_offset;
  const Vec6 u = b.state.u().segment<6>(at), rate = test_twist();
  VecX x, v, gamma;
  MatX G;
  const auto motion = make_carried(
      dofs_of_nodes(b.carried, 0, "xyz"),
      [&] {
        Points per_dof(3, 3 * b.local.cols());
        for (Eigen::Index i = 0; i < per_dof.cols(); ++i) per_dof.col(i) = b.local.col(i / 3);
        return per_dof;
      }(),
      b.bone);
  EXPECT_EQ(motion->master_block(), b.bone);
  motion->evaluate(b.state.view(), x, v, gamma);
  motion->jacobian(b.state.view(), G);
  EXPECT_LT((G * u - v).norm(), 1e-14);
  const auto evaluate = [&](double h, VecX& moved) {
    move_bone(b, q0, u, h);
    b.state.u().segment<6>(at) = u + h * rate;
    VecX other, a;
    (&moved == &x ? motion->evaluate(b.state.view(), x, other, a)
                  : motion->evaluate(b.state.view(), other, v, a));
    return moved;
  };
  const VecX speed = G * u, change = G * rate + gamma;
  expect_slope_two([&](double h) { return evaluate(h, x); }, speed, 0.05, "positions");
  expect_slope_two([&](double h) { return evaluate(h, v); }, change, 0.05, "velocities");
}

// Rows of the bone in the step matrix's K: derivative, by the bone's rotation, of the force and moment that
// the carried nodes exert on it, with the nodal forces held fixed. K is symmetrised; the lost part is half
// the cross matrix of the residual moment.
TEST(Carried, TangentIsTheDerivativeOfTheReducedForce) {
  BoneInTissue b = disturbed({.damping = 0.0});
  b.state.u().setZero();
  b.impose();
  const VecX q0 = b.state.q();
  const auto& layout = b.state.layout();
  const int at = layout.find(b.bone)->u_offset, border = at - layout.nodal_size;
  VecX f, a, Ma;
  b.system.acceleration(b.state.view(), a);
  b.system.apply_mass(b.state.view(), a, Ma);  // held fixed
  const auto pressed = [&](double h) {
    move_bone(b, q0, test_twist(), h);
    b.system.force(b.state.view(), f);
    VecX c = f - Ma;
    b.system.reduce(b.state.view(), c);
    return VecX(c.segment<6>(at));
  };
  move_bone(b, q0, test_twist(), 0.0);
  dynamics::BorderedMatrix A;
  b.system.step_matrix(b.state.view(), 0.0, 0.0, 1.0, A);
  Mat6 K = A.corner.block<6, 6>(border, border);
  EXPECT_LT((K - K.transpose()).norm(), 1e-12 * K.norm());
  f.setZero();
  b.system.force(b.state.view(), f);
  VecX c = f - Ma;
  Vec3 moment = Vec3::Zero();
  for (std::size_t i = 0; i < b.carried.size(); ++i)
    moment += (b.state.view().position(b.carried[i]) -
               Vec3(b.state.q().segment<3>(layout.find(b.bone)->q_offset + 4)))
                  .cross(Vec3(c.segment<3>(3 * b.carried[i])));
  K.topLeftCorner<3, 3>() += 0.5 * cross_matrix(moment);
  expect_slope_two(pressed, VecX(-K * test_twist()), 2e-3, "reduced force");
  // The term is significant: without it the derivative is wrong at first order.
  VecX rotated = VecX::Zero(layout.u_size), x = VecX::Zero(layout.u_size);
  x.segment<6>(at) = test_twist();
  b.system.apply_carried_stiffness(b.state.view(), x, rotated);
  const double h = 1e-6;
  const VecX remainder = pressed(h) - pressed(0.0) + h * K * test_twist();
  EXPECT_LT(remainder.norm(), 0.1 * h * rotated.norm());
  EXPECT_EQ(rotated.head(layout.nodal_size).norm(), 0.0);
}

// Newton's and Euler's laws for tissue and bone together, for any state and any bone: without external force,
// momentum is constant.
TEST(Carried, TissueAndBoneKeepTheirMomentumAtEveryInstant) {
  for (const double ratio : {1.0, 1e-3, 1e-6}) {
    BoneInTissue b = disturbed({.mass_ratio = ratio, .damping = 1e-2});
    VecX a, f;
    b.system.force(b.state.view(), f);
    b.system.acceleration(b.state.view(), a);
    const Pose pose = dynamics::motion_of(b.state.view(), *b.state.layout().find(b.bone)).pose;
    const Vec3 w = b.state.u().segment<3>(b.state.layout().nodal_size);
    Vec6 rate = b.momentum_of(a);
    rate.head<3>() += w.cross(dynamics::world_inertia(pose, b.inertia) * w);
    const double forces = f.head(b.state.layout().nodal_size).lpNorm<1>();
    EXPECT_LT(rate.tail<3>().norm(), 1e-13 * forces) << "mass ratio " << ratio;
    EXPECT_LT(rate.head<3>().norm(), 1e-13 * forces * 0.1) << "mass ratio " << ratio;
    // force of the bone on its nodes equals the force of the nodes on the bone, reversed
    VecX r;
    b.system.reactions(b.state.view(), r);
    Vec3 on_nodes = Vec3::Zero();
    for (int node : b.carried) on_nodes += r.segment<3>(3 * node);
    const Vec3 bone_change = b.bone_mass * a.tail<3>();
    EXPECT_LT((bone_change + on_nodes).norm(), 1e-13 * forces);
  }
}

// Acceleration with carried nodes against the dense congruence, and its limit as the bone's mass goes to
// zero.
TEST(Carried, AccelerationIsThatOfTheReducedEquationsAndHasALimitWithoutABone) {
  std::vector<std::pair<double, VecX>> along;
  int counted = 0;
  for (const double ratio : {1e-3, 1e-4, 1e-5, 1e-6, 0.0}) {
    BoneInTissue b = disturbed({.mass_ratio = ratio > 0.0 ? ratio : 1e-3});
    const int n = b.state.layout().nodal_size, at = n;
    VecX f, gamma = VecX::Zero(n + 6), a;
    b.system.force(b.state.view(), f);
    MatX M = MatX::Zero(n + 6, n + 6), T = MatX::Identity(n + 6, n + 6);
    for (int i = 0; i < n; ++i) M(i, i) = b.masses[i / 3];
    const Pose pose = dynamics::motion_of(b.state.view(), *b.state.layout().find(b.bone)).pose;
    const double kept = ratio > 0.0 ? 1.0 : 0.0;
    M.block<3, 3>(at, at) = kept * dynamics::world_inertia(pose, b.inertia);
    M.diagonal().tail<3>().setConstant(kept * b.bone_mass);
    if (kept == 0.0) f.tail<6>().setZero();
    const Vec3 w = b.state.u().segment<3>(at);
    std::vector<int> free;
    for (int i = 0; i < n + 6; ++i)
      if (!b.system.driven_mask()[static_cast<std::size_t>(i)]) free.push_back(i);
    for (int node : b.carried) {
      const Vec3 arm = b.state.view().position(node) - pose.translation;
      T.block(3 * node, 0, 3, n).setZero();
      T.block<3, 3>(3 * node, at) = -cross_matrix(arm);
      T.block<3, 3>(3 * node, at + 3).setIdentity();
      gamma.segment<3>(3 * node) = w.cross(w.cross(arm));
    }
    const MatX P = T(Eigen::all, free);
    const VecX expected =
        P * MatX(P.transpose() * M * P).ldlt().solve(P.transpose() * (f - M * gamma)) + gamma;
    if (ratio > 0.0) {
      b.system.acceleration(b.state.view(), a);
      EXPECT_LT((a - expected).norm(), 1e-11 * expected.norm()) << "mass ratio " << ratio;
      along.emplace_back(ratio, a);
      continue;
    }
    for (std::size_t i = 1; i < along.size(); ++i, ++counted)
      EXPECT_NEAR((along[i - 1].second - expected).norm() / (along[i].second - expected).norm(), 10.0, 0.5)
          << "mass ratio " << along[i].first << ": linear in it";
  }
  EXPECT_EQ(counted, 3);
}

TEST(Carried, BadInputIsRefused) {
  expect_contains(message_of([] {
                    make_carried({0, 1}, Points::Zero(3, 1), 0);
                  }),
                  "2 directions and 1 values");
  expect_contains(message_of([] { make_carried({0}, Points::Zero(3, 1), -1); }), "need a rigid block");
  expect_contains(message_of([] { nodes_in_sphere(Points::Zero(3, 1), Vec3::Zero(), 0.0); }),
                  "radius_m = 0 must be positive");
  BoneInTissue b;
  b.system.add(make_carried({0}, Points::Zero(3, 1), b.tissue));
  expect_contains(message_of([&] { b.prepare(); }), "which is not a rigid block");
}
