#include <gtest/gtest.h>

#include "integrate/fakes.h"
#include "palpate/integrate/self_test.h"

namespace palpate {
namespace {

using namespace fakes;

/// A unit mass under g over a one-sided spring k that begins at x = 0: a kink, with its root function. From
/// height H at rest: free fall for sqrt(2 H / g), then x(t) = -(v/w) sin(w t) + (g/w^2)(cos(w t) - 1) until x
/// = 0 again, with the initial impact speed.
struct OneSidedSpring final : ForceTerm {
  double k, g;
  OneSidedSpring(double stiffness, double gravity) : k(stiffness), g(gravity) {}
  std::string_view name() const override { return "one-sided spring"; }
  TermTraits traits() const override { return {.conservative = true, .contact = true}; }
  void add_force(const StateView& s, VecX& f) override { f[0] += -g - k * std::min(0.0, s.q[0]); }
  void add_tangent(const StateView& s, double ks, double, BorderedMatrix& A) override {
    Mat3 K = Mat3::Zero();
    K(0, 0) = s.q[0] < 0.0 ? ks * k : 0.0;
    A.body.add(A.body.slot(0, 0), K);
  }
  void apply_tangent(const StateView& s, double ks, double, const VecX& x, VecX& y) override {
    y[0] += s.q[0] < 0.0 ? ks * k * x[0] : 0.0;
  }
  int event_count() const override { return 1; }
  void events(const StateView& s, double* out) override { out[0] = s.q[0]; }
};

struct Bouncer {
  static constexpr double kStiffness = 1e4, kGravity = 10.0, kHeight = 0.05;
  State state;
  System system;
  Bouncer() {
    VecX q = VecX::Zero(3);
    q[0] = kHeight;
    const int id = state.insert(BlockSpec{.name = "ball", .q_size = 3, .u_size = 3, .q_scale = kHeight}, q,
                                VecX::Zero(3));
    system.add(std::make_shared<OneSidedSpring>(kStiffness, kGravity));
    system.add(std::make_shared<NodalMass>(id, MatX::Identity(3, 3)));
    system.prepare(state.view());
  }
  /// Time between two highest points: the motion is periodic.
  static double period() {
    const double w = std::sqrt(kStiffness), v = std::sqrt(2.0 * kGravity * kHeight);
    const double contact = 2.0 * (M_PI - std::atan2(v * w, kGravity)) / w;  // from x = 0 down and up again
    return 2.0 * std::sqrt(2.0 * kHeight / kGravity) + contact;
  }
};

std::vector<std::string> with_roots() {
  std::vector<std::string> out;
  for (const auto& e : integrate::stepper_registry())
    if (e.traits.control != StepControl::kFixed) out.push_back(e.name);
  return out;
}
class Events : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Registry, Events, testing::ValuesIn(with_roots()), registry_test_name);

TEST_P(Events, RootFindingMeetsEveryTouchAndEveryLeave) {
  Bouncer ball;
  IntegratorSpec s{.name = GetParam(), .rtol = 1e-7, .events = KinkTreatment::kRootFinding};
  s.max_steps = 1000000;
  const auto stepper = integrate::make_stepper(ball.system, ball.state, s);
  const StepResult result = stepper->advance_to(3.0 * Bouncer::period());
  ASSERT_TRUE(result.ok()) << result.message;
  EXPECT_EQ(stepper->counters().events, 6) << "three bounces, down and up";
  EXPECT_NEAR(ball.state.q()[0], Bouncer::kHeight, 1e-4 * Bouncer::kHeight);
}

TEST_P(Events, ErrorControlGetsThereAsWell) {
  Bouncer ball;
  IntegratorSpec s{.name = GetParam(), .rtol = 1e-7};
  s.max_steps = 1000000;
  const auto stepper = integrate::make_stepper(ball.system, ball.state, s);
  const StepResult result = stepper->advance_to(3.0 * Bouncer::period());
  ASSERT_TRUE(result.ok()) << result.message;
  EXPECT_EQ(stepper->counters().events, 0);
  EXPECT_NEAR(ball.state.q()[0], Bouncer::kHeight, 1e-3 * Bouncer::kHeight);
}

struct Kept final : StepTrace {
  std::vector<StepAttempt> all;
  void attempt(const StepAttempt& a) override { all.push_back(a); }
  long count(StepAttempt::Outcome o) const {
    return std::count_if(all.begin(), all.end(), [o](const StepAttempt& a) { return a.outcome == o; });
  }
};

class Traces : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Registry, Traces, testing::ValuesIn(with_roots()), registry_test_name);

