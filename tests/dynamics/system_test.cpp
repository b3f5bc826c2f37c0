#include "palpate/dynamics/system.h"

#include <gtest/gtest.h>

#include "palpate/core/error.h"
#include "palpate/core/pose.h"

using namespace palpate;
using namespace palpate::dynamics;

namespace {

/// Springs along a chain of nodes, linear in all three directions: f_i = k (x_{i+1} - x_i - L) and its opposite.
class ChainSprings final : public ForceTerm {
 public:
  ChainSprings(int nodes, double k, bool balanced = true) : nodes_(nodes), k_(k), balanced_(balanced) {}
  std::string_view name() const override { return "springs"; }
  TermTraits traits() const override { return {.balanced = balanced_}; }
  void add_step(const StateView& s, const VecX& shift, double k_scale, double, VecX& f, BalancedMatrix& A) override {
    add_force(s, f);
    VecX product = VecX::Zero(f.size());
    apply_tangent(s, 1.0, 0.0, shift, product);
    f -= product;
    for (int i = 0; i + 1 < nodes_; ++i)
      Eigen::Map<Eigen::Matrix3f>(A.values.data() + 9 * A.place[static_cast<std::size_t>(A.pattern->slot(i, i + 1))]) =
          static_cast<float>(-A.scale * k_scale * k_) * Eigen::Matrix3f::Identity();
  }
  void add_pattern(PatternBuilder& pattern) const override {
    for (int i = 0; i + 1 < nodes_; ++i) pattern.add_pair(i, i + 1);
  }
  void add_force(const StateView& s, VecX& f) override {
    for (int i = 0; i + 1 < nodes_; ++i) {
      const Vec3 pull = k_ * (s.position(i + 1) - s.position(i) - Vec3::UnitX());
      f.segment<3>(3 * i) += pull;
      f.segment<3>(3 * i + 3) -= pull;
    }
  }
  void add_tangent(const StateView&, double k_scale, double, BorderedMatrix& A) override {
    for (int i = 0; i + 1 < nodes_; ++i)
      for (int a : {i, i + 1})
        for (int b : {i, i + 1}) A.body.add(A.body.slot(a, b), (a == b ? k_scale : -k_scale) * k_ * Mat3::Identity());
  }
  void apply_tangent(const StateView& s, double k_scale, double, const VecX& x, VecX& y) override {
    BorderedMatrix A;
    PatternBuilder builder(nodes_);
    add_pattern(builder);
    A.body = builder.build();
    add_tangent(s, k_scale, 0.0, A);
    A.body.multiply_add(x.data(), y.data());
  }

 private:
  int nodes_;
  double k_;
  bool balanced_;
};

/// Mass m on every node; with `coupling` > 0 neighbours share inertia (a consistent mass).
class ChainMass final : public InertiaTerm {
 public:
  ChainMass(int block, int nodes, double m, double coupling = 0.0) : block_(block), nodes_(nodes), m_(m), c_(coupling) {}
  int block_id() const override { return block_; }
  bool diagonal() const override { return c_ == 0.0; }
  void add_pattern(PatternBuilder& pattern) const override {
    if (c_ != 0.0)
      for (int i = 0; i + 1 < nodes_; ++i) pattern.add_pair(i, i + 1);
  }
  void add_mass(const StateView&, double scale, BorderedMatrix& A) const override {
    for (int i = 0; i < nodes_; ++i) A.body.add(A.body.slot(i, i), scale * m_ * Mat3::Identity());
    for (int i = 0; c_ != 0.0 && i + 1 < nodes_; ++i) {
      A.body.add(A.body.slot(i, i + 1), scale * c_ * Mat3::Identity());
      A.body.add(A.body.slot(i + 1, i), scale * c_ * Mat3::Identity());
    }
  }
  void apply(const StateView&, const VecX& x, VecX& y) const override {
    y.head(3 * nodes_) += m_ * x.head(3 * nodes_);
    for (int i = 0; c_ != 0.0 && i + 1 < nodes_; ++i) {
      y.segment<3>(3 * i) += c_ * x.segment<3>(3 * i + 3);
      y.segment<3>(3 * i + 3) += c_ * x.segment<3>(3 * i);
    }
  }

