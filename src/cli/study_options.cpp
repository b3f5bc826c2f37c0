#include <CLI/CLI.hpp>
#include <memory>

#include "cli/program.h"
#include "commands.h"
#include "study.h"

namespace palpate::cli {
void add_study(CLI::App& app, Invocation& invocation) {
  CLI::App* command = app.add_subcommand(
      "study", "run scenes x integrators x tolerances x parameters x seeds, on all cores or by Slurm");
  auto arguments = std::make_shared<StudyArguments>();
  command->add_option("STUDY", arguments->study, "a study file (.toml): see `palpate help studies`")
      ->required();
  command->add_option("-o,--output", arguments->folder, "folder for the results; default out/study-STUDY")
      ->type_name("DIR");
  command
      ->add_option("--jobs", arguments->jobs,
                   "number of parallel tasks; default: the number of cores over the threads per task")
      ->check(CLI::Range(1, 1024));
  CLI::Option* dry =
      command->add_flag("--dry-run", arguments->dry_run, "print the list of tasks without running them");
  CLI::Option* merge =
      command
          ->add_flag("--merge", arguments->merge, "write the table of the existing results, and run nothing")
          ->excludes(dry);
  CLI::Option* fresh = command
                           ->add_flag("--fresh", arguments->fresh,
                                      "start anew instead of keeping the results of earlier calls")
                           ->excludes(dry)
                           ->excludes(merge);
  add_array_options(*command, arguments->array)->excludes(dry)->excludes(merge)->excludes(fresh);
  command->footer(R"(Examples:
  palpate study stiffness.toml --dry-run         list of tasks
  palpate study stiffness.toml -o out/stiffness
  palpate study stiffness.toml -o out/stiffness --slurm --slurm-options "--partition=short --time=10"
  palpate study stiffness.toml -o out/stiffness --merge

Each task runs in a separate process under the study's limit_s; DIR/results.db keeps its result.
Repeat the command to run the tasks without a result: after Ctrl-C, a crash, or the loss of a node.

Writes study.csv (the same bytes for every way of running it), study-times.csv (times and machines),
summary.json and report.html.  Exit status 0 if every task has a result of any status; 3 if results are
missing.)");
  command->callback([arguments, &invocation] {
    if (arguments->array.slurm && (arguments->dry_run || arguments->merge))
      throw CLI::ExcludesError("--slurm", "--dry-run and --merge");
    invocation.action = [arguments] { return study(*arguments); };
    invocation.factorises = true;
    invocation.starts_processes = true;
  });
}

}  // namespace palpate::cli
