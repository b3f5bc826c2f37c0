// Newton's method on equations with known solutions, and fixed steps of ARKODE when a solve fails.
#include "integrate/newton.h"

#include <gtest/gtest.h>

#include <cmath>

#include "integrate/dense_ode.h"

namespace palpate {
namespace {

using dynamics::StepStatus;
using integrate::DampedNewton;
using Way = DampedNewton::Way;

/// One equation in one unknown, with its derivative; counts its evaluations.
struct Scalar final : integrate::NewtonEquation {
  std::function<double(double)> r, slope;
  double tolerance = 1e-12, x_ = 0.0, r_ = 0.0, a_ = 0.0;
  int residuals = 0, matrices = 0;
  Scalar(std::function<double(double)> f, std::function<double(double)> df)
      : r(std::move(f)), slope(std::move(df)) {}
  bool evaluate(const VecX& x) override {
    ++residuals;
    x_ = x[0];
    r_ = r(x_);
    return std::isfinite(r_);
  }
  bool solved() const override { return r_ == 0.0; }
  dynamics::SolveStatus refresh() override {
    ++matrices;
    a_ = slope(x_);
    return a_ != 0.0 ? dynamics::SolveStatus::kOk : dynamics::SolveStatus::kSingular;
  }
  bool correct(VecX& d, double& size) override {
    d = VecX::Constant(1, -r_ / a_);
    size = std::abs(d[0]) / tolerance;
    return true;
  }
  double rounding(const VecX& x) override { return 1e-15 * std::abs(x[0]) / tolerance; }
};

TEST(DampedNewton, ALinearEquationTakesOneMatrixAndTwoResiduals) {
  Scalar linear([](double x) { return 3.0 * x - 6.0; }, [](double) { return 3.0; });
  VecX x = VecX::Constant(1, -40.0);
  const auto result = DampedNewton().solve(linear, x, 20, Way::kKeptMatrix, false);
  EXPECT_EQ(result.status, StepStatus::kOk);
  EXPECT_NEAR(x[0], 2.0, 1e-14);
  EXPECT_EQ(linear.matrices, 1);
  EXPECT_EQ(linear.residuals, 2);
}

// Undamped Newton diverges from |x| > 1.39: each iterate is farther away than the previous one.
TEST(DampedNewton, DampsWhereAWholeCorrectionWouldDiverge) {
  for (const double start : {1.0, 2.0, 10.0, 100.0}) {
    Scalar arctan([](double x) { return std::atan(x); }, [](double x) { return 1.0 / (1.0 + x * x); });
    VecX x = VecX::Constant(1, start);
    const auto result = DampedNewton().solve(arctan, x, 60, Way::kFresh, false);
    // the reach of a damping of 1/64
    EXPECT_EQ(result.status, start < 50.0 ? StepStatus::kOk : StepStatus::kNewtonFailed) << start;
    if (start < 50.0) { EXPECT_NEAR(x[0], 0.0, 1e-11) << start; }
  }
  Scalar arctan([](double x) { return std::atan(x); }, [](double x) { return 1.0 / (1.0 + x * x); });
  VecX x = VecX::Constant(1, 2.0);
  EXPECT_NE(DampedNewton().solve(arctan, x, 60, Way::kLeaps, false).status, StepStatus::kOk);
}

TEST(DampedNewton, AKeptMatrixServesUntilItContractsTooLittle) {
  Scalar square([](double x) { return x * x - 2.0; }, [](double x) { return 2.0 * x; });
  DampedNewton newton;
  VecX x = VecX::Constant(1, 1.5);
  ASSERT_EQ(newton.solve(square, x, 20, Way::kKeptMatrix, false).status, StepStatus::kOk);
  EXPECT_EQ(square.matrices, 1);
  ASSERT_EQ(newton.solve(square, x = VecX::Constant(1, 1.4), 20, Way::kKeptMatrix, true).status,
            StepStatus::kOk);
  EXPECT_EQ(square.matrices, 1) << "the old one served";
  ASSERT_EQ(newton.solve(square, x = VecX::Constant(1, 40.0), 60, Way::kKeptMatrix, true).status,
            StepStatus::kOk);
  EXPECT_GT(square.matrices, 1) << "the old one led astray";
  EXPECT_NEAR(x[0], std::sqrt(2.0), 1e-11);
}

// x plus a jump at 0, without the jump's slope in the matrix: from the right the solution x = -1 lies behind
// it, and no small correction decreases the residual.
TEST(DampedNewton, LeapsOverAJump) {
  const auto residual = [](double x) {
    return x > 0.0 ? 0.5 * x + 0.2 : x + 1.0 + 1e3 * std::max(0.0, x + 1e-3);
  };
  const auto slope = [](double x) { return x > 0.0 ? 0.5 : x > -1e-3 ? 1e3 + 1.0 : 1.0; };
  Scalar jump(residual, slope);
  VecX x = VecX::Constant(1, 0.3);
  const auto stuck = DampedNewton().solve(jump, x, 60, Way::kFresh, false);
  EXPECT_EQ(stuck.status, StepStatus::kNewtonFailed);
  EXPECT_STREQ(stuck.what, "Newton line search found no descent");
  x[0] = 0.3;
  ASSERT_EQ(DampedNewton().solve(jump, x, 60, Way::kLeaps, false).status, StepStatus::kOk);
  EXPECT_NEAR(x[0], -1.0, 1e-12);
}

TEST(DampedNewton, AResidualThatIsNotFiniteIsSaidAndNotTaken) {
  // from 10 the full correction leads to -13
  Scalar log([](double x) { return std::log(x); }, [](double x) { return 1.0 / x; });
  VecX x = VecX::Constant(1, 10.0);
  ASSERT_EQ(DampedNewton().solve(log, x, 60, Way::kFresh, false).status, StepStatus::kOk);
  EXPECT_NEAR(x[0], 1.0, 1e-11);
  x[0] = -1.0;
  EXPECT_EQ(DampedNewton().solve(log, x, 60, Way::kFresh, false).status, StepStatus::kNotFinite);
}

struct Kept final : dynamics::StepTrace {
  std::vector<dynamics::StepAttempt> all;
  void attempt(const dynamics::StepAttempt& a) override { all.push_back(a); }
};

// y' = y^2, y(0) = 1: y = 1/(1 - t). A stage y1 = y0 + g y1^2 has no solution for 4 g y0 > 1, so that a table
// whose first stage has g = H a_11 > 1/4 cannot take a step H as a whole; taken in parts, it ends near 1/(1 -
// H).
TEST(FixedStepNewton, AStepThatHasNoSolutionIsTakenInParts) {
  fakes::Equation growth;
  growth.f = [](const VecX& y, VecX& f) { f = y.cwiseProduct(y); };
  growth.jacobian = [](const VecX& y, MatX& J) { J = (2.0 * y).asDiagonal(); };
  growth.y0 = growth.scale = VecX::Ones(1);
  for (const char* name : {"ark-dirk-cash534", "ark-dirk-kvaerno534"}) {  // a_11 = 0.436 in both
    VecX y;
    double t = 0.0;
    IntegratorSpec spec{.name = name, .step_s = 0.65, .fixed_step = true};
    const auto stepper =
        integrate::make_ode_stepper(std::make_unique<fakes::DenseOde>(growth, 1e-8, y, t), spec);
    Kept kept;
    stepper->set_trace(&kept);
    const dynamics::StepResult result = stepper->advance_to(0.65);
    ASSERT_TRUE(result.ok()) << name << ": " << result.message;
    EXPECT_EQ(t, 0.65);
    EXPECT_NEAR(y[0], 1.0 / 0.35, 0.1) << name;
    EXPECT_GT(stepper->counters().steps, 1) << name;
    EXPECT_GT(stepper->counters().rejected, 0) << name;
    EXPECT_GT(stepper->counters().newton_failures, 0) << name;
    EXPECT_LE(stepper->counters().newton_failures, stepper->counters().rejected) << name;
    const dynamics::StepperCounters& c = stepper->counters();
    EXPECT_EQ(c.halved_steps, 1) << name;
    EXPECT_EQ(c.step_parts, c.steps) << name;
    EXPECT_EQ(c.most_halvings, std::lround(-std::log2(result.h / 0.65))) << name;
    EXPECT_GE(c.definite_retries, c.rejected) << name;
    EXPECT_EQ(std::count_if(kept.all.begin(), kept.all.end(), [](const auto& a) { return a.halvings > 0; }),
              c.step_parts + c.rejected - 1)
        << name << ": every attempt but the first is at a part";
  }
}

TEST(FixedStepNewton, CountsEachSolveOnce) {
  fakes::Equation decay;
  decay.f = [](const VecX& y, VecX& f) { f = -y; };
  decay.jacobian = [](const VecX& y, MatX& J) { J = -MatX::Identity(y.size(), y.size()); };
  decay.y0 = decay.scale = VecX::Ones(2);
  VecX y;
  double t = 0.0;
  IntegratorSpec spec{.name = "ark-dirk-sdirk212", .step_s = 0.1, .fixed_step = true};
  const auto stepper =
      integrate::make_ode_stepper(std::make_unique<fakes::DenseOde>(decay, 1e-8, y, t), spec);
  ASSERT_TRUE(stepper->advance_to(1.0).ok());
  EXPECT_EQ(stepper->counters().steps, 10);
  EXPECT_EQ(stepper->counters().newton_iterations, 2 * 10) << "two linear stages a step";
  EXPECT_EQ(stepper->counters().newton_failures, 0);
}

TEST(FixedStepNewton, WhereNoPartHelpsItIsSaid) {
  // y' jumps from 1 to -1 at y = 1/2: there a stage has no solution, however short the step is
  fakes::Equation jump;
  jump.f = [](const VecX& y, VecX& f) { f = VecX::Constant(1, y[0] < 0.5 ? 1.0 : -1.0); };
  jump.jacobian = [](const VecX&, MatX& J) { J.setZero(1, 1); };
  jump.y0 = VecX::Zero(1);
  jump.scale = VecX::Ones(1);
  VecX y;
  double t = 0.0;
  IntegratorSpec spec{.name = "ark-dirk-sdirk534", .step_s = 0.1, .fixed_step = true};
  const auto stepper = integrate::make_ode_stepper(std::make_unique<fakes::DenseOde>(jump, 1e-8, y, t), spec);
  const dynamics::StepResult result = stepper->advance_to(1.0);
  EXPECT_EQ(result.status, StepStatus::kNewtonFailed);
  EXPECT_NE(result.message.find("ARK_CONV_FAILURE"), std::string::npos) << result.message;
  EXPECT_NE(result.message.find("Not even a step of h/64 converges"), std::string::npos) << result.message;
  EXPECT_NEAR(t, 0.5, 0.02) << "the last good state stands";
  EXPECT_LE(y[0], 0.5 + 1e-8);
}

}  // namespace
}  // namespace palpate
