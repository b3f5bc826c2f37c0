#include <gtest/gtest.h>

#include "integrate/fixed_steppers.h"

namespace palpate {
namespace {

using namespace fakes;
using namespace hand_steppers;

// --- Orders in special circumstances

/// Error at 1.2 s of the oscillator, with outputs at uneven times, so that adjacent intervals have different
/// steps.
double uneven_error(const IntegratorSpec& s, bool reinit) {
  Oscillator o(3.0, 0.1);
  const auto stepper = integrate::make_stepper(o.system, o.state, s);
  const double g = 0.3, v = std::sqrt(9.0 - g * g);
  for (int k = 0; o.state.time() < 1.2 - 1e-9; ++k) {
    const double next = o.state.time() + s.step_s * (k % 3 == 0 ? 3.5 : k % 3 == 1 ? 0.4 : 2.1);
    EXPECT_TRUE(stepper->advance_to(std::min(next, 1.2)).ok());
    if (reinit && k % 2 == 1) stepper->reinit(ReinitReason::kContactRefreshed);
  }
  return std::abs(o.state.q()[0] -
                  0.3 * std::exp(-g * 1.2) * (std::cos(v * 1.2) + g / v * std::sin(v * 1.2)));
}

TEST(HandSteppers, KeepTheirOrderOverUnevenStepsAndRestarts) {
  for (const std::string& name : kHand)
    for (const bool reinit : {false, true}) {
      const int order = ladder_order(name);
      std::vector<double> steps = order == 4 ? std::vector<double>{0.08, 0.04, 0.02, 0.01}
                                             : std::vector<double>{0.01, 0.005, 0.0025, 0.00125},
                          errors;
      for (const double h : steps) errors.push_back(uneven_error(spec_of(name, h), reinit));
      EXPECT_NEAR(slope(steps, errors), order, 0.2) << name << (reinit ? ", restarted" : "");
    }
}

/// f = -k (q - g) - c (u - g') + g'' with g = sin t: the exact motion from (g, g') is g, however stiff k and
/// c (Prothero and Robinson 1974).
struct Smooth final : ForceTerm {
  double k, c;
  Smooth(double stiffness, double damping) : k(stiffness), c(damping) {}
  std::string_view name() const override { return "smooth"; }
  TermTraits traits() const override { return {}; }
  void add_force(const StateView& s, VecX& f) override {
    f.array() +=
        -k * (s.q.array() - std::sin(s.time)) - c * (s.u.array() - std::cos(s.time)) - std::sin(s.time);
  }
  void add_tangent(const StateView&, double a, double b, BorderedMatrix& A) override {
    A.body.add(0, (a * k + b * c) * Mat3::Identity());
  }
  void apply_tangent(const StateView&, double a, double b, const VecX& x, VecX& y) override {
    y += (a * k + b * c) * x;
  }
};

TEST(HandSteppers, HaveTheirStiffOrder) {
  for (const std::string& name : kNewton) {
    const int order = find(integrate::stepper_registry(), name, "integrator").traits.stiff_order;
    std::vector<double> steps, errors;
    for (const double h : {0.08, 0.04, 0.02, 0.01}) {
      State state;
      System system;
      const int id =
          state.insert(BlockSpec{.name = "one", .q_size = 3, .u_size = 3}, VecX::Zero(3), VecX::Ones(3));
      system.add(std::make_shared<Smooth>(1e6, 1e6));  // fast rate 1e6, h x rate >= 1e4; slow rate 1
      system.add(std::make_shared<NodalMass>(id, MatX::Identity(3, 3)));
      system.prepare(state.view());
      IntegratorSpec s = spec_of(name, h);
      s.newton_rtol = 1e-13;
      const auto stepper = integrate::make_stepper(system, state, s);
      double worst = 0.0;
      for (int n = 1; n <= 10; ++n) {
        ASSERT_TRUE(stepper->advance_to(0.16 * n).ok());
        worst = std::max(worst, std::abs(state.u()[0] - std::cos(0.16 * n)));
      }
      steps.push_back(h);
      errors.push_back(worst);
    }
    EXPECT_NEAR(slope(steps, errors), order, 0.15) << name << ", finest " << errors.back();
  }
}

TEST(HandSteppers, InterpolateAtTheirOrder) {
  for (const std::string& name : kHand) {
    const int order = ladder_order(name);
    std::vector<double> steps = order == 4 ? std::vector<double>{0.08, 0.04, 0.02, 0.01}
                                           : std::vector<double>{0.008, 0.004, 0.002, 0.001},
                        q_errors, u_errors;
    for (const double h : steps) {
      Oscillator o(3.0, 0.0);
      const auto stepper = integrate::make_stepper(o.system, o.state, spec_of(name, h));
      ASSERT_TRUE(stepper->advance_to(0.8).ok());
      VecX q, u;
      double q_error = 0.0, u_error = 0.0;
      for (const double part : {0.21, 0.5, 0.83}) {
        const double t = 0.8 - part * h;
        ASSERT_TRUE(stepper->dense_output(t, q, u));
        q_error = std::max(q_error, std::abs(q[0] - 0.3 * std::cos(3.0 * t)));
        u_error = std::max(u_error, std::abs(u[0] + 0.9 * std::sin(3.0 * t)));
      }
      q_errors.push_back(q_error);
      u_errors.push_back(u_error);
    }
    EXPECT_GT(slope(steps, q_errors), order - 0.2) << name;
    EXPECT_GT(slope(steps, u_errors), order - 0.2) << name;
  }
}

// --- Newton

TEST(HandSteppers, TakeOneFactorForALinearStepAndOneForManyWhereItIsKept) {
  for (const std::string& name : kNewton) {
    Chain full, kept;
    full.start_in_mode(0.1);
    kept.start_in_mode(0.1);
    IntegratorSpec s = spec_of(name, 1e-2);
    const auto a = integrate::make_stepper(full.system, full.state, s);
    s.factor_kept_steps = 10;
    const auto b = integrate::make_stepper(kept.system, kept.state, s);
    ASSERT_TRUE(a->advance_to(1.0).ok());
    ASSERT_TRUE(b->advance_to(1.0).ok());
    EXPECT_LT((full.state.q() - kept.state.q()).norm(), 1e-13);
    const long starts = name == "bdf2" ? 1 : 0;  // the first step has two stages
    EXPECT_EQ(a->counters().solver.factorisations, 100 + starts);
    EXPECT_EQ(b->counters().solver.factorisations, 10 + starts);
    EXPECT_EQ(b->counters().newton_failures, 0);
  }
}

/// A spring whose tangent is wrong: `share` of the true one.
struct Liar final : ForceTerm {
  double k, share;
  Liar(double stiffness, double told) : k(stiffness), share(told) {}
  std::string_view name() const override { return "liar"; }
  TermTraits traits() const override { return {}; }
  void add_force(const StateView& s, VecX& f) override { f -= k * s.q; }
  void add_tangent(const StateView&, double a, double, BorderedMatrix& A) override {
    A.body.add(0, a * share * k * Mat3::Identity());
  }
  void apply_tangent(const StateView&, double a, double, const VecX& x, VecX& y) override {
    y += a * share * k * x;
  }
  Diagnostic inspect(const StateView&) const override { return {7, -0.5}; }
};

struct Lied {
  State state;
  System system;
  Lied(double k, double share) {
    const int id = state.insert(BlockSpec{.name = "one", .q_size = 3, .u_size = 3}, VecX::Constant(3, 0.1),
                                VecX::Zero(3));
    system.add(std::make_shared<Liar>(k, share));
    system.add(std::make_shared<NodalMass>(id, MatX::Identity(3, 3)));
    system.prepare(state.view());
  }
};

struct Kept final : StepTrace {
  std::vector<StepAttempt> attempts;
  void attempt(const StepAttempt& a) override { attempts.push_back(a); }
};

// Newton's iteration matrix is 1 - lambda R, with R = 1 + W^2 if the tangent has no stiffness: with lambda >=
// 1/64 it contracts while R < 128.
TEST(HandSteppers, GiveUpOnANewtonThatCannotConverge) {
  for (const std::string& name : kNewton) {
    Lied lied(1e8, 0.0);
    Kept kept;
    const auto stepper = integrate::make_stepper(lied.system, lied.state, spec_of(name, 1.0));
    stepper->set_trace(&kept);
    const StepResult result = stepper->advance_to(1.0);
    EXPECT_EQ(result.status, StepStatus::kNewtonFailed);
    EXPECT_NE(result.message.find(name + ": Newton"), std::string::npos) << result.message;
    EXPECT_NE(result.message.find("even with the step reduced to h/64 (t = 0, h = 0.015625)"),
              std::string::npos)
        << result.message;
    EXPECT_EQ(lied.state.time(), 0.0);
    EXPECT_EQ(lied.state.q()[0], 0.1) << "the last good state";
    EXPECT_EQ(stepper->counters().rejected, 7);
    EXPECT_EQ(stepper->counters().newton_failures, 7);
    ASSERT_EQ(kept.attempts.size(), 7u);
    EXPECT_EQ(kept.attempts[2].h, 0.25);
    EXPECT_EQ(kept.attempts[2].outcome, StepAttempt::Outcome::kNewton);
    EXPECT_TRUE(std::isnan(kept.attempts[2].error));
    EXPECT_EQ(kept.attempts[2].inverted_element, 7);
    EXPECT_EQ(kept.attempts[2].inverted_in, "liar");
    for (int k = 0; k < 7; ++k) EXPECT_EQ(kept.attempts[static_cast<std::size_t>(k)].halvings, k);
    EXPECT_EQ(stepper->counters().definite_retries, 7);
    EXPECT_EQ(stepper->counters().halved_steps, 1);
    EXPECT_EQ(stepper->counters().step_parts, 0);
    EXPECT_EQ(stepper->counters().most_halvings, 6);
  }
}

TEST(BackwardEuler, CoversAStepThatNewtonFailsAtInParts) {
  Lied lied(1e5, 0.0), honest(1e5, 1.0);  // W^2 = 1e5 at h, 98 at h/32
  const auto stepper = integrate::make_stepper(lied.system, lied.state, spec_of("backward-euler", 1.0));
  const StepResult result = stepper->advance_to(1.0);
  ASSERT_TRUE(result.ok()) << result.message;
  EXPECT_EQ(stepper->counters().rejected, 5);
  EXPECT_EQ(stepper->counters().steps, 32);
  EXPECT_EQ(stepper->counters().halved_steps, 1);
  EXPECT_EQ(stepper->counters().step_parts, 32);
  EXPECT_EQ(stepper->counters().most_halvings, 5);
  EXPECT_GE(stepper->counters().definite_retries, 5) << "each failed attempt, and parts that needed it";
  EXPECT_EQ(lied.state.time(), 1.0);
  EXPECT_EQ(result.h, 1.0 / 32);
  ASSERT_TRUE(integrate::make_stepper(honest.system, honest.state, spec_of("backward-euler", 1.0 / 32))
                  ->advance_to(1.0)
                  .ok());
  EXPECT_NEAR(lied.state.u()[0], honest.state.u()[0], 1e-8)
      << "the equation is the same, whatever the matrix";
}

TEST(HandSteppers, TraceEveryStep) {
  for (const std::string& name : kHand) {
    Chain chain;
    chain.start_in_mode(0.1);
    Kept kept;
    const auto stepper = integrate::make_stepper(chain.system, chain.state, spec_of(name, 0.01));
    stepper->set_trace(&kept);
    ASSERT_TRUE(stepper->advance_to(0.1).ok());
    ASSERT_EQ(kept.attempts.size(), 10u);
    EXPECT_NEAR(kept.attempts[4].t, 0.04, 1e-15);
    EXPECT_NEAR(kept.attempts[4].h, 0.01, 1e-15);
    EXPECT_EQ(kept.attempts[4].order, ladder_order(name));
    EXPECT_EQ(kept.attempts[4].outcome, StepAttempt::Outcome::kAccepted);
    EXPECT_EQ(kept.attempts[4].newton_iterations > 0, !is_explicit(name));
    EXPECT_EQ(kept.attempts[4].inverted_element, -1);
    EXPECT_EQ(kept.attempts[4].halvings, 0);
    const StepperCounters& c = stepper->counters();
    EXPECT_EQ(c.halved_steps + c.step_parts + c.most_halvings + c.definite_retries + c.leaps, 0) << name;
  }
}

TEST(HandSteppers, StopWhenInterrupted) {
  for (const std::string& name : kHand) {
    Chain chain;
    chain.start_in_mode(0.1);
    std::atomic<bool> stop = true;
    const auto stepper = integrate::make_stepper(chain.system, chain.state, spec_of(name, 0.01));
    stepper->set_interrupt(&stop);
    const StepResult result = stepper->advance_to(0.1);
    EXPECT_EQ(result.status, StepStatus::kInterrupted);
    EXPECT_NE(result.message.find(name + ": interrupted (t = 0.01"), std::string::npos) << result.message;
    EXPECT_NEAR(chain.state.time(), 0.01, 1e-15);
    stop = false;
    EXPECT_TRUE(stepper->advance_to(0.1).ok());
  }
}

TEST(HandSteppers, CutAnIntervalIntoEqualSteps) {
  Chain chain;
  chain.start_in_mode(0.1);
  const auto stepper = integrate::make_stepper(chain.system, chain.state, spec_of("backward-euler", 0.02));
  EXPECT_NEAR(stepper->advance_to(0.05).h, 0.05 / 3, 1e-15);
  EXPECT_EQ(stepper->counters().steps, 3);
  EXPECT_NEAR(stepper->advance_to(0.09).h, 0.02, 1e-12) << "two whole ones";
  EXPECT_EQ(stepper->counters().steps, 5);
}

TEST(HandSteppers, IgnoreFixedStepForTheyKnowNoOther) {
  for (const std::string& name : kHand) {
    Chain a, b;
    a.start_in_mode(0.1);
    b.start_in_mode(0.1);
    IntegratorSpec s = spec_of(name, 0.01);
    const VecX q = run(a.system, a.state, s, 0.3);
    s.fixed_step = true;
    EXPECT_EQ((run(b.system, b.state, s, 0.3) - q).cwiseAbs().maxCoeff(), 0.0);
  }
}

TEST(HandSteppers, RefuseBadNewtonSettings) {
  const auto message = [](const std::string& name, auto change) -> std::string {
    Chain chain;
    IntegratorSpec s = spec_of(name, 0.01);
    change(s);
    try {
      integrate::make_stepper(chain.system, chain.state, s);
    } catch (const Error& e) { return e.what(); }
    return "";
  };
  using S = IntegratorSpec;
  for (const std::string& name : kNewton) {
    const std::string who = "integrator \"" + name + "\": ";
    EXPECT_EQ(message(name, [](S& s) { s.factor_kept_steps = 0; }),
              who + "factor_kept_steps = 0 must be at least 1; 1 is full Newton");
    EXPECT_EQ(message(name, [](S& s) { s.newton_rtol = 0.0; }),
              who + "newton_rtol = 0 must lie in [1e-14, 0.1]; 1e-8 is usual");
    EXPECT_EQ(message(name, [](S& s) { s.newton_rtol = std::nan(""); }),
              who + "newton_rtol = nan must lie in [1e-14, 0.1]; 1e-8 is usual");
    EXPECT_EQ(message(name, [](S& s) { s.atol_q = 0.0; }),
              who + "atol_q = 0 must be positive; 0.01 is usual");
    EXPECT_EQ(message(name, [](S&) {}), "");
  }
  for (const double bad : {1.5, -0.1, std::nan("")})
    EXPECT_NE(
        message("generalized-alpha", [&](S& s) { s.spectral_radius = bad; })
            .find("must lie in [0, 1]; 0 removes unresolved frequencies in one step, 1 does not damp them"),
        std::string::npos);
  EXPECT_EQ(message("newmark", [](S& s) { s.spectral_radius = 1.5; }), "") << "not its setting";
}

}  // namespace
}  // namespace palpate
