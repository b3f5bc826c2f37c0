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
      "run as a Slurm array job, whose nodes share the folders; waits for it, then prints the same table");
  command
      .add_option("--slurm-options", arguments.slurm_options,
                  "options of sbatch for every element: \"--partition=short --time=10\"")
      ->type_name("TEXT")
      ->needs(slurm);
  command
      .add_option(
          "--chunk", arguments.chunk,
          "minimum number of tasks per element, run one after another; more if the site's MaxArraySize "
          "requires it")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str()
      ->needs(slurm);
  command.add_flag("--no-wait", arguments.no_wait, "submit and return at once")->needs(slurm);
}

}  // namespace

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
  command
      ->add_option("--task", arguments->tasks,
                   "run only these tasks, without a table, as an element of an array job does: 0-3,7")
      ->type_name("LIST")
      ->excludes(dry)
      ->excludes(merge)
      ->excludes(fresh);
  command
      ->add_option("--plan", arguments->plan,
                   "fail unless the list of tasks has this key; array jobs pass it, so that a study that was "
                   "changed after submission is not run")
      ->type_name("KEY");
  add_slurm_options(*command, *arguments);
  command->footer(R"(Examples:
  palpate study stiffness.toml --dry-run         list of tasks
  palpate study stiffness.toml -o out/stiffness
  palpate study stiffness.toml -o out/stiffness --slurm --slurm-options "--partition=short --time=10"
  palpate study stiffness.toml -o out/stiffness --merge

Each task runs in a separate process under the study's limit_s, and writes one file, DIR/tasks/KEY.json.
Repeat the command to run the tasks without a file: after Ctrl-C, a crash, or the loss of a node.

Writes study.csv (the same bytes for every way of running it), study-times.csv (times and machines),
summary.json and report.html.  Exit status 0 if every task has a result of any status; 3 if results are
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
