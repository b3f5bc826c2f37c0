// What rtol buys, of every method with error control: the table of docs/tolerances.md.
#include "integrate/tolerance_table.h"

namespace palpate {
namespace {

using namespace fakes;

// Methods of order 2 and 3 stop at 1e-8: a decade more is two to three times as many steps.
TEST(Tolerance, EveryMethodBuysTheErrorThatItSays) {
  for (const ToleranceScene& scene : tolerance_scenes()) {
    const References references(scene);
    for (const auto& entry : integrate::stepper_registry()) {
      if (entry.traits.control == StepControl::kFixed) continue;
      const std::string row =
          expect_within_band(scene, references, entry, entry.traits.order <= 3 ? 1e-8 : 1e-10, 0.1);
      fmt::print("{}\n", row);
    }
  }
}

}  // namespace
}  // namespace palpate
