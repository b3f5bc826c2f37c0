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
  palpate compare --haptic press-ball            how far its force is from the exact one, and why

Each point is one integrator at one tolerance or step, at the scene's fixed exchange period, in a process of
its own, against a tight reference whose own error is printed.  The ladders are the scene's
[[compare.ladder]], and a default one for every other integrator, down to where the reference cannot tell
errors or --limit-s ends it.  A winner is named only where the spreads of times and rungs do not overlap.
Ctrl-C or a crash loses nothing: the same line goes on where it stopped.  Writes compare.csv, reference.json,
study.sqlite (one row a run) and report.html.

With --haptic one thing at a time differs from the scene, as its [compare.haptic] says; points run one at a
time unless --jobs is given, and have 120 s of CPU each, references 1800, unless --limit-s and
--reference-limit-s are given.  Writes haptic.csv, summary.json, study.sqlite and report.html.)";

void add_method_options(CLI::App& command, CompareArguments& arguments) {
  command
      .add_option("--integrator", arguments.integrators,
                  "only this one: a name of `palpate list integrators`, or the label of a "
                  "[[compare.ladder]]; may be given more than once")
      ->type_name("NAME")
      ->allow_extra_args(false);
  command.add_flag(
      "--all", arguments.all,
      "every integrator that moves in time, beside those named: the default where none is named");
  command
      .add_option("--repeats", arguments.repeats, "runs of each point at most, for the spread of its time")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command.add_option("--limit-s", arguments.limit_s, "CPU time of a point [s]")
      ->type_name("SECONDS")
      ->check(duration)
      ->capture_default_str();
  command
      .add_option("--reference-limit-s", arguments.reference_limit_s,
                  "CPU time of a reference, and of its check [s]")
      ->type_name("SECONDS")
      ->check(duration)
      ->capture_default_str();
  command
      .add_option("--linear-solver", arguments.linear_solver,
                  "of all implicit methods: a name of `palpate list linear-solvers`; best: each method's "
                  "fastest, found by trying; named: the scene's, or the method's own")
      ->type_name("NAME|best|named")
      ->capture_default_str();
  command
      .add_option("--jobs", arguments.jobs,
                  "runs side by side, at the expense of their times; default: references on all cores, all "
                  "else alone")
      ->check(CLI::Range(1, 1024));
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
  CLI::App* command =
      app.add_subcommand("compare", "error against run time of every integrator on one scene or several");
  auto arguments = std::make_shared<CompareArguments>();
  command
      ->add_option("SCENE", arguments->scenes,
                   "one or several: a scene file (.toml), or the name of one that comes with palpate")
      ->required();
  command
      ->add_option("--set", arguments->overrides,
                   "change one value of every scene: KEY=VALUE, as for `palpate run`")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  add_beyond_memory(*command);
  add_method_options(*command, *arguments);
  command->add_flag("--fresh", arguments->fresh, "start anew instead of continuing the study in the folder");
  command->add_flag(
      "--haptic", arguments->haptic,
      "instead, of one scene: force and torque on the hand against tool and bodies as one "
      "system, over exchange period, haptic rate, contact resolution, integrator, linearisation");
  command->add_option("--duration-s", arguments->duration_s, "simulated time, instead of the scenes' [s]")
      ->type_name("SECONDS")
      ->check(duration);
  command->add_option("-o,--output", arguments->folder, "folder for the results; default out/compare-SCENE")
      ->type_name("DIR");
  command->footer(kCompareExamples);
  command->callback([arguments, command, &invocation] {
    settle_haptic(*command, *arguments);
    invocation.action = [arguments] {
      return arguments->haptic ? compare_haptic(*arguments) : compare(*arguments);
    };
    invocation.factorises = true;
    invocation.starts_processes = true;
  });
}

}  // namespace palpate::cli