TEST_P(Traces, TellEveryAttemptAndWhyItFailed) {
  Bouncer ball;
  IntegratorSpec s{.name = GetParam(), .rtol = 1e-5};
  const auto stepper = integrate::make_stepper(ball.system, ball.state, s);
  Kept kept;
  stepper->set_trace(&kept);
  const double T = 2.0 * Bouncer::period();
  ASSERT_TRUE(stepper->advance_to(T).ok());
  const StepperCounters& c = stepper->counters();
  using O = StepAttempt::Outcome;
  EXPECT_EQ(kept.count(O::kAccepted), c.steps);
  EXPECT_EQ(kept.count(O::kErrorTest), c.error_test_failures);
  EXPECT_EQ(kept.count(O::kErrorTest) + kept.count(O::kNewton), c.rejected);
  EXPECT_GT(c.error_test_failures, 0) << "a kink fails an error test";
  double sum = 0.0;
  int estimated = 0;
  for (const StepAttempt& a : kept.all) {
    EXPECT_GT(a.h, 0.0);
    if (a.outcome != O::kAccepted) continue;
    sum += a.h;
    if (std::isnan(a.error)) continue;
    ++estimated;
    if (a.error == 0.0) continue;  // free fall is a parabola
    EXPECT_EQ(a.worst_dof, 0) << "the only one that moves";
  }
  EXPECT_NEAR(sum, T, 1e-9 * T);
  EXPECT_GT(estimated, c.steps / 2);
}

TEST_P(Traces, CostNothingWhereNobodyLooks) {
  Bouncer looked_at, alone;
  const IntegratorSpec s{.name = GetParam(), .rtol = 1e-5};
  const auto a = integrate::make_stepper(looked_at.system, looked_at.state, s),
             b = integrate::make_stepper(alone.system, alone.state, s);
  Kept kept;
  a->set_trace(&kept);
  ASSERT_TRUE(a->advance_to(0.3).ok());
  ASSERT_TRUE(b->advance_to(0.3).ok());
  EXPECT_EQ(looked_at.state.q()[0], alone.state.q()[0]) << "bit for bit";
  EXPECT_EQ(a->counters().force_evaluations, b->counters().force_evaluations);
}

// The same flag value has different meanings in each library, and again in the setup of a linear solver
// (headers of the libraries).
TEST(FlagNames, AreThoseOfTheLibraryThatWasCalled) {
  using integrate::self_test::flag_name;
  EXPECT_EQ(flag_name("CVode", -4), "CV_CONV_FAILURE");
  EXPECT_EQ(flag_name("CVodeSetMaxOrd", -22), "CV_ILL_INPUT");
  EXPECT_EQ(flag_name("CVodeSetLinearSolver", -3), "CVLS_ILL_INPUT");
  EXPECT_EQ(flag_name("CVodeSetNonlinearSolver", -3), "CV_ERR_FAILURE");
  EXPECT_EQ(flag_name("ARKStepEvolve", -3), "ARK_ERR_FAILURE");
  EXPECT_EQ(flag_name("ARKStepSetLinSysFn", -3), "ARKLS_ILL_INPUT");
  EXPECT_EQ(flag_name("MRIStepSetCoupling", -22), "ARK_ILL_INPUT");
  EXPECT_EQ(flag_name("IDASolve", -4), "IDA_CONV_FAIL");
  EXPECT_EQ(flag_name("IDASetJacFn", -3), "IDALS_ILL_INPUT");
  EXPECT_EQ(flag_name("KINSol", -4), "KIN_MEM_FAIL");
  EXPECT_EQ(flag_name("KINSetJacFn", -3), "KINLS_ILL_INPUT");
  EXPECT_EQ(flag_name("SUNContext_Create", -4), "flag -4") << "SUNDIALS' own objects name none";
  EXPECT_EQ(flag_name("CVode", -12345), "flag -12345");
}

TEST(Interrupt, EndsAtTheLastGoodStep) {
  for (const std::string& mode : stepper_modes()) {
    Chain chain;
    chain.start_in_mode(0.1);
    const auto stepper = integrate::make_stepper(chain.system, chain.state, mode_spec(mode));
    std::atomic<bool> stop{true};
    stepper->set_interrupt(&stop);
    const StepResult r = stepper->advance_to(1.0);
    EXPECT_EQ(r.status, StepStatus::kInterrupted) << mode;
    EXPECT_LT(chain.state.time(), 1.0) << mode;
    stop = false;
    EXPECT_TRUE(stepper->advance_to(1.0).ok()) << mode;
  }
}

TEST(FixedStep, ABlowUpIsCalledByItsName) {
  Chain chain(0.0, 1e4);  // highest frequency about 200/s
  chain.state.u().setOnes();
  const IntegratorSpec spec{.name = "ark-erk-4", .step_s = 1.0, .fixed_step = true};
  const auto stepper = integrate::make_stepper(chain.system, chain.state, spec);
  const StepResult r = stepper->advance_to(100.0);
  ASSERT_FALSE(r.ok());
  EXPECT_NE(r.message.find("step_s of an explicit method must be below its stability limit"),
            std::string::npos)
      << r.message;
}

// --- Many fast steps per slow step