 private:
  int block_, nodes_;
  double m_, c_;
};

/// A rigid body of mass M and inertia I (isotropic), no coupling to nodes of its own.
class BoneMass final : public InertiaTerm {
 public:
  BoneMass(int block, double mass, double inertia) : block_(block), mass_(mass), inertia_(inertia) {}
  int block_id() const override { return block_; }
  bool diagonal() const override { return false; }
  void add_mass(const StateView&, double scale, BorderedMatrix& A) const override { A.corner.diagonal() += scale * diagonal_entries(); }
  void apply(const StateView& s, const VecX& x, VecX& y) const override {
    y.tail<6>() += diagonal_entries().cwiseProduct(x.segment<6>(s.layout->nodal_size));
  }

 private:
  Vec6 diagonal_entries() const { return (Vec6() << inertia_, inertia_, inertia_, mass_, mass_, mass_).finished(); }
  int block_;
  double mass_, inertia_;
};

/// Nodes held still, or moved with x = x0 + 1/2 a t^2.
class Held final : public DrivenMotion {
 public:
  Held(std::vector<int> dofs, VecX x0, double a) : dofs_(std::move(dofs)), x0_(std::move(x0)), a_(a) {}
  const std::vector<int>& dofs() const override { return dofs_; }
  void evaluate(const StateView& s, VecX& x, VecX& v, VecX& a) const override {
    x = x0_.array() + 0.5 * a_ * s.time * s.time;
    v.setConstant(a_ * s.time);
    a.setConstant(a_);
  }

 private:
  std::vector<int> dofs_;
  VecX x0_;
  double a_;
};

/// The second client: one node carried by a rigid body, x = p + R c.
class OnBone final : public DrivenMotion {
 public:
  OnBone(int node, int bone, const Vec3& c) : dofs_{3 * node, 3 * node + 1, 3 * node + 2}, bone_(bone), c_(c) {}
  const std::vector<int>& dofs() const override { return dofs_; }
  int master_block() const override { return bone_; }
  void evaluate(const StateView& s, VecX& x, VecX& v, VecX& a) const override {
    const auto [arm, w] = arm_and_spin(s);
    const Block& b = *s.layout->find(bone_);
    x = s.q.segment<3>(b.q_offset + 4) + arm;
    v = s.u.segment<3>(b.u_offset + 3) + w.cross(arm);
    a = w.cross(w.cross(arm));
  }
  void jacobian(const StateView& s, MatX& G) const override {
    G.leftCols<3>() = -cross_matrix(arm_and_spin(s).first);
    G.rightCols<3>().setIdentity();
  }

 private:
  std::pair<Vec3, Vec3> arm_and_spin(const StateView& s) const {
    const Block& b = *s.layout->find(bone_);
    const Quat r(s.q[b.q_offset], s.q[b.q_offset + 1], s.q[b.q_offset + 2], s.q[b.q_offset + 3]);
    return {r * c_, s.u.segment<3>(b.u_offset)};
  }
  std::vector<int> dofs_;
  int bone_;
  Vec3 c_;
};

/// A second linear solver: dense LU.
class DenseSolver final : public LinearSolver {
 public:
  std::string name() const override { return "dense"; }
  bool supports_unsymmetric() const override { return true; }
  SolveStatus factor(const BorderedMatrix& A) override {
    lu_.compute(A.to_dense());
    return SolveStatus::kOk;
  }
  SolveStatus solve(const MatX& B, MatX& X) override {
    X = lu_.solve(B);
    return SolveStatus::kOk;
  }
  SolveStatus solve(const VecX& b, VecX& x) override {
    x = lu_.solve(b);
    return SolveStatus::kOk;
  }
  const SolverCounters& counters() const override { return counters_; }

