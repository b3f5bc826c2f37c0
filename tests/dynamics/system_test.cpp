#include "palpate/dynamics/system.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "dynamics/chain.h"
#include "palpate/core/error.h"

using namespace palpate;
using namespace palpate::dynamics;

TEST(System, AccelerationIsForceOverMass) {
  Chain c(3);
  c.system.add(std::make_shared<ChainMass>(c.block, 3, 2.0));
  c.system.prepare(c.state.view());
  VecX f, a;
  c.system.force(c.state.view(), f);
  c.system.acceleration(c.state.view(), a);
  EXPECT_LT((2.0 * a - f).norm(), 1e-13);
  EXPECT_NEAR(f[0], 50.0 * (1.1 - 1.0), 1e-12);
}

TEST(System, ConsistentMassIsSolvedNotLumped) {
  Chain c(3);
  c.system.add(std::make_shared<ChainMass>(c.block, 3, 2.0, 0.5));
  EXPECT_THROW(c.system.prepare(c.state.view()), InternalError) << "without a mass solver";
  c.system.set_mass_solver(std::make_unique<DenseSolver>());
  c.system.prepare(c.state.view());
  VecX f, a, Ma;
  c.system.force(c.state.view(), f);
  c.system.acceleration(c.state.view(), a);
  c.system.apply_mass(c.state.view(), a, Ma);
  EXPECT_LT((Ma - f).norm(), 1e-12);
}

TEST(System, DrivenDirectionsFollowTheirMotionAndReportWhatHoldsThem) {
  for (const double coupling : {0.0, 0.5}) {
    Chain c(3);
    c.system.add(std::make_shared<ChainMass>(c.block, 3, 2.0, coupling));
    c.system.add(std::make_shared<Held>(std::vector<int>{0, 1, 2}, VecX::Zero(3), 3.0));
    c.system.set_mass_solver(std::make_unique<DenseSolver>());
    c.system.prepare(c.state.view());
    VecX a, r, f, Ma;
    c.state.set_time(2.0);
    c.system.impose(c.state.layout(), 2.0, c.state.q().data(), c.state.u().data());
    EXPECT_NEAR(c.state.q()[0], 6.0, 1e-14);
    EXPECT_NEAR(c.state.u()[1], 6.0, 1e-14);
    c.system.acceleration(c.state.view(), a);
    EXPECT_EQ(a[0], 3.0);
    c.system.reactions(c.state.view(), r);
    c.system.force(c.state.view(), f);
    c.system.apply_mass(c.state.view(), a, Ma);
    EXPECT_LT((Ma - f - r).norm(), 1e-11) << "Newton's law with the reactions, coupling " << coupling;
    EXPECT_EQ(r.tail(6).norm(), 0.0);
    EXPECT_GT(r.head(3).norm(), 1.0);
  }
}

TEST(System, DirectionsDrivenTwiceAreRefused) {
  Chain c(2);
  c.system.add(std::make_shared<ChainMass>(c.block, 2, 1.0));
  c.system.add(std::make_shared<Held>(std::vector<int>{0}, VecX::Zero(1), 0.0));
  c.system.add(std::make_shared<Held>(std::vector<int>{0, 1}, VecX::Zero(2), 0.0));
  EXPECT_THROW(c.system.prepare(c.state.view()), Error);
}

TEST(System, StepMatrixHasIdentityRowsForDrivenDirectionsAndKeepsItsPattern) {
  Chain c(3);
  c.system.add(std::make_shared<ChainMass>(c.block, 3, 2.0));
  c.system.add(std::make_shared<Held>(std::vector<int>{4}, VecX::Zero(1), 0.0));
  c.system.prepare(c.state.view());
  BorderedMatrix A;
  c.system.step_matrix(c.state.view(), 1.0, 0.0, 0.1, A);
  const std::uint64_t pattern = A.body.pattern_version(), values = A.values_version;
  const MatX dense = A.to_dense();
  EXPECT_EQ(VecX(dense.row(4)), VecX::Unit(9, 4));
  EXPECT_EQ(VecX(dense.col(4)), VecX::Unit(9, 4));
  EXPECT_NEAR(dense(3, 3), 2.0 + 0.1 * 100, 1e-13);
  EXPECT_NEAR(dense(0, 3), -5.0, 1e-13);
  c.system.step_matrix(c.state.view(), 1.0, 0.0, 0.1, A);
  EXPECT_EQ(A.body.pattern_version(), pattern);
  EXPECT_NE(A.values_version, values);
}

