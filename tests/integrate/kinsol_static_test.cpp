#include <gtest/gtest.h>

#include "integrate/fakes.h"

namespace palpate {
namespace {

using namespace fakes;

const IntegratorSpec kStatic{.name = "kinsol-static"};

/// A constant force on every node.
struct Push final : ForceTerm {
  VecX f0;
  explicit Push(VecX f) : f0(std::move(f)) {}
  std::string_view name() const override { return "push"; }
  TermTraits traits() const override { return {.stiff = false, .conservative = true}; }
  void add_force(const StateView&, VecX& f) override { f.head(f0.size()) += f0; }
  void add_tangent(const StateView&, double, double, BorderedMatrix&) override {}
  void apply_tangent(const StateView&, double, double, const VecX&, VecX&) override {}
};

TEST(KinsolStatic, FindsTheEquilibriumOfALinearSystem) {
  Chain chain;
  chain.start_in_mode(0.3);
  chain.state.u().setConstant(5.0);
  const VecX load = VecX::LinSpaced(12, 1.0, 2.0);
  chain.system.add(std::make_shared<Push>(load));
  chain.system.prepare(chain.state.view());
  const auto stepper = integrate::make_stepper(chain.system, chain.state, kStatic);
  const StepResult r = stepper->advance_to(1.0);
  ASSERT_TRUE(r.ok()) << r.message;
  const VecX exact = chain.term->q0 + VecX(chain.term->K.ldlt().solve(load));
  EXPECT_LT((chain.state.q() - exact).norm(), 1e-8);
  EXPECT_EQ(chain.state.u().norm(), 0.0);
  EXPECT_LE(stepper->counters().newton_iterations, 2);
  EXPECT_EQ(stepper->counters().halved_steps + stepper->counters().downhill, 0);
}

/// Snap-through: a mass on two springs at a shallow angle, V = k (sqrt(1 + x^2) - L)^2 with L > 1, loaded
/// beyond its limit load.
struct SnapThrough final : ForceTerm {
  double k = 100.0, L = 1.1, load;
  explicit SnapThrough(double p) : load(p) {}
  std::string_view name() const override { return "snap-through"; }
  TermTraits traits() const override { return {.conservative = true}; }
  double force(double x) const { return -2.0 * k * (std::hypot(1.0, x) - L) * x / std::hypot(1.0, x) - load; }
  double stiffness(double x) const {
    const double r = std::hypot(1.0, x);
    return 2.0 * k * (1.0 - L / (r * r * r));
  }
  void add_force(const StateView& s, VecX& f) override {
    f[0] += force(s.q[0]);
    f[1] -= k * s.q[1];
    f[2] -= k * s.q[2];
  }
  void add_tangent(const StateView& s, double ks, double, BorderedMatrix& A) override {
    A.body.add(A.body.slot(0, 0), ks * Vec3(stiffness(s.q[0]), k, k).asDiagonal().toDenseMatrix());
  }
  void apply_tangent(const StateView& s, double ks, double, const VecX& x, VecX& y) override {
    y.head<3>() += ks * Vec3(stiffness(s.q[0]), k, k).cwiseProduct(x.head<3>());
  }
};

TEST(KinsolStatic, SnapsThroughALimitLoad) {
  State state;
  System system;
  VecX q = VecX::Zero(3);
  q[0] = std::sqrt(1.1 * 1.1 - 1.0);  // unloaded, upper equilibrium
  const int id = state.insert(BlockSpec{.name = "arch", .q_size = 3, .u_size = 3}, q, VecX::Zero(3));
  const auto arch = std::make_shared<SnapThrough>(8.0);  // the limit load is 4.9
  system.add(std::static_pointer_cast<ForceTerm>(arch));
  system.add(std::make_shared<NodalMass>(id, MatX::Identity(3, 3)));
  system.prepare(state.view());
  const auto stepper = integrate::make_stepper(system, state, kStatic);
  const StepResult r = stepper->advance_to(1.0);
  ASSERT_TRUE(r.ok()) << r.message;
  EXPECT_LT(state.q()[0], -0.45) << "on the other side";
  EXPECT_NEAR(arch->force(state.q()[0]), 0.0, 1e-6);
  EXPECT_GT(arch->stiffness(state.q()[0]), 0.0) << "stable";
  const StepperCounters& c = stepper->counters();
  EXPECT_EQ(c.halved_steps, 1) << "the one load step";
  EXPECT_GT(c.most_halvings, 0);
  EXPECT_EQ(c.step_parts + c.downhill, c.steps);
}

/// f = -atan(x - 50): from x = 0 a full Newton correction overshoots and diverges.
struct Saturated final : ForceTerm {
  std::string_view name() const override { return "saturated"; }
  TermTraits traits() const override { return {.conservative = true}; }
  static Vec3 stiffness(double x) { return {1.0 / (1.0 + (x - 50.0) * (x - 50.0)), 1.0, 1.0}; }
  void add_force(const StateView& s, VecX& f) override {
    f.head<3>() -= Vec3(std::atan(s.q[0] - 50.0), s.q[1], s.q[2]);
  }
  void add_tangent(const StateView& s, double ks, double, BorderedMatrix& A) override {
    A.body.add(A.body.slot(0, 0), ks * stiffness(s.q[0]).asDiagonal().toDenseMatrix());
  }
  void apply_tangent(const StateView& s, double ks, double, const VecX& x, VecX& y) override {
    y.head<3>() += ks * stiffness(s.q[0]).cwiseProduct(x.head<3>());
  }
};

TEST(KinsolStatic, CountsItsStepsDownhill) {
  State state;
  System system;
  const int id =
      state.insert(BlockSpec{.name = "one", .q_size = 3, .u_size = 3}, VecX::Zero(3), VecX::Zero(3));
  system.add(std::make_shared<Saturated>());
  system.add(std::make_shared<NodalMass>(id, MatX::Identity(3, 3)));
  system.prepare(state.view());
  const auto stepper = integrate::make_stepper(system, state, kStatic);
  const StepResult r = stepper->advance_to(1.0);
  ASSERT_TRUE(r.ok()) << r.message;
  EXPECT_NEAR(state.q()[0], 50.0, 1e-6);
  const StepperCounters& c = stepper->counters();
  EXPECT_GT(c.downhill, 0) << "Newton's method alone does not get there";
  EXPECT_EQ(c.halved_steps, 1) << "the one load step";
  EXPECT_EQ(c.most_halvings, 6) << "down to the shortest rung";
  EXPECT_EQ(c.step_parts + c.downhill, c.steps);
}

TEST(KinsolStatic, SaysThatAFreeBodyHasNoEquilibrium) {
  State state;
  System system;
  const int id =
      state.insert(BlockSpec{.name = "free", .q_size = 3, .u_size = 3}, VecX::Zero(3), VecX::Zero(3));
  system.add(std::make_shared<Push>(VecX::Ones(3)));
  system.add(std::make_shared<NodalMass>(id, MatX::Identity(3, 3)));
  system.prepare(state.view());
  const auto stepper = integrate::make_stepper(system, state, kStatic);
  const StepResult r = stepper->advance_to(1.0);
  EXPECT_FALSE(r.ok());
  EXPECT_NE(r.message.find("the body is held"), std::string::npos) << r.message;
  EXPECT_EQ(state.q().norm(), 0.0) << "the last good state";
}

TEST(KinsolStatic, RefusesBadSettings) {
  Chain chain;
  IntegratorSpec s = kStatic;
  s.newton_rtol = 0.0;
  EXPECT_THROW(integrate::make_stepper(chain.system, chain.state, s), Error);
}

}  // namespace
}  // namespace palpate
