// Differences between the tested releases of SUNDIALS (src/integrate/sundials/release.h), checked for the
// installed one.
#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>

#include <algorithm>
#include <sstream>
#include <type_traits>

#include "integrate/dense_ode.h"
#include "integrate/fakes.h"
#include "integrate/sundials/ark_methods.h"
#include "integrate/sundials/butcher_table.h"
#include "integrate/top.h"
#include "palpate/core/log.h"

namespace palpate {
namespace {

using namespace fakes;

/// Captures the log within a scope in place of the default log.
class CapturedLog {
 public:
  CapturedLog() : before_(spdlog::default_logger()) {
    auto logger =
        std::make_shared<spdlog::logger>("captured", std::make_shared<spdlog::sinks::ostream_sink_mt>(text_));
    logger->set_level(spdlog::level::debug);
    spdlog::set_default_logger(logger);
  }
  ~CapturedLog() { spdlog::set_default_logger(before_); }
  std::string text() const { return text_.str(); }

 private:
  std::ostringstream text_;
  std::shared_ptr<spdlog::logger> before_;
};

/// A step that vanishes in the rounding of the time, about which the library warns.
IntegratorSpec lost_step(const char* name) {
  return {.name = name, .step_s = 1e-10, .fixed_step = true, .max_steps = 5};
}

TEST(SundialsRelease, WarningsGoToTheLogAndNowhereElse) {
  for (const char* name : {"ark-erk-3", "ark-dirk-ark436"}) {
    Chain chain;
    chain.start_in_mode(0.1);
    chain.state.set_time(1e8);
    CapturedLog log;
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    {
      const auto stepper = integrate::make_stepper(chain.system, chain.state, lost_step(name));
      EXPECT_FALSE(stepper->advance_to(1e8 + 1.0).ok()) << name;
    }
    std::fflush(stdout);
    EXPECT_EQ(testing::internal::GetCapturedStdout(), "") << name;
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << name;
    EXPECT_NE(log.text().find("t + h = t"), std::string::npos) << name << ": " << log.text();
  }
}

TEST(SundialsRelease, ErrorsGoIntoTheMessageAndNowhereElse) {
  Chain chain;
  chain.start_in_mode(0.1);
  chain.term->nan_from = 0.05;
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  std::string message;
  for (const char* name : {"cvode-bdf", "ida", "ark-erk-5", "ark-dirk-ark436", "kinsol-static"}) {
    chain.state.set_time(0.0);
    const auto stepper = integrate::make_stepper(chain.system, chain.state, {.name = name});
    const StepResult r = stepper->advance_to(1.0);
    EXPECT_FALSE(r.ok()) << name;
    EXPECT_GT(r.message.size(), 40u) << name << ": " << r.message;
  }
  std::fflush(stdout);
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

struct Ends final : StepTrace {
  std::vector<double> all;
  void attempt(const StepAttempt& a) override { all.push_back(a.t + a.h); }
};

// A fixed step starts at the end of the previous one, also at an output, although the output shortened that
// step.
TEST(SundialsRelease, FixedStepsAreWholeFromAnOutputOn) {
  constexpr double h = 1e-3;
  for (const char* name : {"ark-erk-4", "ark-dirk-ark436", "ark-imex-4", "ark-mri-2"}) {
    Chain chain;
    chain.start_in_mode(0.1);
    IntegratorSpec spec{.name = name, .step_s = h};
    spec.fixed_step = true;
    const auto stepper = integrate::make_stepper(chain.system, chain.state, spec);
    Ends ends;
    stepper->set_trace(&ends);
    ASSERT_TRUE(stepper->advance_to(2.5 * h).ok()) << name;
    EXPECT_EQ(chain.state.time(), 2.5 * h) << name;
    ASSERT_TRUE(stepper->advance_to(5.0 * h).ok()) << name;
    EXPECT_EQ(chain.state.time(), 5.0 * h) << name;
    const std::vector<double> expected = {1.0, 2.0, 2.5, 3.5, 4.5, 5.0};
    ASSERT_EQ(ends.all.size(), expected.size()) << name;
    for (std::size_t i = 0; i < expected.size(); ++i)
      EXPECT_NEAR(ends.all[i] / h, expected[i], 1e-9) << name << ", step " << i;
  }
}

// An output that coincides with the end of a step is reached exactly, and the next one is reached from there.
TEST(SundialsRelease, AnOutputIsLandedOnHoweverItLies) {
  for (const auto& entry : integrate::stepper_registry()) {
    if (entry.traits.control == StepControl::kFixed) continue;
    Chain chain;
    chain.start_in_mode(0.1);
    const auto stepper = integrate::make_stepper(chain.system, chain.state, {.name = entry.name});
    for (const double t : {0.1, 0.1 + 1e-12, 0.2, std::nextafter(0.2, 1.0), 0.3}) {
      const StepResult r = stepper->advance_to(t);
      ASSERT_TRUE(r.ok()) << entry.name << ", t = " << t << ": " << r.message;
      EXPECT_EQ(chain.state.time(), t) << entry.name;
    }
  }
}

/// A zero force that records the states at which forces are evaluated.
struct Recorder final : ForceTerm {
  std::vector<VecX> states;
  std::string_view name() const override { return "recorder"; }
  TermTraits traits() const override { return {.symmetric_tangent = true, .conservative = true}; }
  /// Includes the time: Newton's iterations of later stages begin at the step's initial state.
  static VecX joined(double t, const VecX& q, const VecX& u) {
    VecX y(1 + q.size() + u.size());
    y << t, q, u;
    return y;
  }
  void add_force(const StateView& s, VecX&) override { states.push_back(joined(s.time, s.q, s.u)); }
  void add_tangent(const StateView&, double, double, BorderedMatrix&) override {}
  void apply_tangent(const StateView&, double, double, const VecX&, VecX&) override {}
  bool near(const VecX& y) const {
    return std::any_of(states.begin(), states.end(), [&y](const VecX& x) { return (x - y).norm() < 1e-14; });
  }
};

/// Counts steps in which no force was evaluated at their initial state.
struct StepStarts final : StepFollower {
  Recorder& recorder;
  const State& state;
  VecX start;
  int steps = 0, missed = 0;
  StepStarts(Recorder& r, const State& s)
      : recorder(r), state(s), start(Recorder::joined(s.time(), s.q(), s.u())) {}
  void stepped(const Stepper&, double, double) override {
    missed += !recorder.near(start);
    ++steps;
    start = Recorder::joined(state.time(), state.q(), state.u());
    recorder.states.clear();
  }
};

template <class Model>
void expect_starts_evaluated(const std::string& mode, double step) {
  Model model;
  auto recorder = std::make_shared<Recorder>();
  model.system.add(std::static_pointer_cast<ForceTerm>(recorder));
  if constexpr (std::is_same_v<Model, Chain>) model.start_in_mode(0.1);
  model.system.prepare(model.state.view());
  IntegratorSpec spec = mode_spec(mode);
  spec.step_s = step;
  spec.newton_rtol = 1e-6;  // far above the distance at which states count as equal
  const auto stepper = integrate::make_stepper(model.system, model.state, spec);
  StepStarts starts(*recorder, model.state);
  ASSERT_TRUE(stepper->follow(&starts));
  ASSERT_TRUE(stepper->advance_to(0.1).ok()) << mode;
  EXPECT_GT(starts.steps, 2) << mode;
  EXPECT_EQ(starts.missed, 0) << mode << " of " << starts.steps << " steps";
}

// With an explicit first stage, f is evaluated at the step's initial state, rather than reused from Newton's
// iteration of the last stage or from the state before a projection. The step then does not depend on whether
// the method was reset before it.
TEST(SundialsRelease, StepsStartFromTheForceOfTheirState) {
  int checked = 0;
  for (const std::string& mode : stepper_modes()) {
    if (!mode.starts_with("ark-") || mode.starts_with("ark-mri")) continue;
    const std::string name = mode_spec(mode).name;
    const integrate::ArkMethod& method = integrate::ark_method(name);
    if (method.implicit_table >= 0 && integrate::implicit_table(method).A(0, 0) != 0.0) continue;
    expect_starts_evaluated<Top>(mode, 0.01);
    // Without a projection an explicit method may reuse f of its last stage, which is the same.
    if (method.implicit_table >= 0) expect_starts_evaluated<Chain>(mode, 0.01);
    ++checked;
  }
  EXPECT_EQ(checked, 54);
}

// On unit quaternions, whose norm has one step's error before each projection.
TEST(SundialsRelease, MethodsKeepTheirOrderWhereStepsAreProjected) {
  int checked = 0;
  for (const std::string& mode : stepper_modes()) {
    if (!steps_are_fixed(mode) || !mode.starts_with("ark-") || mode.starts_with("ark-mri")) continue;
    const int order = mode_traits(mode).order;
    std::vector<double> steps, errors;
    std::string text;
    // Steps for which the leading error term dominates, rather than rounding.
    for (int n = order < 4 ? 20 : order == 4 ? 80 : 10; steps.size() < 3; n *= 2) {
      Top top;
      IntegratorSpec spec = mode_spec(mode);
      spec.step_s = 0.3 / n;
      const auto stepper = integrate::make_stepper(top.system, top.state, spec);
      const StepResult result = stepper->advance_to(0.3);
      ASSERT_TRUE(result.ok()) << mode << ": " << result.message;
      steps.push_back(spec.step_s);
      errors.push_back(top.error());
      text += fmt::format(" {:.2e}", errors.back());
    }
    EXPECT_NEAR(slope(steps, errors), order, 0.3) << mode << text;
    ++checked;
  }
  EXPECT_GT(checked, 30);
}

}  // namespace
}  // namespace palpate
