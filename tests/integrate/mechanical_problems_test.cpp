#include "integrate/mechanical_problems.h"

#include <gtest/gtest.h>

/// Mechanical systems from the literature through the condensed Newton matrix.
namespace palpate {
namespace {

using namespace fakes;

/// Error-controlled methods of sufficient order to reach 1e-6 within seconds.
std::vector<std::string> accurate_methods() {
  std::vector<std::string> out;
  for (const auto& e : integrate::stepper_registry())
    if (e.traits.control != StepControl::kFixed && e.traits.order >= 3) out.push_back(e.name);
  return out;
}
class Mechanics : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Registry, Mechanics, testing::ValuesIn(accurate_methods()), registry_test_name);

void expect_reference(const std::string& name, const Potentials& potentials, const VecX& q0, const VecX& u0,
                      double T, double fastest) {
  VecX q = q0, u = u0;
  reference(potentials, q, u, T, static_cast<int>(std::ceil(T * fastest / 2e-3)));
  Problem problem(q0, u0, potentials);
  const double energy = problem.energy();
  const auto stepper = integrate::make_stepper(problem.system, problem.state,
                                               {.name = name, .rtol = 1e-8, .max_steps = 5000000});
  const StepResult result = stepper->advance_to(T);
  ASSERT_TRUE(result.ok()) << result.message;
  EXPECT_LT((problem.state.q() - q).norm() / q.norm(), 2e-5);
  EXPECT_LT((problem.state.u() - u).norm() / std::max(1.0, u.norm()), 2e-4 * std::sqrt(fastest));
  // energy of about 1 is exchanged
  EXPECT_NEAR(problem.energy(), energy, 1e-4 * std::max(1.0, std::abs(energy)));
}

TEST_P(Mechanics, StiffSpringPendulum) {
  const double k = 1e4;
  const VecX q0 = (VecX(3) << 1.0 + 1e-3, 0.0, 0.0).finished();
  expect_reference(GetParam(), {spring_pendulum(k)}, q0, VecX::Zero(3), 3.0, std::sqrt(k));
}

TEST_P(Mechanics, FermiPastaUlamChain) {
  namespace fpu = fermi_pasta_ulam;
  const double w = 50.0;
  expect_reference(GetParam(), {fpu::stiff(w), fpu::soft()}, fpu::q0(w), fpu::u0(), 3.0, w);
}

}  // namespace
}  // namespace palpate