 private:
  Eigen::PartialPivLU<MatX> lu_;
  SolverCounters counters_;
};

struct Chain {
  State state;
  System system;
  int block = -1;
  explicit Chain(int nodes) {
    BlockSpec spec;
    spec.name = "chain";
    spec.q_size = spec.u_size = 3 * nodes;
    VecX q = VecX::Zero(3 * nodes);
    for (int i = 0; i < nodes; ++i) q[3 * i] = 1.1 * i * i;
    block = state.insert(spec, q, VecX::Zero(3 * nodes));
    system.add(std::make_shared<ChainSprings>(nodes, 50.0));
  }
};

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

// A node welded to a light bone: its force must turn and move the bone, and the two together obey Newton and Euler:
// total force on bone + node = rate of total linear momentum, moment about the bone's centre = rate of angular momentum.
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
    const Vec3 constraint = Ma.head<3>() - f.head<3>();  // what the bone exerts on its node
    EXPECT_LT((Ma.segment<3>(12) + constraint).norm(), 1e-10 * constraint.norm());
    EXPECT_LT((Ma.segment<3>(9) + arm.cross(constraint)).norm(), 1e-10 * constraint.norm());
    EXPECT_LT((Ma.segment<6>(3) - f.segment<6>(3)).norm(), 1e-10 * f.norm()) << "free nodes";
  }
}

// T^T A T against the dense congruence.
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

}  // namespace

namespace {

/// Room for a balanced matrix, in the order of the pattern's upper triangle.
BalancedMatrix room_for(const BlockSparse& pattern) {
  BalancedMatrix A;
  A.pattern = &pattern;
  A.place.assign(static_cast<std::size_t>(pattern.slot_count()), -1);
  int pairs = 0;
  for (int i = 0; i < pattern.block_rows(); ++i)
    for (int s = pattern.row_start()[static_cast<std::size_t>(i)]; s < pattern.row_start()[static_cast<std::size_t>(i) + 1]; ++s) {
      const int j = pattern.columns()[static_cast<std::size_t>(s)];
      if (j > i) A.place[static_cast<std::size_t>(s)] = A.place[static_cast<std::size_t>(pattern.slot(j, i))] = pairs++;
    }
  A.values.assign(9 * static_cast<std::size_t>(pairs), 0.0f);
  A.places_version = 1;
  return A;
}

}  // namespace

// The balanced matrix says what step_matrix says: off-diagonal blocks, and on the diagonal m less the row's sum; held rows apart.
TEST(System, ABalancedStepIsTheStep) {
  Chain c(5);
  c.system.add(std::make_shared<ChainMass>(c.block, 5, 2.0));
  c.system.add(std::make_shared<Held>(std::vector<int>{0, 2}, VecX::Zero(2), 0.0));
  c.system.prepare(c.state.view());
  const StateView at = c.state.view();
  ASSERT_TRUE(c.system.balanced(at));
  BalancedMatrix A = room_for(c.system.pattern());
  const VecX shift = VecX::LinSpaced(15, -1.0, 2.0);
  VecX f, want, product = VecX::Zero(15);
  c.system.balanced_step(at, shift, 1.0, 0.1, 0.01, f, A);
  c.system.force(at, want);
  c.system.terms()[0]->apply_tangent(at, 1.0, 0.0, shift, product);
  EXPECT_LT((f - (want - product)).norm(), 1e-12 * want.norm());
  EXPECT_EQ(A.positions, at.q.data());
  ASSERT_EQ(A.held->size(), 1u);
  EXPECT_EQ((*A.held)[0].node, 0);
  EXPECT_EQ((*A.held)[0].axes, (std::array<bool, 3>{true, false, true}));
  EXPECT_EQ(std::exp2(std::round(std::log2(A.scale))), A.scale) << "a power of two";

  BorderedMatrix whole;
  c.system.step_matrix(at, 1.0, 0.1, 0.01, whole);
  const MatX dense = whole.to_dense();
  for (int i = 0; i < 5; ++i) {
    Mat3 own = A.diagonal.segment<3>(3 * i).asDiagonal();
    for (int s = c.system.pattern().row_start()[static_cast<std::size_t>(i)]; s < c.system.pattern().row_start()[static_cast<std::size_t>(i) + 1]; ++s) {
      const int j = c.system.pattern().columns()[static_cast<std::size_t>(s)];
      if (j == i) continue;
      const Mat3 block = Eigen::Map<const Eigen::Matrix3f>(A.values.data() + 9 * A.place[static_cast<std::size_t>(s)]).cast<double>() / A.scale;
      own -= block;
      if (i == 0 || j == 0) continue;
      EXPECT_LT((block - dense.block<3, 3>(3 * i, 3 * j)).norm(), 1e-7);
    }
    if (i > 0) {
      EXPECT_LT((own - dense.block<3, 3>(3 * i, 3 * i)).norm(), 1e-6) << "node " << i;
    }
  }
}

