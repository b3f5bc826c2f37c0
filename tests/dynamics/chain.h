#pragma once
// Chains of nodes with springs, masses, held and carried nodes: the smallest systems with all parts that a
// System assembles.
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "palpate/core/pose.h"
#include "palpate/dynamics/step_assembly.h"
#include "palpate/dynamics/system.h"

namespace palpate::dynamics {

/// Springs along a chain of nodes, linear in all three directions: f_i = k (x_{i+1} - x_i - L) and its
/// opposite.
class ChainSprings : public ForceTerm, public FusedStepTerm {
 public:
  ChainSprings(int nodes, double k, bool fuses = true) : nodes_(nodes), k_(k), fuses_(fuses) {}
  std::uint64_t version = 0;  ///< step_version()
  int assembled = 0;          ///< number of add_step() calls
  double drag = 0.0;          ///< mass-proportional damping, applied in add_step() only [kg/s]
  std::string_view name() const override { return "springs"; }
  TermTraits traits() const override { return {}; }
  bool fuses_step() const override { return fuses_; }
  std::uint64_t step_version() const override { return version; }
  void add_step(const StateView& s, const VecX& shift, double k_scale, double d_scale, VecX& f,
                ZeroRowSumMatrix& A) override {
    ++assembled;
    add_step_force(s, shift, shift, f);
    A.diagonal.array() += d_scale * drag;
    for (int i = 0; i + 1 < nodes_; ++i)
      Eigen::Map<Eigen::Matrix3f>(A.values.data() +
                                  9 * A.slot_map[static_cast<std::size_t>(A.pattern->slot(i, i + 1))]) =
          static_cast<float>(-A.scale * k_scale * k_) * Eigen::Matrix3f::Identity();
  }
  void add_step_force(const StateView& s, const VecX& shift, const VecX&, VecX& f) override {
    add_force(s, f);
    VecX product = VecX::Zero(f.size());
    apply_tangent(s, 1.0, 0.0, shift, product);
    f -= product;
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
        for (int b : {i, i + 1})
          A.body.add(A.body.slot(a, b), (a == b ? k_scale : -k_scale) * k_ * Mat3::Identity());
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
  bool fuses_;
};

/// Mass m on every node; with `coupling` > 0 neighbours share inertia (consistent mass).
class ChainMass final : public InertiaTerm {
 public:
  ChainMass(int block, int nodes, double m, double coupling = 0.0)
      : block_(block), nodes_(nodes), m_(m), c_(coupling) {}
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

/// A rigid body of mass M and isotropic inertia I, without coupling to nodes.
class BoneMass final : public InertiaTerm {
 public:
  BoneMass(int block, double mass, double inertia) : block_(block), mass_(mass), inertia_(inertia) {}
  int block_id() const override { return block_; }
  bool diagonal() const override { return false; }
  void add_mass(const StateView&, double scale, BorderedMatrix& A) const override {
    A.corner.diagonal() += scale * diagonal_entries();
  }
  void apply(const StateView& s, const VecX& x, VecX& y) const override {
    y.tail<6>() += diagonal_entries().cwiseProduct(x.segment<6>(s.layout->nodal_size));
  }

 private:
  Vec6 diagonal_entries() const {
    return (Vec6() << inertia_, inertia_, inertia_, mass_, mass_, mass_).finished();
  }
  int block_;
  double mass_, inertia_;
};

/// Nodes that are held, or moved with x = x0 + 1/2 a t^2.
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

/// One node carried by a rigid body, x = p + R c.
class OnBone final : public DrivenMotion {
 public:
  OnBone(int node, int bone, const Vec3& c)
      : dofs_{3 * node, 3 * node + 1, 3 * node + 2}, bone_(bone), c_(c) {}
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

/// A second linear solver for the tests: dense LU.
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

}  // namespace palpate::dynamics
