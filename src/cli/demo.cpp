#include <fmt/format.h>

#include "cli/missing_outputs.h"
#include "commands.h"

namespace palpate::cli {

int demo(const DemoArguments& arguments) {
  fmt::print("A tool on the virtual spring of a hand presses a soft ball on a plane.\n\n");
  RunArguments touch;
  touch.scene.scene = "press-ball";
  touch.folder = arguments.folder;
  touch.picture = true;
  MissingOutputs missing;
  if (const int status = run(touch, missing); status != 0) return missing.close(status);

  fmt::print("\nError and run time of each integrator on the same scene:\n\n");
  CompareArguments price;
  price.scenes = {touch.scene.scene};
  price.folder = arguments.folder;
  price.integrators = {"cvode-bdf", "linearly-implicit-euler"};
  price.limit_s = 2.0;
  // reference a thousand times more accurate than these two, at a third of the time of the default reference
  price.overrides = {"compare.reference_rtol=1e-9", "compare.reference_check_rtol=1e-8"};
  return missing.close(compare(price, missing));
}

}  // namespace palpate::cli
