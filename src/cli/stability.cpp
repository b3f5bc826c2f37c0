// `palpate stability`: runs --haptic, and starts palpate-validation for the matrix of cases.
#include <memory>

#include "cli/other_program.h"
#include "cli/program.h"
#include "cli/stability_options.h"
#include "commands.h"
#include "stability_haptic.h"

namespace palpate::cli {

void add_stability(CLI::App& app, Invocation& invocation) {
  add_stability(app, [&invocation](const std::shared_ptr<StabilityArguments>& arguments) {
    if (arguments->haptic) {
      invocation.action = [arguments] { return stability_haptic(*arguments); };
      invocation.factorises = true;
    } else {
      invocation.action = [words = invocation.words] { return start(kStability, words); };
    }
  });
}

}  // namespace palpate::cli
