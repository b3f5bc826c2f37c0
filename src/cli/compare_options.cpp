#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "cli/option_checks.h"
#include "cli/program.h"
#include "commands.h"
#include "compare.h"
#include "scene_options.h"

namespace palpate::cli {
namespace {

constexpr const char* kCompareExamples = R"(Examples:
  palpate compare cantilever
  palpate compare cantilever press-ball --limit-s 5 -o out/both
  palpate compare press-ball --repeats 1 --integrator cvode-bdf --integrator linearly-implicit-euler
  palpate compare --haptic press-ball            error of its force, and its sources
  palpate compare --mesh press-ball              error of its force due to the mesh

Each point is one integrator at one tolerance or step size, at the scene's fixed exchange period, in a
separate process, compared with a tight reference whose error is printed.  The refinement sequences are the
scene's [[compare.ladder]], and a default for each other integrator, down to errors that the reference cannot
resolve or to --limit-s.  A winner is reported only if the spreads of times and levels do not overlap.
After Ctrl-C or a crash the same command continues where it stopped.  Writes compare.csv, reference.json,
results.db (one row per run) and report.html.

With --haptic one setting at a time differs from the scene, as listed in its [compare.haptic].  Points run
one at a time unless --jobs is given, with limits of 120 s of CPU time per point and 1800 s per reference
unless --limit-s and --reference-limit-s are given.  Writes haptic.csv, summary.json, results.db and
report.html.

With --mesh elements, skin and contact points are refined by two, one at a time and together; the force on
the hand on each level gives the order and an estimate for elements of size zero, with its uncertainty.  All
levels have the same accurate time integration, whose error is printed.  Meshes of files are divided in
place: the shape of the body stays as it is.  Writes mesh.csv, summary.json, results.db, report.html and the
refined meshes.)";

void add_method_options(CLI::App& command, CompareArguments& arguments) {
  command
      .add_option("--integrator", arguments.integrators,
                  "only this integrator: a name of `palpate list integrators`, or the label of a "
                  "[[compare.ladder]]; may be given more than once")
      ->type_name("NAME")
      ->allow_extra_args(false);
  command.add_flag("--all", arguments.all,
                   "every time integrator, in addition to those given; the default if none is given");
  command
      .add_option("--repeats", arguments.repeats,
                  "maximum number of runs per point, for the spread of its time")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command.add_option("--limit-s", arguments.limit_s, "limit of the CPU time per point [s]")
      ->type_name("SECONDS")
      ->check(duration)
      ->capture_default_str();
  command
      .add_option("--reference-limit-s", arguments.reference_limit_s,
                  "limit of the CPU time of a reference, and of its check [s]")
      ->type_name("SECONDS")
      ->check(duration)
      ->capture_default_str();
  command
      .add_option(
          "--linear-solver", arguments.linear_solver,
          "for all implicit methods: a name of `palpate list linear-solvers`; best: the fastest for each "
          "method, found by trial; named: that of the scene, else the default of the method")
      ->type_name("NAME|best|named")
      ->capture_default_str();
  command
      .add_option(
          "--jobs", arguments.jobs,
          "number of parallel runs, which disturb each other's times; default: references on all cores, "
          "all other runs one at a time")
      ->check(CLI::Range(1, 1024));
}

/// Checks the options that --mesh excludes, and sets its limit where none was given.
void settle_mesh(const CLI::App& command, CompareArguments& arguments) {
  for (const char* only : {"--levels", "--coarser", "--json"})
    if (!arguments.mesh && command.count(only) > 0) throw CLI::RequiresError(only, "--mesh");
  if (!arguments.mesh) return;
  for (const char* other : {"--haptic", "--all", "--integrator", "--linear-solver", "--repeats",
                            "--reference-limit-s", "--slurm", "--task"})
    if (command.count(other) > 0) throw CLI::ExcludesError("--mesh", other);
  if (arguments.coarser >= arguments.levels)
    throw CLI::ValidationError("--coarser", fmt::format("must be less than --levels, {}", arguments.levels));
  if (command.count("--limit-s") == 0) arguments.limit_s = 900.0;
}

void add_mesh_options(CLI::App& command, CompareArguments& arguments) {
  command.add_flag("--mesh", arguments.mesh,
                   "instead, for one scene: error of the force on the hand due to the size of elements, the "
                   "skin and the number of contact points, by refinement");
  command
      .add_option("--levels", arguments.levels,
                  "with --mesh: number of levels; each divides elements, skin and spacing of points by two")
      ->check(CLI::Range(2, 6))
      ->capture_default_str();
  command
      .add_option("--coarser", arguments.coarser,
                  "with --mesh: number of these levels that are coarser than the scene; only for generated "
                  "bodies and for shapes (model:NAME)")
      ->check(CLI::Range(0, 4))
      ->capture_default_str();
  command.add_flag("--json", arguments.json, "with --mesh: print the results as JSON, as in summary.json");
}

/// Checks the options that --haptic excludes, and sets its limits where none were given.
void settle_haptic(const CLI::App& command, CompareArguments& arguments) {
  for (const char* other : {"--all", "--linear-solver"})
    if (arguments.haptic && command.count(other) > 0) throw CLI::ExcludesError("--haptic", other);
  if (arguments.haptic && command.count("--limit-s") == 0) arguments.limit_s = 120.0;
  if (arguments.haptic && command.count("--reference-limit-s") == 0) arguments.reference_limit_s = 1800.0;
}

}  // namespace

void add_compare(CLI::App& app, Invocation& invocation) {
  CLI::App* command = app.add_subcommand(
      "compare", "measure error against run time of every integrator on one or more scenes");
  auto arguments = std::make_shared<CompareArguments>();
  command->add_option("SCENE", arguments->scenes, "scene files (.toml), or names of included scenes")
      ->required();
  command
      ->add_option("--set", arguments->overrides,
                   "change one value of every scene: KEY=VALUE, as for `palpate run`")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  add_beyond_memory(*command);
  add_method_options(*command, *arguments);
  CLI::Option* fresh = command->add_flag("--fresh", arguments->fresh,
                                         "start anew instead of continuing the comparison in the folder");
  add_array_options(*command, arguments->array)->excludes(fresh);
  command->add_flag(
      "--haptic", arguments->haptic,
      "instead, for one scene: error of force and torque on the hand against the monolithic "
      "solution, over exchange period, haptic rate, contact resolution, integrator, linearisation");
  add_mesh_options(*command, *arguments);
  command->add_option("--duration-s", arguments->duration_s, "simulated time, instead of the scenes' [s]")
      ->type_name("SECONDS")
      ->check(duration);
  command->add_option("-o,--output", arguments->folder, "folder for the results; default out/compare-SCENE")
      ->type_name("DIR");
  command->footer(kCompareExamples);
  command->callback([arguments, command, &invocation] {
    settle_haptic(*command, *arguments);
    settle_mesh(*command, *arguments);
    invocation.action = [arguments] {
      if (arguments->mesh) return compare_mesh(*arguments);
      return arguments->haptic ? compare_haptic(*arguments) : compare(*arguments);
    };
    invocation.factorises = true;
    invocation.starts_processes = true;
  });
}

}  // namespace palpate::cli
