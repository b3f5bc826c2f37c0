#include <gtest/gtest.h>

#include "core/counters.h"
#include "integrate/steppers.h"

namespace palpate {
namespace {

using namespace fakes;

INSTANTIATE_TEST_SUITE_P(Registry, Steppers, testing::ValuesIn(stepper_modes()), registry_test_name);

/// Modes of the registry for which `applies` holds.
template <class Applies>
std::vector<std::string> modes_where(Applies applies) {
  std::vector<std::string> out = stepper_modes();
  std::erase_if(out, [&](const std::string& mode) { return !applies(mode); });
  return out;
}

/// Methods whose accuracy is determined by a step.
class FixedSteppers : public Steppers {};
INSTANTIATE_TEST_SUITE_P(Registry, FixedSteppers, testing::ValuesIn(modes_where(steps_are_fixed)),
                         registry_test_name);

/// Methods whose accuracy is determined by a tolerance.
class AdaptiveSteppers : public Steppers {};
INSTANTIATE_TEST_SUITE_P(Registry, AdaptiveSteppers,
                         testing::ValuesIn(modes_where([](const auto& m) { return !steps_are_fixed(m); })),
                         registry_test_name);

/// Methods that factor a tangent.
class ImplicitSteppers : public Steppers {};
INSTANTIATE_TEST_SUITE_P(Registry, ImplicitSteppers,
                         testing::ValuesIn(modes_where([](const auto& m) { return !is_explicit(m); })),
                         registry_test_name);

TEST_P(Steppers, LandExactly) {
  Chain chain;
  chain.start_in_mode(0.1);
  const auto stepper = integrate::make_stepper(chain.system, chain.state, spec());
  EXPECT_EQ(stepper->name(), spec().name);
  for (const double t : {0.1, 0.25, 1.0 / 3.0, 0.3334, 0.5}) {
    const StepResult result = stepper->advance_to(t);
    ASSERT_TRUE(result.ok()) << result.message;
    EXPECT_EQ(chain.state.time(), t);
    EXPECT_EQ(result.t, t);
    EXPECT_GT(result.h, 0.0);
    EXPECT_GE(result.order, 1);
  }
  EXPECT_THROW(stepper->advance_to(0.5), InternalError) << "no way back";
}

TEST_P(FixedSteppers, ConvergeToTheModeAtTheirOrder) {
  std::vector<double> values, errors;
  const Ladder l = ladder(GetParam(), Chain().omega(), 0.5);
  const double amplitude = 10.0;  // far above the rounding of rest positions
  for (const double value : l.values) {
    Chain chain;
    chain.start_in_mode(amplitude);
    IntegratorSpec s = spec();
    set_accuracy(s, order(), value);
    const VecX q = run(chain.system, chain.state, s, 0.5);
    const VecX exact = chain.term->q0 + amplitude * std::cos(0.5 * chain.omega()) * chain.mode();
    values.push_back(value);
    errors.push_back((q - exact).norm() / amplitude);
  }
  EXPECT_GT(slope(values, errors), l.low) << errors.front() << " to " << errors.back();
  EXPECT_LT(slope(values, errors), l.high) << errors.front() << " to " << errors.back();
  EXPECT_LT(errors.back(), 2e-4);
}

/// Error of the mode after two periods in the energy norm, sqrt((w dq)^2 + du^2) / w: it combines amplitude
/// and phase, so that no zero of the one hides the other. There is a single output, so that the method
/// chooses its steps.
double error_after_two_periods(const IntegratorSpec& spec) {
  Chain chain;
  chain.start_in_mode(0.1);
  const double w = chain.omega(), t = 4.0 * M_PI / w;
  const auto stepper = integrate::make_stepper(chain.system, chain.state, spec);
  if (const StepResult r = stepper->advance_to(t); !r.ok()) fail("{}", r.message);
  const double dq = (chain.state.q() - chain.term->q0 - 0.1 * chain.mode()).norm();
  return std::hypot(dq, chain.state.u().norm() / w);
}

// Error control is effective if a tenth of the tolerance gives a tenth of the error.
TEST_P(AdaptiveSteppers, FollowTheirToleranceOverTwoPeriods) {
  std::vector<double> tolerances, errors;
  for (int k = 3; k <= 8; ++k) {
    IntegratorSpec s = spec();
    s.rtol = std::pow(10.0, -k);
    s.max_steps = 10000000;
    tolerances.push_back(s.rtol);
    errors.push_back(error_after_two_periods(s));
  }
  const double observed = slope(tolerances, errors);
  RecordProperty("slope", std::to_string(observed));
  std::string text;
  for (double e : errors) text += fmt::format(" {:.1e}", e);
  EXPECT_GT(observed, 0.8) << text;
  EXPECT_LT(observed, 1.2) << text;
}

TEST_P(Steppers, LoseEnergyToDamping) {
  Chain chain(0.02);
  chain.start_in_mode(0.1);
  const auto stepper = integrate::make_stepper(chain.system, chain.state, spec());
  double before = chain.system.potential_energy(chain.state.view());
  for (int i = 1; i <= 20; ++i) {
    ASSERT_TRUE(stepper->advance_to(0.1 * i).ok());
    const double now =
        chain.system.potential_energy(chain.state.view()) + chain.system.kinetic_energy(chain.state.view());
    EXPECT_LT(now, before);
    before = now;
  }
}

TEST_P(Steppers, StayAtRest) {
  Chain chain;
  const VecX rest = chain.state.q();
  const auto stepper = integrate::make_stepper(chain.system, chain.state, spec());
  ASSERT_TRUE(stepper->advance_to(10.0).ok());
  EXPECT_EQ((chain.state.q() - rest).cwiseAbs().maxCoeff(), 0.0);
}

// In later steps the data that an interpolant reuses from the preceding step are tested as well.
TEST_P(Steppers, InterpolateWithinLaterSteps) {
  Chain chain;
  chain.start_in_mode(0.1);
  const auto stepper = integrate::make_stepper(chain.system, chain.state, spec());
  VecX q, u;
  const auto error = [&](double at, const VecX& x) {
    return (x - chain.term->q0 - 0.1 * std::cos(at * chain.omega()) * chain.mode()).norm();
  };
  double before = 0.0;
  for (int i = 1; i <= 8; ++i) {
    const double end = 0.4 * i;
    const StepResult result = stepper->advance_to(end);
    ASSERT_TRUE(result.ok());
    const double t = end - 0.5 * result.h, now = error(end, chain.state.q());
    ASSERT_TRUE(stepper->dense_output(t, q, u));
    EXPECT_LT(error(t, q), std::max(1e-3 * 0.1, 1.1 * std::max(before, now))) << t;
    before = now;
  }
}

TEST_P(Steppers, InterpolateWithinTheLastStep) {
  Chain chain;
  chain.start_in_mode(0.1);
  const auto stepper = integrate::make_stepper(chain.system, chain.state, spec());
  VecX q, u;
  EXPECT_FALSE(stepper->dense_output(0.0, q, u)) << "no step yet";
  const StepResult result = stepper->advance_to(0.4);
  ASSERT_TRUE(result.ok());
  ASSERT_TRUE(stepper->dense_output(0.4, q, u));
  EXPECT_LT((q - chain.state.q()).norm() + (u - chain.state.u()).norm(), 1e-14);
  const double t = 0.4 - 0.5 * result.h;
  ASSERT_TRUE(stepper->dense_output(t, q, u));
  const auto error = [&](double at, const VecX& x) {
    return (x - chain.term->q0 - 0.1 * std::cos(at * chain.omega()) * chain.mode()).norm();
  };
  EXPECT_LT(error(t, q), std::max(1e-3 * 0.1, 1.1 * error(0.4, chain.state.q())))
      << "no worse than the step's end";
  EXPECT_FALSE(stepper->dense_output(0.4 - 2.0 * result.h, q, u));
  EXPECT_FALSE(stepper->dense_output(0.5, q, u));
  stepper->reinit(ReinitReason::kStateChanged);
  EXPECT_FALSE(stepper->dense_output(0.4, q, u)) << "history is forgotten";
}

TEST_P(Steppers, StartAnewAfterReinit) {
  Chain chain, fresh;
  chain.start_in_mode(0.1);
  const auto stepper = integrate::make_stepper(chain.system, chain.state, spec());
  ASSERT_TRUE(stepper->advance_to(0.3).ok());
  chain.state.q().setConstant(0.5);
  chain.state.u().setZero();
  stepper->reinit(ReinitReason::kStateChanged);
  ASSERT_TRUE(stepper->advance_to(0.6).ok());
  fresh.state.q().setConstant(0.5);
  fresh.state.set_time(0.3);
  // an iterative solver starts from previous solutions
  const double tolerance = integrate::linear_solver_of(spec()) == "auto" ? spec().linear_rtol : 1e-12;
  EXPECT_LT((run(fresh.system, fresh.state, spec(), 0.6) - chain.state.q()).norm(), tolerance);
  EXPECT_EQ(stepper->counters().reinits, 1);
}

// A changed contact set costs a multistep method its history; a one-step method continues with its current
// step size.
TEST_P(Steppers, PayForARestartOnlyIfTheyHaveAHistory) {
  // Sum over three tolerances: the length of the step that is shortened at an output is accidental, and the
  // next steps grow from it.
  const auto steps_with = [this](int restarts) {
    long steps = 0;
    for (const double rtol : {1e-4, 1e-5, 1e-6}) {
      Chain chain;
      chain.start_in_mode(0.1);
      IntegratorSpec s = spec();
      if (!steps_are_fixed(GetParam())) s.rtol = rtol;
      const auto stepper = integrate::make_stepper(chain.system, chain.state, s);
      for (int i = 1; i <= 20; ++i) {
        EXPECT_TRUE(stepper->advance_to(0.1 * i).ok());
        if (restarts > 0) stepper->reinit(ReinitReason::kContactRefreshed);
      }
      steps += stepper->counters().steps;
      if (steps_are_fixed(GetParam())) break;
    }
    return steps;
  };
  const double ratio = static_cast<double>(steps_with(20)) / static_cast<double>(steps_with(0));
  if (mode_traits(GetParam()).multistep && !steps_are_fixed(GetParam()))
    EXPECT_GT(ratio, 1.2);
  else
    EXPECT_NEAR(ratio, 1.0, 0.15);
}

// A step that is shortened by an output, or halved into two equal ones before it, is no reason to halve the
// next step.
TEST_P(Steppers, HalveNoStepTwiceInARow) {
  if (steps_are_fixed(GetParam())) GTEST_SKIP() << "steps are fixed";
  struct Lengths final : StepTrace {
    std::vector<double> all;
    void attempt(const StepAttempt& a) override { all.push_back(a.h); }
  } lengths;
  for (const double rtol : {1e-4, 1e-5, 1e-6}) {
    Chain chain;
    chain.start_in_mode(0.1);
    IntegratorSpec s = spec();
    s.rtol = rtol;
    const auto stepper = integrate::make_stepper(chain.system, chain.state, s);
    stepper->set_trace(&lengths);
    for (int i = 1; i <= 20; ++i) ASSERT_TRUE(stepper->advance_to(0.1 * i).ok());
  }
  const auto halved = [&](std::size_t i) {
    return std::abs(lengths.all[i + 1] / lengths.all[i] - 0.5) < 1e-9;
  };
  int twice = 0;
  for (std::size_t i = 0; i + 2 < lengths.all.size(); ++i) twice += halved(i) && halved(i + 1);
  EXPECT_EQ(twice, 0) << "of " << lengths.all.size() << " steps";
}

TEST_P(Steppers, FollowALayoutThatGrows) {
  Chain chain;
  chain.start_in_mode(0.1);
  const auto stepper = integrate::make_stepper(chain.system, chain.state, spec());
  ASSERT_TRUE(stepper->advance_to(0.25).ok());
  BlockSpec more{.name = "more", .q_size = 3, .u_size = 3};
  const int id = chain.state.insert(more, VecX::Zero(3), VecX::Ones(3));  // moves freely
  struct PointMass final : InertiaTerm {
    int id;
    explicit PointMass(int i) : id(i) {}
    int block_id() const override { return id; }
    bool diagonal() const override { return true; }
    void add_mass(const StateView& s, double scale, BorderedMatrix& A) const override {
      const int node = s.layout->find(id)->u_offset / 3;
      A.body.add(A.body.slot(node, node), scale * 2.0 * Mat3::Identity());
    }
    void apply(const StateView& s, const VecX& x, VecX& y) const override {
      y.segment<3>(s.layout->find(id)->u_offset) += 2.0 * x.segment<3>(s.layout->find(id)->u_offset);
    }
  };
  chain.system.add(std::make_shared<PointMass>(id));
  chain.system.prepare(chain.state.view());
  stepper->reinit(ReinitReason::kLayoutChanged);
  ASSERT_TRUE(stepper->advance_to(0.5).ok());
  // remaining error of Newton's iteration
  EXPECT_LT((chain.state.q(*chain.state.layout().find(id)) - VecX::Constant(3, 0.25)).norm(),
            is_explicit(GetParam()) ? 1e-12 : 1e-7);
  const VecX exact = chain.term->q0 + 0.1 * std::cos(0.5 * chain.omega()) * chain.mode();
  EXPECT_LT((chain.state.q().head(12) - exact).norm(), 1e-2 * 0.1);
}

TEST_P(Steppers, EndCleanlyAtNotANumber) {
  Chain chain;
  chain.start_in_mode(0.1);
  chain.term->nan_from = 0.2;
  const auto stepper = integrate::make_stepper(chain.system, chain.state, spec());
  const StepResult result = stepper->advance_to(0.5);
  EXPECT_EQ(result.status, StepStatus::kNotFinite) << to_string(result.status);
  EXPECT_NE(result.message.find(spec().name), std::string::npos) << result.message;
  EXPECT_LE(chain.state.time(), 0.2) << "no force is taken there by a step whose stage lies inside it";
  EXPECT_EQ(result.t, chain.state.time());
  EXPECT_TRUE(chain.state.q().allFinite() && chain.state.u().allFinite()) << "the last good step";
  chain.term->nan_from = 1e9;  // NaN no longer occurs
  stepper->reinit(ReinitReason::kParametersChanged);
  ASSERT_TRUE(stepper->advance_to(0.5).ok());
  const VecX exact = chain.term->q0 + 0.1 * std::cos(0.5 * chain.omega()) * chain.mode();
  EXPECT_LT((chain.state.q() - exact).norm(), 1e-2 * 0.1);
}

TEST_P(Steppers, EndCleanlyAtNotANumberFromTheStart) {
  Chain chain;
  chain.term->nan_from = 0.0;
  const auto stepper = integrate::make_stepper(chain.system, chain.state, spec());
  EXPECT_EQ(stepper->advance_to(0.5).status, StepStatus::kNotFinite);
  EXPECT_EQ(chain.state.time(), 0.0);
}

TEST_P(Steppers, StopAtTheStepLimit) {
  Chain chain;
  chain.start_in_mode(0.1);
  IntegratorSpec s = spec();
  s.max_steps = 5;
  const auto stepper = integrate::make_stepper(chain.system, chain.state, s);
  const StepResult result = stepper->advance_to(1.0);
  EXPECT_EQ(result.status, StepStatus::kTooManySteps);
  EXPECT_NE(result.message.find("max_steps = 5 before t_end = 1"), std::string::npos) << result.message;
  EXPECT_EQ(stepper->counters().steps, 5);
  EXPECT_GT(chain.state.time(), 0.0);
}

// Solved by an iteration over the solver's factor of the symmetric part, or by the solver itself if it
// supports unsymmetric matrices; never by LU.
TEST_P(ImplicitSteppers, TakeAnUnsymmetricTangent) {
  Chain chain;
  chain.start_in_mode(0.1);
  chain.term->K(0, 3) += 20.0;  // circulatory
  chain.term->symmetric = false;
  IntegratorSpec tight = spec();
  tight.linear_rtol = 1e-14;
  auto& counter = counters::counter("integrate.solver.gmres");
  const auto& lu = counters::counter("integrate.solver.umfpack");
  const long before = counter, lu_before = lu;
  const VecX q = run(chain.system, chain.state, tight, 0.3);
  EXPECT_GT(counter, before);
  EXPECT_EQ(lu, lu_before);
  Chain same;
  same.start_in_mode(0.1);
  same.term->K(0, 3) += 20.0;
  same.term->symmetric = false;
  IntegratorSpec s = spec();
  s.linear_solver = "umfpack";
  // Error control over stages turns rounding into different step lengths, also between two LU factorisations
  // (8e-10, measured with KLU and UMFPACK): the limit is ten times that, and rounding level for fixed steps.
  const bool free_steps = s.name.starts_with("ark-") && !steps_are_fixed(GetParam());
  const VecX by_lu = run(same.system, same.state, s, 0.3);
  EXPECT_LT((by_lu - q).norm(), free_steps ? 1e-8 : 1e-13);
}

TEST_P(Steppers, PassEmptyTime) {
  State state;
  System system;
  system.prepare(state.view());
  const auto stepper = integrate::make_stepper(system, state, spec());
  EXPECT_TRUE(stepper->advance_to(1.0).ok());
  EXPECT_EQ(state.time(), 1.0);
}

TEST_P(Steppers, CountTheirWork) {
  Chain chain;
  chain.start_in_mode(0.1);
  const auto stepper = integrate::make_stepper(chain.system, chain.state, spec());
  ASSERT_TRUE(stepper->advance_to(0.2).ok());
  ASSERT_TRUE(stepper->advance_to(0.4).ok());
  const StepperCounters& c = stepper->counters();
  EXPECT_GT(c.steps, 2);
  EXPECT_EQ(c.force_evaluations, chain.term->forces);
  EXPECT_EQ(c.indefinite, 0);
  if (is_explicit(GetParam())) {  // needs neither tangent nor solver
    EXPECT_EQ(chain.term->tangents, 0);
    EXPECT_EQ(c.solver.symbolic + c.solver.factorisations + c.solver.solves, 0);
    return;
  }
  EXPECT_GT(c.tangent_evaluations, 0);
  EXPECT_GE(chain.term->tangents, c.tangent_evaluations);
  EXPECT_GE(c.solver.solves, c.steps);
  EXPECT_EQ(c.solver.symbolic, 1) << "one pattern, one analysis";
  EXPECT_EQ(c.solver.factorisations, c.tangent_evaluations);
}

}  // namespace
}  // namespace palpate
