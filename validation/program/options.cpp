#include "options.h"

#include <CLI/CLI.hpp>
#include <memory>

#include "cli/other_program.h"
#include "palpate/core/error.h"

namespace palpate::cli {
namespace {

void add_validate(CLI::App& app, Invocation& invocation) {
  CLI::App* command = app.add_subcommand(std::string(kValidate.command), kValidate.summary);
  auto arguments = std::make_shared<ValidateArguments>();
  command->add_option("CASE", arguments->cases, "only these cases; see `palpate list cases`");
  CLI::Option* slow = command->add_flag("--slow", arguments->slow,
                                        "also run the cases that take minutes: a quarter of an hour on one "
                                        "core");
  command
      ->add_flag("--quick", arguments->quick,
                 "only the cases that take seconds: a minute for all of them on one core")
      ->excludes(slow);
  command
      ->add_option("--jobs", arguments->jobs,
                   "number of parallel cases, each in a separate process; default: number of cores. 1 gives "
                   "undisturbed run times")
      ->check(CLI::Range(1, 1024));
  command->add_flag("--inject-faults", arguments->inject_faults,
                    "inject faults into the library: the measurement of each fault must then fail");
  command->add_flag("--sabotage", arguments->inject_faults)->group("");  // Its name before 0.1, hidden.
  command->add_option("-o,--output", arguments->folder, "also write validation.json and report.html here")
      ->type_name("DIR");
  CLI::Option* fresh =
      command->add_flag("--fresh", arguments->fresh,
                        "start anew instead of keeping the results of earlier calls in the folder");
  add_array_options(*command, arguments->array)->excludes(fresh);
  command->footer(R"(Examples:
  palpate validate
  palpate validate patch-test cantilever -o out/validation
  palpate validate --inject-faults               shows that the cases can fail

With -o, results are kept in DIR/results.db: after Ctrl-C or a crash the same command continues where it
stopped.  Exit status 0 if every measurement meets its acceptance limit, else 1.)");
  command->callback([arguments, &invocation] {
    invocation.action = [arguments] { return validate(*arguments); };
    invocation.factorises = true;
    invocation.starts_processes = true;
  });
}

void add_matrix(CLI::App& app, Invocation& invocation) {
  add_stability(app, [&invocation](const std::shared_ptr<StabilityArguments>& arguments) {
    if (arguments->haptic) fail("--haptic: call `palpate stability --haptic`");
    invocation.action = [arguments] { return stability(*arguments); };
    invocation.factorises = true;
    invocation.starts_processes = true;
  });
}

void add_commands(CLI::App& app, Invocation& invocation) {
  add_validate(app, invocation);
  add_matrix(app, invocation);
  app.add_subcommand(std::string(kCases.command), kCases.summary)->callback([&invocation] {
    invocation.action = print_cases;
  });
}

}  // namespace

Invocation parse_validation(int argc, char** argv) {
  return parse_line(argc, argv,
                    {"palpate-validation: the program behind `palpate validate` and `palpate stability`.", "",
                     add_commands});
}

}  // namespace palpate::cli
