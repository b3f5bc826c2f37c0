#include <gtest/gtest.h>

#include "integrate/top.h"

namespace palpate {
namespace {

using namespace fakes;

class RigidBlock : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Registry, RigidBlock, testing::ValuesIn(fakes::stepper_modes()), registry_test_name);

TEST_P(RigidBlock, TumblesAndSwingsAtTheOrder) {
  const int order = fakes::ladder_order(GetParam());
  const Ladder l = ladder(
      GetParam(), std::max((Top().w0).norm(), std::sqrt(kSpring * (1.0 / kMass + 1.0 / kNodeMass))), 1.0);
  std::vector<double> values, errors;
  for (const double value : l.values) {
    Top top;
    IntegratorSpec s = fakes::mode_spec(GetParam());
    set_accuracy(s, order, value);
    const auto stepper = integrate::make_stepper(top.system, top.state, s);
    ASSERT_TRUE(stepper->advance_to(1.0).ok());
    EXPECT_NEAR(top.state.q(*top.body).head<4>().norm(), 1.0, 1e-14);
    values.push_back(value);
    errors.push_back(top.error());
  }
  EXPECT_GT(slope(values, errors), l.low);
  EXPECT_LT(slope(values, errors), l.high);
  EXPECT_LT(errors.back(), order > 0 ? 1e-2 : 1e-6);
}

}  // namespace
}  // namespace palpate
