// Error achieved per rtol for every error-controlled method: the table of docs/tolerances.md.
#include "integrate/tolerance_table.h"

namespace palpate {
namespace {

using namespace fakes;

// Methods of order 2 and 3 end at 1e-8: another decade needs two to three times as many steps.
template <class Applies>
void expect_within_bands(const ToleranceScene& scene, Applies applies) {
  const References references(scene);
  for (const auto& entry : integrate::stepper_registry()) {
    if (entry.traits.control == StepControl::kFixed || !applies(entry)) continue;
    const std::string row =
        expect_within_band(scene, references, entry, entry.traits.order <= 3 ? 1e-8 : 1e-10, 0.1);
    fmt::print("{}\n", row);
  }
}

TEST(Tolerance, EveryMethodBuysTheErrorThatItSays) {
  for (const ToleranceScene& scene : tolerance_scenes())
    expect_within_bands(scene, [](const auto&) { return true; });
}

TEST(Tolerance, AdditiveMethodsBuyItWithContactExplicit) { expect_within_bands(split_scene(), is_additive); }

// A force with a kink at onset. The reference uses a ten-thousandth of the tightest tolerance.
TEST(Tolerance, BackwardDifferencesBuyItAtKinks) {
  const ToleranceScene scene{"block, kinks", +[] {
                               auto block = sharply_landing_block();
                               block->duration = 0.06;
                               return block;
                             }};
  const References references(scene);
  for (const auto& entry : integrate::stepper_registry()) {
    if (entry.traits.control == StepControl::kFixed || entry.traits.order <= 2) continue;
    std::string row = fmt::format("{:<14} {:<23}", scene.name, entry.name);
    for (const double rtol : {1e-4, 1e-6, 1e-8}) {
      const Course c = course(scene, {.name = entry.name, .rtol = rtol, .max_steps = 100000000});
      const double ratio = over_wanted(scene, c, references.of_another_family(entry.traits), rtol);
      row += fmt::format(" {:7.2g}", ratio);
      if (entry.name != "cvode-bdf" && entry.name != "ida") continue;
      EXPECT_GE(ratio, 0.1) << entry.name << ", rtol " << rtol;
      EXPECT_LE(ratio, 10.0) << entry.name << ", rtol " << rtol;
    }
    fmt::print("{}\n", row);
  }
}

}  // namespace
}  // namespace palpate
