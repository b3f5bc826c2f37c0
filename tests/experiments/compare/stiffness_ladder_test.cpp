#include <gtest/gtest.h>

#include "palpate/experiments/trajectory.h"
#include "palpate/integrate/integrators.h"
#include "palpate/loop/load.h"

/// The same setting for materials from jelly to plastic: one bar, loaded at its end by P L^2 / (E I) = 1 from
/// t = 0 on, to the same end time.
namespace palpate {
namespace {

constexpr double kLength = 0.2, kWidth = 0.04, kEnd = 0.2;

std::string bar(double youngs_modulus) {
  const double second_moment = std::pow(kWidth, 4) / 12.0,
               load = youngs_modulus * second_moment / (kLength * kLength);
  return fmt::format(R"(
[scene]
name = "stiffness-ladder"
duration_s = {}
[[body]]
name = "bar"
youngs_modulus_pa = {}
poissons_ratio = 0.3
density_kg_m3 = 1000.0
stiffness_damping_s = 2e-3
[body.mesh]
generator = "box"
size_m = [0.2, 0.04, 0.04]
element_size_m = 0.02
[[body.attachment]]
box_min_m = [-0.101, -0.1, -0.1]
box_max_m = [-0.099, 0.1, 0.1]
[[body.load]]
box_min_m = [0.099, -0.1, -0.1]
box_max_m = [0.101, 0.1, 0.1]
force_n = [0.0, 0.0, {}]
[record]
state_period_s = 0.02
)",
                     kEnd, youngs_modulus, -load);
}

compare::Run run(double youngs_modulus, const IntegratorSpec& spec) {
  scene::Description d = loop::parse(bar(youngs_modulus), "stiffness-ladder.toml");
  d.integrator = spec;
  return compare::run_once(d, 0.0);
}

class StiffnessLadder : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Pascal, StiffnessLadder, testing::Values(1e4, 1e5, 1e6, 1e7, 1e8, 1e9),
                         [](const auto& given) {
                           return fmt::format("1e{}", static_cast<int>(std::lround(std::log10(given.param))));
                         });

// Every error-controlled implicit method of SUNDIALS reaches 1e-5 with the same tolerance for all E: 1e-7,
// and 1e-6 for methods of order 2. Errors are relative to the deformation, which in a bending bar is a
// seventh of the displacement.
TEST_P(StiffnessLadder, EveryImplicitMethodOfSundialsReaches1eMinus5) {
  const compare::Run reference = run(GetParam(), {.name = "cvode-bdf", .rtol = 1e-9});
  ASSERT_TRUE(reference.result.status.ok()) << reference.result.status.message;
  const compare::Run check = run(GetParam(), {.name = "ark-dirk-kvaerno745", .rtol = 1e-9});
  ASSERT_TRUE(check.result.status.ok()) << check.result.status.message;
  const double own = compare::distance(check.trajectory, reference.trajectory).position_rel_l2;
  EXPECT_LT(own, 1e-6) << "two families agree";
  int methods = 0;
  for (const auto& entry : integrate::stepper_registry()) {
    if (!entry.traits.implicit || entry.traits.control == dynamics::StepControl::kFixed) continue;
    const compare::Run r =
        run(GetParam(),
            {.name = entry.name, .rtol = entry.traits.order <= 2 ? 1e-6 : 1e-7, .max_steps = 1000000});
    ASSERT_TRUE(r.result.status.ok()) << entry.name << ": " << r.result.status.message;
    const double error = compare::distance(r.trajectory, reference.trajectory).position_rel_l2;
    EXPECT_LT(error, 1e-5) << entry.name;
    std::printf("E = %g  %-24s error %.1e  steps %6ld  cpu %.2f s\n", GetParam(), entry.name.c_str(), error,
                r.result.counters.steps, r.result.cpu_s);
    ++methods;
  }
  EXPECT_GE(methods, 25);
}

}  // namespace
}  // namespace palpate
