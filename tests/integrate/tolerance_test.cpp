// Error achieved per rtol: one method per family; tolerance_slow_test.cpp has all methods over every decade.
#include "integrate/tolerance_table.h"

#include "palpate/core/error.h"

namespace palpate {
namespace {

using namespace fakes;

TEST(Tolerance, BuysTheErrorThatItSays) {
  for (const ToleranceScene& scene : tolerance_scenes()) {
    const References references(scene);
    EXPECT_LT(over_wanted(scene, references.explicit_, references.implicit, 1e-10), 0.1) << scene.name;
    for (const char* name : {"cvode-bdf", "cvode-adams", "ida", "ark-erk-5", "ark-dirk-kvaerno423",
                             "ark-dirk-ark436", "ark-imex-4"})
      expect_within_band(scene, references, find(integrate::stepper_registry(), name, "integrator"), 1e-7,
                         1e-2);
  }
}

TEST(Tolerance, OfASplitSystemBuysTheErrorThatItSays) {
  const ToleranceScene scene = split_scene();
  const References references(scene);
  for (const auto& entry : integrate::stepper_registry())
    if (is_additive(entry)) expect_within_band(scene, references, entry, 1e-7, 1e-2);
}

std::string refusal(const IntegratorSpec& spec) {
  Chain chain;
  try {
    integrate::make_stepper(chain.system, chain.state, spec);
  } catch (const Error& e) { return e.what(); }
  return {};
}

// No request is fulfilled partially: an unsupported tolerance is rejected, with the supported range.
TEST(Tolerance, BeyondAMethodsReachIsRefused) {
  EXPECT_EQ(refusal({.name = "cvode-bdf", .rtol = 1e-10}), "");
  EXPECT_EQ(refusal({.name = "cvode-bdf", .rtol = 9e-11}),
            "integrator \"cvode-bdf\": rtol = 9e-11 is below 1e-10, the smallest value that this method can "
            "reach; below it, rounding dominates");
  EXPECT_EQ(refusal({.name = "ark-dirk-cash524", .rtol = 1e-10}),
            "integrator \"ark-dirk-cash524\": rtol = 1e-10 is below 4.6e-10, the smallest value that this "
            "method can reach; below it, rounding dominates");
  EXPECT_EQ(refusal({.name = "ida", .rtol = 1e-8, .max_order = 2}), "");
  EXPECT_EQ(refusal({.name = "ida", .rtol = 9e-9, .max_order = 2}),
            "integrator \"ida\": rtol = 9e-09 is below 1e-08, the smallest value that this method can reach "
            "with max_order = 2; below it, rounding dominates");
  for (const auto& entry : integrate::stepper_registry()) {
    EXPECT_EQ(entry.tightest_rtol == nullptr, entry.error_test_rtol == nullptr) << entry.name;
    if (!entry.tightest_rtol) continue;
    IntegratorSpec spec{.name = entry.name};
    spec.rtol = entry.tightest_rtol(spec);
    EXPECT_EQ(refusal(spec), "");
    spec.rtol *= 0.99;
    EXPECT_NE(refusal(spec), "") << entry.name;
  }
}

// Two requested tolerances are two error tests, down to the tightest.
TEST(Tolerance, NoTwoRequestsAreOneRun) {
  for (const auto& entry : integrate::stepper_registry()) {
    if (!entry.error_test_rtol) continue;
    IntegratorSpec spec{.name = entry.name};
    double before = HUGE_VAL;
    for (spec.rtol = 0.1; spec.rtol >= entry.tightest_rtol(spec); spec.rtol *= 0.5) {
      const double used = entry.error_test_rtol(spec);
      EXPECT_LT(used, 0.75 * before) << entry.name << ", rtol " << spec.rtol;
      EXPECT_EQ(integrate::error_test_rtol_of(spec), used);
      before = used;
    }
    spec.fixed_step = true;
    EXPECT_FALSE(integrate::error_test_rtol_of(spec)) << entry.name;
  }
}

}  // namespace
}  // namespace palpate
