#include <gtest/gtest.h>
#include "palpate/dynamics/rigid_body.h"
#include "palpate/linear/solvers.h"

#include <complex>

#include "integrate/fakes.h"

namespace palpate {
namespace {

using namespace fakes;

/// Node 0 is driven along x by A sin(W t); node 1 follows through a spring k, a damper c and the off-diagonal
/// mass of a linear bar element. Free row: m11 a1 + m10 a0 = -k (d1 - d0) - c (v1 - v0). With d0 = Im(A
/// e^{iWt}), d1 = Im(X e^{iWt}): X (k + i W c - W^2 m11) = A (k + i W c + W^2 m10).
struct DrivenBar {
  static constexpr double kA = 0.1, kW = 5.0, kK = 100.0, kC = 3.0, kM11 = 2.0, kM10 = 1.0;
  State state;
  System system;
  std::shared_ptr<LinearTerm> term;
  std::complex<double> X;
  long asked = 0;

  DrivenBar() {
    const std::complex<double> i(0.0, 1.0);
    X = kA * (kK + i * kW * kC + kW * kW * kM10) / (kK + i * kW * kC - kW * kW * kM11);
    MatX K = kK * MatX::Identity(6, 6), D = MatX::Zero(6, 6), M = kM11 * MatX::Identity(6, 6);
    for (const auto& [a, b, sign] : {std::tuple{0, 3, -1.0}, {3, 0, -1.0}}) {
      K(a, b) = sign * kK;
      D(a, b) = sign * kC;
      M(a, b) = kM10;
    }
    D(0, 0) = D(3, 3) = kC;
    BlockSpec spec{.name = "bar", .q_size = 6, .u_size = 6, .q_scale = kA, .u_scale = kA * kW};
    VecX q0 = VecX::Zero(6);
    q0[3] = 1.0;
    const int id = state.insert(spec, q0, VecX::Zero(6));
    state.q()[3] += X.imag();
    state.u()[3] = kW * X.real();
    term = std::make_shared<LinearTerm>(K, D, q0);
    system.add(std::static_pointer_cast<ForceTerm>(term));
    system.add(std::make_shared<NodalMass>(id, M));
    system.add(std::make_shared<Scripted>(std::vector<int>{0}, [this](double t, VecX& x, VecX& v, VecX& a) {
      ++asked;
      x[0] = kA * std::sin(kW * t);
      v[0] = kA * kW * std::cos(kW * t);
      a[0] = -kA * kW * kW * std::sin(kW * t);
    }));
    system.set_mass_solver(linear::make_linear_solver("cholmod"));
    system.prepare(state.view());
    system.impose(state.layout(), 0.0, state.q().data(), state.u().data());
  }
  double response(double t) const { return 1.0 + (X * std::polar(1.0, kW * t)).imag(); }
};

class Driven : public testing::TestWithParam<std::string> {
 protected:
  int order() const { return ladder_order(GetParam()); }
};
INSTANTIATE_TEST_SUITE_P(Registry, Driven, testing::ValuesIn(stepper_modes()), registry_test_name);

TEST_P(Driven, NodesFollowExactlyAndTheRestRespondsAtTheOrder) {
  std::vector<double> values, errors;
  const Ladder l = ladder(GetParam(), std::sqrt(DrivenBar::kK / DrivenBar::kM11), 0.2);
  for (const double value : l.values) {
    DrivenBar bar;
    IntegratorSpec s = mode_spec(GetParam());
    set_accuracy(s, order(), value);
    const auto stepper = integrate::make_stepper(bar.system, bar.state, s);
    double error = 0.0;
    for (const double t : {0.2, 0.4, 0.8}) {
      const StepResult result = stepper->advance_to(t);
      ASSERT_TRUE(result.ok()) << result.message;
      EXPECT_EQ(bar.state.q()[0], DrivenBar::kA * std::sin(DrivenBar::kW * t)) << "to the last bit";
      EXPECT_EQ(bar.state.u()[0], DrivenBar::kA * DrivenBar::kW * std::cos(DrivenBar::kW * t));
      EXPECT_LT(std::abs(bar.state.q()[4]) + std::abs(bar.state.q()[1]), 1e-15);
      error = std::max(error, std::abs(bar.state.q()[3] - bar.response(t)));
      VecX q, u;
      const double inside = t - 0.3 * result.h;
      ASSERT_TRUE(stepper->dense_output(inside, q, u));
      EXPECT_EQ(q[0], DrivenBar::kA * std::sin(DrivenBar::kW * inside)) << "between steps as well";
    }
    values.push_back(value);
    errors.push_back(error);
  }
  EXPECT_GT(slope(values, errors), l.low);
  EXPECT_LT(slope(values, errors), l.high);
  EXPECT_LT(errors.back(), 1e-3 * DrivenBar::kA);
}

// The whole bar moves with its drive at constant velocity: no force arises, at any step size.
TEST_P(Driven, RigidMotionWithTheDriveFeelsNoForce) {
  const MatX K =
      (MatX(6, 6) << MatX::Identity(3, 3), -MatX::Identity(3, 3), -MatX::Identity(3, 3), MatX::Identity(3, 3))
          .finished();
  VecX q0(6);
  q0 << 0, 0, 0, 1, 0, 0;
  State state;
  System system;
  const int id = state.insert(BlockSpec{.name = "bar", .q_size = 6, .u_size = 6}, q0, VecX::Constant(6, 2.0));
  system.add(std::make_shared<LinearTerm>(1e6 * K, 1e3 * K, q0));
  system.add(std::make_shared<NodalMass>(id, MatX::Identity(6, 6)));
  system.add(std::make_shared<Scripted>(std::vector<int>{0, 1, 2}, [](double t, VecX& x, VecX& v, VecX& a) {
    x.setConstant(2.0 * t);
    v.setConstant(2.0);
    a.setZero();
  }));
  system.prepare(state.view());
  IntegratorSpec s = mode_spec(GetParam());
  // Newton's remaining error is a fraction of rtol where a factorisation is reused for another step.
  s.rtol = is_explicit(GetParam()) ? 1e-3 : 1e-8;
  s.step_s = is_explicit(GetParam()) ? 1e-4 : 0.1;  // the largest rate is 2e3
  const auto stepper = integrate::make_stepper(system, state, s);
  ASSERT_TRUE(stepper->advance_to(1.0).ok());
  const bool at_its_limit = is_explicit(GetParam()) && !steps_are_fixed(GetParam());
  // at the stability limit rounding grows to the tolerance, relative to a speed of 2
  const double bar = at_its_limit ? 2.1 * s.rtol : 1e-9;
  EXPECT_LT((state.q() - q0 - VecX::Constant(6, 2.0)).norm(), bar);
  EXPECT_LT((state.u() - VecX::Constant(6, 2.0)).norm(), bar);
}

/// A node carried by a rigid body at its centre: velocity G u_master, G = [0 I].
struct CarriedAtCentre final : DrivenMotion {
  int master;
  std::vector<int> indices{0, 1, 2};
  explicit CarriedAtCentre(int id) : master(id) {}
  const std::vector<int>& dofs() const override { return indices; }
  int master_block() const override { return master; }
  void evaluate(const StateView& s, VecX& x, VecX& v, VecX& a) const override {
    const Block& b = *s.layout->find(master);
    x = s.q.segment<3>(b.q_offset + 4);
    v = s.u.segment<3>(b.u_offset + 3);
    a.setZero();
  }
  void jacobian(const StateView&, MatX& G) const override { G << MatX::Zero(3, 3), MatX::Identity(3, 3); }
};

struct BallMass final : InertiaTerm {
  int id;
  explicit BallMass(int i) : id(i) {}
  int block_id() const override { return id; }
  bool diagonal() const override { return true; }
  void add_mass(const StateView&, double scale, BorderedMatrix& A) const override {
    A.corner += scale * MatX::Identity(6, 6);
  }
  void apply(const StateView& s, const VecX& x, VecX& y) const override {
    y.segment<6>(s.layout->find(id)->u_offset) += x.segment<6>(s.layout->find(id)->u_offset);
  }
};

// Light bone (1 kg), heavy tissue: node 0 (3 kg) is carried, node 1 (2 kg) is attached to it by k = 50. Two
// masses 4 and 2 on one spring: omega^2 = k (1/4 + 1/2). The carried node's mass and stiffness must enter the
// bone's equations; otherwise the frequency is wrong.
TEST_P(Driven, NodesCarriedByABodyLoadIt) {
  std::vector<double> values, errors;
  const int n = order();
  const Ladder l = ladder(GetParam(), std::sqrt(50.0 * 0.75), 0.8);
  for (const double value : l.values) {
    State state;
    System system;
    const double k = 50.0, w = std::sqrt(k * 0.75), T = 0.8;
    const MatX I = MatX::Identity(3, 3), K = (MatX(6, 6) << k * I, -k * I, -k * I, k * I).finished();
    MatX M = MatX::Zero(6, 6);
    M.diagonal() << 3, 3, 3, 2, 2, 2;
    VecX q = VecX::Zero(6), pose = VecX::Unit(7, 0);
    q[3] = 0.1;
    const int nodes =
        state.insert(BlockSpec{.name = "tissue", .q_size = 6, .u_size = 6, .q_scale = 0.1}, q, VecX::Zero(6));
    const int bone = state.insert(rigid_block("bone", 0.1, 1.0), pose, VecX::Zero(6));
    system.add(std::make_shared<LinearTerm>(K, 0.0 * K, VecX::Zero(6)));
    system.add(std::make_shared<NodalMass>(nodes, M));
    system.add(std::make_shared<BallMass>(bone));
    system.add(std::make_shared<CarriedAtCentre>(bone));
    system.prepare(state.view());
    IntegratorSpec s = mode_spec(GetParam());
    set_accuracy(s, n, value);
    const auto stepper = integrate::make_stepper(system, state, s);
    ASSERT_TRUE(stepper->advance_to(T).ok());
    EXPECT_EQ(state.q()[0], state.q(*state.layout().find(bone))[4]) << "the node stays where its bone is";
    const double centre = 0.1 / 3.0, apart = 0.1 * std::cos(w * T);
    values.push_back(value);
    errors.push_back(std::abs(state.q()[3] - centre - apart * 2.0 / 3.0) +
                     std::abs(state.q()[0] - centre + apart / 3.0));
  }
  EXPECT_GT(slope(values, errors), l.low);
  EXPECT_LT(slope(values, errors), l.high);
  EXPECT_LT(errors.back(), n > 0 ? 1e-3 : 1e-6);
}

TEST_P(Driven, AllNodesDriven) {
  State state;
  System system;
  const int id =
      state.insert(BlockSpec{.name = "one", .q_size = 3, .u_size = 3}, VecX::Zero(3), VecX::Zero(3));
  system.add(std::make_shared<NodalMass>(id, MatX::Identity(3, 3)));
  system.add(std::make_shared<Scripted>(std::vector<int>{0, 1, 2}, [](double t, VecX& x, VecX& v, VecX& a) {
    x.setConstant(t * t);
    v.setConstant(2.0 * t);
    a.setConstant(2.0);
  }));
  system.prepare(state.view());
  IntegratorSpec s = mode_spec(GetParam());
  s.step_s = 0.03;
  const auto stepper = integrate::make_stepper(system, state, s);
  ASSERT_TRUE(stepper->advance_to(0.5).ok());
  EXPECT_EQ(state.q()[2], 0.25);
}

}  // namespace
}  // namespace palpate
