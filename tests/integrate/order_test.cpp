// Order of every method at fixed steps on nonlinear motion, which involves order conditions that linear
// motion does not, and on systems split by additive and multi-rate methods.
#include <gtest/gtest.h>

#include "integrate/mechanical_problems.h"
#include "integrate/top.h"

namespace palpate {
namespace {

using namespace fakes;

struct OrderProblem {
  std::string name;
  VecX q0, u0;
  Potentials potentials;
  double T, fastest;  ///< [s], [rad/s]
};

/// A pendulum on a spring that swings through its lowest point onto a soft floor; and six masses.
/// @param split  floor and soft springs are contacts
std::vector<OrderProblem> problems(bool split) {
  namespace fpu = fermi_pasta_ulam;
  const auto floor = exponential_floor(0.05);
  const auto soft = fpu::soft();
  floor->kind.contact = soft->kind.contact = split;
  constexpr double kSpring = 25.0, w = 5.0;
  return {{"pendulum", VecX::Unit(3, 0), VecX::Zero(3), {spring_pendulum(kSpring), floor}, 2.0, 6.0},
          {"chain", fpu::q0(w), fpu::u0(), {fpu::stiff(w), soft}, 2.0, 7.0}};
}

struct Reference {
  VecX q, u;
  explicit Reference(const OrderProblem& p) : q(p.q0), u(p.u0) {
    reference(p.potentials, q, u, p.T, static_cast<int>(std::ceil(p.T * p.fastest / 2e-3)));
  }
};

double error(const OrderProblem& p, const Reference& truth, IntegratorSpec spec) {
  Problem problem(p.q0, p.u0, p.potentials);
  spec.explicit_side = ExplicitSide::kContact;
  spec.max_steps = 1000000;
  const auto stepper = integrate::make_stepper(problem.system, problem.state, spec);
  if (const StepResult r = stepper->advance_to(p.T); !r.ok()) fail("{}: {}", p.name, r.message);
  return std::hypot((problem.state.q() - truth.q).norm(), (problem.state.u() - truth.u).norm() / p.fastest);
}

/// Steps that resolve the motion with an error above rounding.
int coarsest(int order) { return order == 1 ? 800 : order == 2 ? 200 : order == 3 ? 100 : 50; }

void expect_order(const std::string& mode, bool split) {
  const int order = mode_traits(mode).order;
  for (const OrderProblem& p : problems(split)) {
    const Reference truth(p);
    std::vector<double> steps, errors;
    std::string text;
    for (int n = coarsest(order); steps.size() < 3; n *= 2) {
      IntegratorSpec spec = mode_spec(mode);
      spec.step_s = p.T / n;
      steps.push_back(spec.step_s);
      errors.push_back(error(p, truth, spec));
      text += fmt::format(" {:.2e}", errors.back());
    }
    const double seen = slope(steps, errors);
    EXPECT_NEAR(seen, order, 0.2) << p.name << text;
  }
}

class NonlinearOrder : public testing::TestWithParam<std::string> {};
std::vector<std::string> fixed_modes() {
  std::vector<std::string> out = stepper_modes();
  std::erase_if(out, [](const std::string& mode) { return !steps_are_fixed(mode); });
  return out;
}
INSTANTIATE_TEST_SUITE_P(Registry, NonlinearOrder, testing::ValuesIn(fixed_modes()), registry_test_name);
TEST_P(NonlinearOrder, IsThatOfTheRegistry) { expect_order(GetParam(), false); }

class SplitOrder : public testing::TestWithParam<std::string> {};
std::vector<std::string> splitting_modes() {
  std::vector<std::string> out = fixed_modes();
  std::erase_if(out, [](const std::string& mode) {
    const auto& family = mode_traits(mode).family;
    return family != "ImEx Runge-Kutta" && family != "multi-rate";
  });
  return out;
}
INSTANTIATE_TEST_SUITE_P(Registry, SplitOrder, testing::ValuesIn(splitting_modes()), registry_test_name);
TEST_P(SplitOrder, IsThatOfTheRegistry) { expect_order(GetParam(), true); }

// A rigid tool in fast steps, on a spring against a slow node; the motion is known.
TEST(MultirateOrder, WithAFastToolIsThatOfTheRegistry) {
  for (const std::string mode : {"ark-mri-2", "ark-mri-3", "ark-mri-4"}) {
    std::vector<double> steps, errors;
    std::string text;
    for (int n = 20; n <= 80; n *= 2) {
      Top top(true);
      IntegratorSpec spec = mode_spec(mode);
      spec.step_s = 0.3 / n;
      const auto stepper = integrate::make_stepper(top.system, top.state, spec);
      const StepResult result = stepper->advance_to(0.3);
      ASSERT_TRUE(result.ok()) << result.message;
      EXPECT_GT(stepper->counters().fast_steps, 5 * stepper->counters().steps);
      steps.push_back(spec.step_s);
      errors.push_back(top.error());
      text += fmt::format(" {:.2e}", errors.back());
    }
    EXPECT_NEAR(slope(steps, errors), mode_traits(mode).order, 0.2) << mode << text;
  }
}

}  // namespace
}  // namespace palpate
