#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "cli/missing_outputs.h"
#include "cli/program.h"
#include "cli/scene_of.h"
#include "commands.h"
#include "core/time_text.h"
#include "run.h"

namespace palpate::cli {
namespace {

struct ResumeArguments {
  std::string run;  ///< Folder of a run with checkpoints
};

int resume(const ResumeArguments& arguments) {
  if (session::is_finished_run(arguments.run)) {
    fmt::print("{}: the run is complete; there is nothing to resume\n", arguments.run);
    return 0;
  }
  session::Resumption resumption = session::read_resumption(arguments.run);
  for (const std::string& line : session::processor_differences(resumption))
    fmt::print(stderr, "palpate: {}\n", line);
  const scene::Description description = session::scene_to_resume(
      resumption, [](const scene::SceneArguments& scene) { return cli::scene_of(scene); });
  fmt::print("{} resumes at t = {} s\n", arguments.run, time_text(resumption.checkpoint.time_s));
  MissingOutputs missing;
  return missing.close(resume_run(resumption, description, missing));
}

}  // namespace

void add_resume(CLI::App& app, Invocation& invocation) {
  CLI::App* command = app.add_subcommand("resume", "continue an interrupted run");
  auto arguments = std::make_shared<ResumeArguments>();
  command->add_option("run", arguments->run, "folder of a run, which contains checkpoint.h5")
      ->required()
      ->type_name("DIR");
  command->footer(R"(Examples:
  palpate run two-heads --checkpoint-every 0.1 -o out/heads
  palpate resume out/heads                       after Ctrl-C, a kill, or a loss of power

The run continues from its last checkpoint with its original options.  Its results are bitwise identical to
those of an uninterrupted run: data recorded after the checkpoint are truncated and computed again.  Requires
the same version of palpate, the same scene and meshes.  Exit status 0 if the run is already complete.)");
  command->callback([arguments, &invocation] {
    invocation.action = [arguments] { return resume(*arguments); };
    invocation.factorises = true;
  });
}

}  // namespace palpate::cli