// A node is welded to a light bone: its force must turn and move the bone, and the two together obey Newton
// and Euler: total force on bone and node = rate of total linear momentum, moment about the bone's centre =
// rate of angular momentum.
TEST(System, NodesOnABoneBringTheirForceAndInertiaToIt) {
  for (const double coupling : {0.0, 0.5}) {
    Chain c(3);
    BlockSpec bone_spec;
    bone_spec.name = "bone";
    bone_spec.kind = BlockKind::kRigidBody;
    bone_spec.q_size = 7;
    bone_spec.u_size = 6;
    bone_spec.kinematics = free_body_kinematics();
    VecX q(7), u(6);
    q << 1, 0, 0, 0, 0.0, 0.3, -0.2;
    u << 0.5, -1.0, 2.0, 0.1, 0.2, 0.3;
    const int bone = c.state.insert(bone_spec, q, u);
    c.system.add(std::make_shared<ChainMass>(c.block, 3, 2.0, coupling));
    c.system.add(std::make_shared<BoneMass>(bone, 1e-3, 1e-4));
    c.system.add(std::make_shared<OnBone>(0, bone, Vec3(0.0, -0.3, 0.2)));
    c.system.set_mass_solver(std::make_unique<DenseSolver>());
    c.system.prepare(c.state.view());
    c.system.impose(c.state.layout(), 0.0, c.state.q().data(), c.state.u().data());
    VecX a, f, Ma;
    c.system.acceleration(c.state.view(), a);
    c.system.force(c.state.view(), f);
    c.system.apply_mass(c.state.view(), a, Ma);
    const Vec3 arm(0.0, -0.3, 0.2), w = u.head<3>();
    const Vec3 node_acceleration = a.segment<3>(12) + a.segment<3>(9).cross(arm) + w.cross(w.cross(arm));
    EXPECT_LT((a.head<3>() - node_acceleration).norm(), 1e-11);
    const Vec3 constraint = Ma.head<3>() - f.head<3>();  // force that the bone exerts on its node
    EXPECT_LT((Ma.segment<3>(12) + constraint).norm(), 1e-10 * constraint.norm());
    EXPECT_LT((Ma.segment<3>(9) + arm.cross(constraint)).norm(), 1e-10 * constraint.norm());
    EXPECT_LT((Ma.segment<6>(3) - f.segment<6>(3)).norm(), 1e-10 * f.norm()) << "free nodes";
  }
}

// The step matrix with carried nodes is T^T A T, compared with the dense congruence.
TEST(System, StepMatrixOfNodesOnABoneIsTheCongruence) {
  Chain c(3);
  BlockSpec bone_spec;
  bone_spec.name = "bone";
  bone_spec.kind = BlockKind::kRigidBody;
  bone_spec.q_size = 7;
  bone_spec.u_size = 6;
  bone_spec.kinematics = free_body_kinematics();
  VecX q(7);
  q << 1, 0, 0, 0, 0, 0, 0;
  c.system.add(std::make_shared<ChainMass>(c.block, 3, 2.0));
  const int bone = c.state.insert(bone_spec, q, VecX::Zero(6));
  c.system.add(std::make_shared<BoneMass>(bone, 0.7, 0.2));
  BorderedMatrix free_matrix;
  c.system.prepare(c.state.view());
  c.system.step_matrix(c.state.view(), 1.0, 0.1, 0.01, free_matrix);
  const Vec3 arm(0.1, 0.2, -0.4);
  c.system.add(std::make_shared<OnBone>(1, bone, arm));
  c.system.prepare(c.state.view());
  BorderedMatrix A;
  c.system.step_matrix(c.state.view(), 1.0, 0.1, 0.01, A);
  MatX T = MatX::Identity(15, 15);
  T.block<3, 3>(3, 3).setZero();
  T.block<3, 3>(3, 9) = -cross_matrix(arm);
  T.block<3, 3>(3, 12).setIdentity();
  MatX expected = T.transpose() * free_matrix.to_dense() * T;
  expected.block<3, 3>(3, 3).setIdentity();
  EXPECT_LT((A.to_dense() - expected).norm(), 1e-12);
}

