#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "cli/missing_outputs.h"
#include "cli/program.h"
#include "commands.h"
#include "compare.h"
#include "report/run_report.h"
#include "run.h"

namespace palpate::cli {
namespace {

struct DemoArguments {
  std::string folder = "out/demo";
};

/// Runs a scene with its picture.  @return the exit status
int press(const std::string& scene, const std::string& folder, MissingOutputs& missing) {
  session::Options touch;
  touch.scene.scene = scene;
  touch.folder = folder;
  touch.picture = true;
  return run(touch, missing);
}

int demo(const DemoArguments& arguments) {
  const std::string head = arguments.folder + "/head";
  MissingOutputs missing;
  fmt::print("1. A finger presses a head of 10,000 tetrahedra: approach, touch, hold, release.\n\n");
  if (const int status = press("press-head", head, missing); status != 0) return missing.close(status);

  fmt::print("\n2. A tool presses a ball of 1,280 tetrahedra, small enough for a reference solution.\n\n");
  if (const int status = press("press-ball", arguments.folder, missing); status != 0)
    return missing.close(status);

  fmt::print("\n3. Error and run time of two integrators for the ball:\n\n");
  CompareArguments cost;
  cost.scenes = {"press-ball"};
  cost.folder = arguments.folder;
  cost.integrators = {"cvode-bdf", "linearly-implicit-euler"};
  cost.limit_s = 1.6;
  cost.repeats = 2;
  // Reference a thousand times more accurate than these two, at a third of the time of the default reference;
  // two exchange periods instead of four; no chart of restarts.
  cost.overrides = {"compare.reference_rtol=1e-9", "compare.reference_check_rtol=1e-8",
                    "compare.exchange_periods_s=[0.02, 0.01]", "compare.refresh_periods_s=[]"};
  if (const int status = compare(cost, missing); status != 0) return missing.close(status);

  fmt::print("\nError of the force due to the mesh and the contact points, from one finer level:\n\n");
  print_mesh_error("press-ball", arguments.folder);

  const std::filesystem::path page = std::filesystem::path(arguments.folder) / "report.html";
  const report::RunReport written = report::write_report({head, arguments.folder}, page);
  report::add_missing(written, missing);
  fmt::print("\nhead and ball on one page: {}\n", written.page.string());
  return missing.close(0);
}

}  // namespace

void add_demo(CLI::App& app, Invocation& invocation) {
  CLI::App* command = app.add_subcommand(
      "demo", "press a head and a soft ball with a tool: pictures, force curves, error and run time");
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
