// Amplification matrix of one multi-rate step against theory: each side alone, the order of both together,
// and the steps of the method.
#include "integrate/multirate.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "integrate/fakes.h"
#include "palpate/core/error.h"

namespace palpate {
namespace {

using namespace fakes;
using integrate::multirate_amplification;

constexpr const char* kNames[] = {"ark-mri-2", "ark-mri-3", "ark-mri-4"};

/// Matrix A of y' = A y for q'' = -k q - d q'.
MatX oscillator(double k, double d) {
  MatX A(2, 2);
  A << 0.0, 1.0, -k, -d;
  return A;
}

TEST(MultirateAmplification, OfOneSideAloneIsWhatTheoryGives) {
  const MatX none = MatX::Zero(2, 2);
  for (const char* name : kNames) {
    EXPECT_NEAR(multirate_amplification(name, none, oscillator(25.0, 2.0), 0.3), std::exp(-0.3), 1e-12)
        << "exact: exp(-d/2 H)";
    for (const double y : {0.1, 1.0, 10.0, 1e3})
      EXPECT_LE(multirate_amplification(name, oscillator(y * y, 0.0), none, 1.0), 1.0 + 1e-12)
          << "A-stable: " << name << " " << y;
  }
  for (const double y : {0.1, 1.0, 10.0, 1e3})
    EXPECT_NEAR(multirate_amplification("ark-mri-2", oscillator(y * y, 0.0), none, 1.0), 1.0, 1e-12)
        << "the trapezoidal rule";
}

// A motion with damping d has modulus exp(-d H/2); a method of order p has an error of H^(p+1).
TEST(MultirateAmplification, ComesToTheExactOneWithTheMethodsOrder) {
  constexpr double kDamping = 0.6;
  MatX slow = oscillator(4.0, kDamping), fast = MatX::Zero(2, 2);
  fast(1, 0) = -9.0;
  for (int p = 2; p <= 4; ++p) {
    const auto off = [&](double H) {
      return std::abs(multirate_amplification(kNames[p - 2], slow, fast, H) - std::exp(-0.5 * kDamping * H));
    };
    EXPECT_NEAR(std::log2(off(0.05) / off(0.025)), p + 1.0, 0.15) << p;
  }
}

/// A spring from each node to its rest position, on the fast side.
struct FastSpring final : ForceTerm {
  double k;
  VecX rest;
  FastSpring(double stiffness, VecX q0) : k(stiffness), rest(std::move(q0)) {}
  std::string_view name() const override { return "fast spring"; }
  TermTraits traits() const override { return {.stiff = false, .fast = true}; }
  void add_force(const StateView& s, VecX& f) override { f -= k * (s.q - rest); }
  void add_tangent(const StateView&, double, double, BorderedMatrix&) override {}
  void apply_tangent(const StateView&, double, double, const VecX&, VecX&) override {}
};

// One mode with two springs, each stable alone: a step from a displacement and one from a velocity are the
// columns of the step's matrix.
TEST(MultirateAmplification, IsThatOfTheStepsThatAreTaken) {
  constexpr double kFast = 300.0, kStep = 0.15, kSmall = 1e-3;
  int unstable = 0;
  for (const char* name : kNames) {
    MatX step(2, 2), fast = MatX::Zero(2, 2);
    fast(1, 0) = -kFast;
    double omega = 0.0;
    for (int column = 0; column < 2; ++column) {
      Chain chain;
      omega = chain.omega();
      chain.system.add(std::make_shared<FastSpring>(kFast, chain.term->q0));
      chain.system.prepare(chain.state.view());
      const VecX mode = chain.mode() / chain.mode().norm();
      (column == 0 ? chain.state.q() : chain.state.u()) += kSmall * mode;
      const auto stepper =
          integrate::make_stepper(chain.system, chain.state, {.name = name, .step_s = kStep});
      const StepResult result = stepper->advance_to(kStep);
      ASSERT_TRUE(result.ok()) << result.message;
      ASSERT_EQ(stepper->counters().steps, 1);
      step(0, column) = mode.dot(chain.state.q() - chain.term->q0) / kSmall;
      step(1, column) = mode.dot(chain.state.u()) / kSmall;
    }
    const double rho = multirate_amplification(name, oscillator(omega * omega, 0.0), fast, kStep);
    EXPECT_NEAR(step.eigenvalues().cwiseAbs().maxCoeff(), rho, 1e-6 * rho) << name;
    unstable += rho > 1.01;
  }
  EXPECT_GE(unstable, 2) << "stable alone, not together";
}

TEST(MultirateAmplification, RefusesWhatItCannotUse) {
  const MatX two = MatX::Zero(2, 2), three = MatX::Zero(3, 3);
  EXPECT_THROW(multirate_amplification("rk4", two, two, 0.1), Error);
  EXPECT_THROW(multirate_amplification("ark-mri-2", two, three, 0.1), Error);
}

}  // namespace
}  // namespace palpate