/// A fast damper of 1e6/s: the explicit fast side needs about 4e4 steps for 0.1 s. Raises a flag at a given
/// evaluation.
struct FastDamper final : ForceTerm {
  long evaluations = 0, raise_at = -1;
  std::atomic<bool> raised{false};
  std::string_view name() const override { return "fast damper"; }
  TermTraits traits() const override { return {.stiff = false, .fast = true}; }
  void add_force(const StateView& s, VecX& f) override {
    f -= 1e6 * s.u;
    if (++evaluations == raise_at) raised = true;
  }
  void add_tangent(const StateView&, double, double, dynamics::BorderedMatrix&) override {}
  void apply_tangent(const StateView&, double, double, const VecX&, VecX&) override {}
};

TEST(MultiRate, FastStepsAreLimitedAndInterrupted) {
  for (const bool interrupt : {false, true}) {
    Chain chain;
    chain.state.u().setOnes();
    const auto fast = std::make_shared<FastDamper>();
    chain.system.add(fast);
    chain.system.prepare(chain.state.view());
    IntegratorSpec spec{.name = "ark-mri-2", .step_s = 0.1, .max_steps = 2000};
    const auto stepper = integrate::make_stepper(chain.system, chain.state, spec);
    if (interrupt) {
      fast->raise_at = 500;
      stepper->set_interrupt(&fast->raised);
    }
    const StepResult r = stepper->advance_to(0.1);
    EXPECT_EQ(r.status, interrupt ? StepStatus::kInterrupted : StepStatus::kErrorTestFailed) << r.message;
    EXPECT_EQ(chain.state.time(), 0.0);
    EXPECT_LT(fast->evaluations, interrupt ? 510 : 5 * 2000);  // rejected steps count
    EXPECT_GT(fast->evaluations, interrupt ? 499 : 2000);
  }
}

TEST(MultiRate, CountsItsFastSteps) {
  Chain chain;
  chain.state.u().setOnes();
  const auto fast = std::make_shared<FastDamper>();
  chain.system.add(fast);
  chain.system.prepare(chain.state.view());
  const auto stepper =
      integrate::make_stepper(chain.system, chain.state, {.name = "ark-mri-2", .step_s = 1e-4});
  ASSERT_TRUE(stepper->advance_to(1e-3).ok());
  EXPECT_EQ(stepper->counters().steps, 10);
  // Bogacki and Shampine's method is stable up to 2.5 rates, and needs three evaluations per step
  EXPECT_GT(stepper->counters().fast_steps, 1e-3 * 1e6 / 3.0);
  EXPECT_LT(3 * stepper->counters().fast_steps, fast->evaluations);
}

// --- Silent fallbacks

// CVODE reuses a matrix for several steps: the iterations with a reused matrix are counted, and are no more
// than all iterations.
TEST(Silent, IterationsByAKeptMatrixAreCounted) {
  for (const char* name : {"cvode-bdf", "ida", "ark-dirk-esdirk437"}) {
    Chain chain(0.02);
    chain.start_in_mode(0.1);
    const auto stepper = integrate::make_stepper(chain.system, chain.state, {.name = name, .rtol = 1e-6});
    ASSERT_TRUE(stepper->advance_to(1.0).ok());
    const StepperCounters& c = stepper->counters();
    EXPECT_GT(c.kept_matrix_iterations, 0) << name;
    EXPECT_LT(c.kept_matrix_iterations, c.newton_iterations) << name << ": the first of each matrix is not";
    EXPECT_EQ(c.definite_retries + c.leaps + c.halved_steps + c.lu + c.fast_steps, 0) << name;
  }
}

/// Reports that each of its tangents was bounded.
struct Bounded final : ForceTerm {
  long bounded = 5;
  std::string_view name() const override { return "bounded"; }
  TermTraits traits() const override { return {}; }
  void add_force(const StateView&, VecX&) override {}
  void add_tangent(const StateView&, double k, double, BorderedMatrix&) override { bounded += k != 0.0; }
  void apply_tangent(const StateView&, double, double, const VecX&, VecX&) override {}
  long clamped_tangents() const override { return bounded; }
};

TEST(Silent, BoundedTangentsAreCounted) {
  for (const char* name : {"cvode-bdf", "backward-euler", "kinsol-static"}) {
    Chain chain;
    const auto term = std::make_shared<Bounded>();
    chain.system.add(std::static_pointer_cast<ForceTerm>(term));
    chain.system.prepare(chain.state.view());
    chain.start_in_mode(0.1);
    const auto stepper = integrate::make_stepper(chain.system, chain.state, {.name = name});
    ASSERT_TRUE(stepper->advance_to(0.01).ok());
    EXPECT_GT(stepper->counters().clamped, 0) << name;
    EXPECT_EQ(stepper->counters().clamped, term->bounded - 5) << name << ": since it was made";
  }
}

}  // namespace
}  // namespace palpate