TEST(System, FiltersTermsByWhatTheyAre) {
  Chain c(2);
  c.system.add(std::make_shared<ChainMass>(c.block, 2, 1.0));
  c.system.prepare(c.state.view());
  VecX all, none;
  c.system.force(c.state.view(), all);
  c.system.force(c.state.view(), none, [](const TermTraits& t) { return !t.stiff; });
  EXPECT_GT(all.norm(), 1.0);
  EXPECT_EQ(none.norm(), 0.0);
}

/// Springs that overwrite the rows of their block.
class StoredSprings final : public ChainSprings, public StoredTangentTerm {
 public:
  StoredSprings(int block, int nodes, double k) : ChainSprings(nodes, k), block_(block), count_(nodes) {}
  int stored_block() const override { return block_; }
  void store_tangent(const StateView& s, double k_scale, double d_scale, BorderedMatrix& A) override {
    A.body.set_zero(0, count_);
    add_tangent(s, k_scale, d_scale, A);
    ++stored;
  }
  int stored = 0;

 private:
  int block_, count_;
};

TEST(System, TermsThatStoreTheirRowsComeFirstAndOnlyOnceABlock) {
  Chain c(3);  // the chain's springs, k = 50, are added
  c.state.insert(BlockSpec{.name = "beside", .q_size = 6, .u_size = 6}, VecX::Zero(6), VecX::Zero(6));
  const auto first = std::make_shared<StoredSprings>(c.block, 3, 20.0),
             second = std::make_shared<StoredSprings>(c.block, 3, 3.0);
  c.system.add(first);
  c.system.add(second);
  c.system.add(std::make_shared<ChainMass>(c.block, 3, 2.0));
  const int beside = c.state.layout().find("beside")->id;
  struct Apart final : InertiaTerm {
    int block;
    explicit Apart(int b) : block(b) {}
    int block_id() const override { return block; }
    bool diagonal() const override { return true; }
    void add_mass(const StateView&, double scale, BorderedMatrix& A) const override {
      for (int i : {3, 4}) A.body.add(A.body.slot(i, i), scale * Mat3::Identity());
    }
    void apply(const StateView&, const VecX& x, VecX& y) const override { y.tail(6) += x.tail(6); }
  };
  c.system.add(std::make_shared<Apart>(beside));
  c.system.prepare(c.state.view());
  BorderedMatrix A;
  for (int time = 0; time < 2; ++time) {
    c.system.step_matrix(c.state.view(), 1.0, 0.0, 0.1, A);
    const MatX dense = A.to_dense();
    EXPECT_NEAR(dense(0, 0), 2.0 + 0.1 * 73.0, 1e-13) << "time " << time;
    EXPECT_NEAR(dense(0, 3), -0.1 * 73.0, 1e-13);
    EXPECT_NEAR(dense(3, 3), 2.0 + 0.2 * 73.0, 1e-13);
    EXPECT_EQ(MatX(dense.bottomRightCorner(6, 6)), MatX(MatX::Identity(6, 6)));
    EXPECT_EQ(first->stored, time + 1);
    EXPECT_EQ(second->stored, 0) << "what another term stored would be lost";
    std::fill(A.body.values().begin(), A.body.values().end(), 1e300);
  }
  c.system.step_matrix(c.state.view(), 1.0, 0.0, 0.0, A);
  EXPECT_NEAR(A.to_dense().norm(), std::sqrt(9 * 4.0 + 6.0), 1e-13) << "masses alone";
  std::fill(A.body.values().begin(), A.body.values().end(), 1e300);
  c.system.step_matrix(c.state.view(), 1.0, 0.0, 0.1, A, [](const TermTraits& t) { return t.contact; });
  EXPECT_NEAR(A.to_dense().norm(), std::sqrt(9 * 4.0 + 6.0), 1e-13) << "a filter that lets no term pass";
  EXPECT_EQ(first->stored, 2);
}
