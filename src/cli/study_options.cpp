#include <CLI/CLI.hpp>
#include <memory>

#include "cli/program.h"
#include "commands.h"
#include "study.h"

namespace palpate::cli {
namespace {

void add_slurm_options(CLI::App& command, StudyArguments& arguments) {
  CLI::Option* slurm = command.add_flag(
      "--slurm", arguments.slurm,
      "as an array job of Slurm, whose nodes see the same folders; waits for it, then prints the same table");
  command
      .add_option("--slurm-options", arguments.slurm_options,
                  "of sbatch, for every element: \"--partition=short --time=10\"")
      ->type_name("TEXT")
      ->needs(slurm);
  command
      .add_option(
          "--chunk", arguments.chunk,
          "tasks that an element runs one after another, at least; more where the site's MaxArraySize "
          "asks for it")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str()
      ->needs(slurm);
  command.add_flag("--no-wait", arguments.no_wait, "submit, and return at once")->needs(slurm);
}

}  // namespace

void add_study(CLI::App& app, Invocation& invocation) {
  CLI::App* command = app.add_subcommand(
      "study", "many runs: scenes x integrators x tolerances x parameters x seeds, on all cores or by Slurm");
  auto arguments = std::make_shared<StudyArguments>();
  command->add_option("STUDY", arguments->study, "a study file (.toml): see `palpate help studies`")
      ->required();
  command->add_option("-o,--output", arguments->folder, "folder for the results; default out/study-STUDY")
      ->type_name("DIR");
  command
      ->add_option("--jobs", arguments->jobs,
                   "tasks side by side; default: as many as there are cores for their threads")
      ->check(CLI::Range(1, 1024));
  CLI::Option* dry =
      command->add_flag("--dry-run", arguments->dry_run, "print the list of tasks, and run none");
  CLI::Option* merge = command
                           ->add_flag("--merge", arguments->merge,
                                      "make the table of the results that there are, and run nothing")
                           ->excludes(dry);
  CLI::Option* fresh = command
                           ->add_flag("--fresh", arguments->fresh,
                                      "start anew instead of keeping what earlier calls have finished")
                           ->excludes(dry)
                           ->excludes(merge);
  command
      ->add_option("--task", arguments->tasks,
                   "only these tasks, and no table, as an element of an array job does: 0-3,7")
      ->type_name("LIST")
      ->excludes(dry)
      ->excludes(merge)
      ->excludes(fresh);
  command
      ->add_option("--plan", arguments->plan,
                   "refuse to run where the list of tasks has not this key: an array job says it, so that a "
                   "study which was changed since is not taken for the one that was submitted")
      ->type_name("KEY");
  add_slurm_options(*command, *arguments);
  command->footer(R"(Examples:
  palpate study stiffness.toml --dry-run         which tasks there are
  palpate study stiffness.toml -o out/stiffness
  palpate study stiffness.toml -o out/stiffness --slurm --slurm-options "--partition=short --time=10"
  palpate study stiffness.toml -o out/stiffness --merge

Each task runs in a process of its own under the study's limit_s, and leaves one file, DIR/tasks/KEY.json.
The same command again runs only what has none: after Ctrl-C, a crash, a node that was lost.

Writes study.csv (the same bytes whichever way it was run), study-times.csv (times and machines),
summary.json and report.html.  Exit status 0 when every task has a result, whatever it is; 3 when results are
missing.)");
  command->callback([arguments, &invocation] {
    if (arguments->slurm && (arguments->dry_run || arguments->merge || !arguments->tasks.empty()))
      throw CLI::ExcludesError("--slurm", "--dry-run, --merge and --task");
    invocation.action = [arguments] { return study(*arguments); };
    invocation.factorises = true;
    invocation.starts_processes = true;
  });
}

}  // namespace palpate::cli
