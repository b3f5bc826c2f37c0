// What the tested releases of SUNDIALS do differently (src/integrate/sundials/release.h), held for the one
// that is installed.
#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>

#include <sstream>

#include "integrate/dense_ode.h"
#include "integrate/fakes.h"
#include "integrate/top.h"
#include "palpate/core/log.h"

namespace palpate {
namespace {

using namespace fakes;

/// The log of a scope, in the place of the default one.
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

/// A step that is lost in the rounding of the time, which the library warns of.
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

// A fixed step is counted from where the last one ended: from an output on too, though that shortened one.
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

// An output that falls on the end of a step is landed on, and the next one is reached from there.
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

// 7.1 starts a step from f of the state before its projection, where the method's last stage is the end of
// the step; 6.4 evaluates f anew.  On unit quaternions that scales q' = N(q) u by |q|, with |q| - 1 of the
// size of one step's error: no method loses its order.
TEST(SundialsRelease, MethodsKeepTheirOrderWhereStepsAreProjected) {
  int checked = 0;
  for (const std::string& mode : stepper_modes()) {
    if (!steps_are_fixed(mode) || !mode.starts_with("ark-") || mode.starts_with("ark-mri")) continue;
    const int order = mode_traits(mode).order;
    std::vector<double> steps, errors;
    std::string text;
    // Steps at which the leading term of the error decides, and rounding does not.
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
