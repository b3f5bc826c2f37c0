#include "palpate/dynamics/state.h"

#include <gtest/gtest.h>

#include "palpate/core/error.h"
#include "palpate/core/pose.h"

using namespace palpate;
using namespace palpate::dynamics;

namespace {

BlockSpec node_block(const char* name, int nodes) {
  BlockSpec spec;
  spec.name = name;
  spec.q_size = spec.u_size = 3 * nodes;
  return spec;
}

BlockSpec rigid_block() {
  BlockSpec spec;
  spec.name = "tool";
  spec.kind = BlockKind::kRigidBody;
  spec.q_size = 7;
  spec.u_size = 6;
  spec.kinematics = free_body_kinematics();
  return spec;
}

VecX counted(int n, double start) { return VecX::LinSpaced(n, start, start + n - 1); }

TEST(State, NodeBlocksStandBeforeRigidOnesWhateverTheOrderOfInsertion) {
  State state(100, 100);
  const int tool = state.insert(rigid_block(), counted(7, 100), counted(6, 200));
  const int body = state.insert(node_block("body", 2), counted(6, 0), counted(6, 10));
  const Layout& layout = state.layout();
  EXPECT_EQ(layout.blocks[0].id, body);
  EXPECT_EQ(layout.blocks[1].id, tool);
  EXPECT_EQ(layout.nodal_size, 6);
  EXPECT_EQ(layout.border_size(), 6);
  EXPECT_EQ(layout.find(tool)->q_offset, 6);
  EXPECT_EQ(state.q()[6], 100);
  EXPECT_EQ(state.u()[11], 205);
}

TEST(State, BlocksMoveInAndOutWithoutReallocation) {
  State state(40, 40, 4);
  const int a = state.insert(node_block("a", 2), counted(6, 0), counted(6, 50));
  const double* storage = state.q().data();
  const int b = state.insert(node_block("b", 3), counted(9, 20), counted(9, 70));
  const std::uint64_t version = state.layout().version;
  VecX q, u;
  const BlockSpec taken = state.extract(a, q, u);
  EXPECT_EQ(taken.name, "a");
  EXPECT_EQ(q, counted(6, 0));
  EXPECT_EQ(u, counted(6, 50));
  EXPECT_GT(state.layout().version, version);
  EXPECT_EQ(state.layout().find(a), nullptr);
  EXPECT_EQ(state.layout().find(b)->q_offset, 0);
  EXPECT_EQ(VecX(state.q()), counted(9, 20));
  const int back = state.insert(taken, q, u);
  EXPECT_NE(back, a) << "an id is never used again";
  EXPECT_EQ(state.q().data(), storage) << "the storage moved";
}

TEST(State, RefusesSizesThatDoNotFit) {
  State state;
  EXPECT_THROW(state.insert(node_block("a", 2), counted(5, 0), counted(6, 0)), InternalError);
  BlockSpec bad_scale = node_block("a", 1);
  bad_scale.q_scale = 0.0;
  EXPECT_THROW(state.insert(bad_scale, counted(3, 0), counted(3, 0)), InternalError);
  BlockSpec no_kinematics = rigid_block();
  no_kinematics.kinematics = nullptr;
  EXPECT_THROW(state.insert(no_kinematics, counted(7, 0), counted(6, 0)), InternalError);
  VecX q, u;
  EXPECT_THROW(state.extract(7, q, u), InternalError);
}

TEST(FreeBodyKinematics, LeftInverseUndoesTheRate) {
  VecX q(7), u(6), rate(7), back(6);
  q << 0.5, -0.5, 0.1, 0.7, 1, 2, 3;
  q.head<4>().normalize();
  u << 0.3, -2, 1, 4, 5, 6;
  free_body_kinematics()->q_dot(q, u, rate);
  EXPECT_NEAR(q.head<4>().dot(rate.head<4>()), 0.0, 1e-15) << "the norm of the quaternion must not change";
  free_body_kinematics()->u_of_q_dot(q, rate, back);
  EXPECT_LT((back - u).norm(), 1e-14);
}

// A constant angular velocity w rotates the body by exp(t [w]): the kinematic rate must be its derivative,
// with w in world axes.
TEST(FreeBodyKinematics, RateIsTheDerivativeOfARotationAboutAWorldAxis) {
  const Vec3 w(0.4, -1.2, 0.7);
  const Quat start(Eigen::AngleAxisd(0.9, Vec3(1, 2, -1).normalized()));
  const double h = 1e-5;
  const auto transposed = [&](double t) { return Quat(quaternion_of(t * w) * start); };
  VecX q(7), u(6), rate(7);
  q << start.w(), start.x(), start.y(), start.z(), 0, 0, 0;
  u << w, 0, 0, 0;
  free_body_kinematics()->q_dot(q, u, rate);
  const Eigen::Vector4d numeric = (transposed(h).coeffs() - transposed(-h).coeffs()) / (2 * h);
  EXPECT_NEAR(rate[0], numeric[3], 1e-9);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(rate[1 + i], numeric[i], 1e-9);
}

TEST(State, ProjectionNormalisesQuaternionsOnly) {
  State state;
  VecX q(7);
  q << 2, 0, 0, 0, 5, 6, 7;
  state.insert(rigid_block(), q, VecX::Zero(6));
  project(state.layout(), state.q().data());
  q[0] = 1;
  EXPECT_EQ(VecX(state.q()), q);
}

}  // namespace
