#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "cli/missing_outputs.h"
#include "cli/program.h"
#include "commands.h"
#include "compare.h"
#include "run.h"

namespace palpate::cli {
namespace {

struct DemoArguments {
  std::string folder = "out/demo";
};

int demo(const DemoArguments& arguments) {
  fmt::print("A tool on the virtual spring of a hand presses a soft ball on a plane.\n\n");
  session::Options touch;
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

}  // namespace

void add_demo(CLI::App& app, Invocation& invocation) {
  CLI::App* command =
      app.add_subcommand("demo", "press a soft ball with a tool: picture, force curve, error and run time");
  auto arguments = std::make_shared<DemoArguments>();
  command->add_option("-o,--output", arguments->folder, "folder for the results")
      ->type_name("DIR")
      ->capture_default_str();
  command->footer(
      "Example:\n  palpate demo                                   then open out/demo/report.html");
  command->callback([arguments, &invocation] {
    invocation.action = [arguments] { return demo(*arguments); };
    invocation.factorises = true;
    invocation.starts_processes = true;
  });
}

}  // namespace palpate::cli