TEST(System, AStepIsBalancedOnlyWhereEveryTermIs) {
  const auto balanced = [](auto&& change) {
    Chain c(4);
    change(c);
    c.system.set_mass_solver(std::make_unique<DenseSolver>());
    c.system.prepare(c.state.view());
    return c.system.balanced(c.state.view());
  };
  const auto lumped = [](Chain& c) { c.system.add(std::make_shared<ChainMass>(c.block, 4, 2.0)); };
  EXPECT_TRUE(balanced(lumped));
  EXPECT_FALSE(balanced([](Chain& c) { c.system.add(std::make_shared<ChainMass>(c.block, 4, 2.0, 0.5)); })) << "a consistent mass";
  EXPECT_FALSE(balanced([&](Chain& c) {
    lumped(c);
    c.system.add(std::make_shared<ChainSprings>(2, 1.0, false));
  })) << "a term that does not write it";
  EXPECT_FALSE(balanced([&](Chain& c) {
    lumped(c);
    c.system.add(std::make_shared<ChainSprings>(2, 1.0));
  })) << "two terms on one pair of nodes";
}

/// Couples one pair of nodes that changes; counts how often it is asked for it.
class Rolling final : public ForceTerm {
 public:
  std::string_view name() const override { return "rolling"; }
  TermTraits traits() const override { return {}; }
  void add_pattern(PatternBuilder& pattern) const override {
    pattern.add_pair(0, at);
    ++asked;
  }
  std::uint64_t pattern_version() const override { return version; }
  void add_force(const StateView&, VecX&) override {}
  void add_tangent(const StateView&, double, double, BorderedMatrix&) override {}
  void apply_tangent(const StateView&, double, double, const VecX&, VecX&) override {}
  int at = 2;
  std::uint64_t version = 0;
  mutable int asked = 0;
};

// Of several terms only the one whose pairs changed is asked anew, and the pattern is that of a System which never knew the old ones.
TEST(System, AsksForThePairsOfWhatChangedAlone) {
  Chain chain(8);
  const auto first = std::make_shared<Rolling>(), second = std::make_shared<Rolling>();
  chain.system.add(std::shared_ptr<ForceTerm>(first));
  chain.system.add(std::shared_ptr<ForceTerm>(second));
  second->at = 4;
  chain.system.add(std::make_shared<ChainMass>(chain.block, 8, 1.0, 0.0));
  chain.system.prepare(chain.state.view());
  BorderedMatrix A;
  chain.system.step_matrix(chain.state.view(), 1.0, 0.0, 1.0, A);
  for (int at = 5; at < 8; ++at) {
    second->at = at;
    ++second->version;
    chain.system.step_matrix(chain.state.view(), 1.0, 0.0, 1.0, A);
    PatternBuilder fresh(8);
    for (int i = 0; i + 1 < 8; ++i) fresh.add_pair(i, i + 1);
    fresh.add_pair(0, 2);
    fresh.add_pair(0, at);
    EXPECT_EQ(A.body.columns(), fresh.build().columns()) << at;
    EXPECT_EQ(A.body.row_start(), fresh.build().row_start()) << at;
  }
  EXPECT_EQ(first->asked, 1);
  EXPECT_EQ(second->asked, 4);
}
