#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "checkpoints.h"
#include "cli/missing_outputs.h"
#include "cli/program.h"
#include "cli/scene_of.h"
#include "commands.h"
#include "core/time_text.h"
#include "palpate/core/error.h"
#include "store/provenance.h"
#include "store/summary.h"

namespace palpate::cli {
namespace {

struct ResumeArguments {
  std::string run;  ///< Folder of a run with checkpoints
};

/// Returns whether the run in the folder is finished.
bool is_complete(const std::filesystem::path& folder) {
  const std::filesystem::path summary = folder / "summary.json";
  return std::filesystem::exists(summary) && store::read_summary(summary.string()).outcome == "finished";
}

void check_version(const Resumption& r) {
  if (const std::string ours = store::full_version(); r.checkpoint.version != ours)
    fail(
        "{}: was written by palpate {}, but this is {}; a run can only be resumed by the same version. Use "
        "that version, or run the scene again",
        checkpoint_path(r.folder), r.checkpoint.version, ours);
}

/// Reports differences of processor and instruction set, which change the rounding of the rest of the run.
void compare_processors(const Resumption& r) {
  const auto compare = [](const char* what, const std::string& then, const std::string& now) {
    if (then != now)
      fmt::print(stderr,
                 "palpate: the run began {} ({}, this is {}); it continues, but its results are not bitwise "
                 "identical to those of an uninterrupted run\n",
                 what, then, now);
  };
  compare("on another processor", r.identity.cpu, store::provenance().cpu);
  compare("with another instruction set", r.identity.instructions, instructions_in_use());
}

scene::Description scene_of(const Resumption& r) {
  SceneArguments scene = r.identity.arguments.scene;
  scene.scene = r.identity.scene_path;
  if (!std::filesystem::exists(scene.scene))
    fail("{}: the scene of this run no longer exists; restore it, or start a new run", scene.scene);
  const scene::Description description = scene_of(scene);
  if (description.source != r.checkpoint.scene_source)
    fail(
        "{}: the scene has changed since the run began, so the recorded data do not belong to it; restore "
        "the old scene, or run it again",
        scene.scene);
  return description;
}

int resume(const ResumeArguments& arguments) {
  const std::filesystem::path folder(arguments.run);
  if (!std::filesystem::is_directory(folder))
    fail("{}: no such folder; give the folder of a run", arguments.run);
  if (is_complete(folder)) {
    fmt::print("{}: the run is complete; there is nothing to resume\n", arguments.run);
    return 0;
  }
  const std::string path = checkpoint_path(arguments.run);
  if (!std::filesystem::exists(path))
    fail(
        "{}: no checkpoint; the run was started without --checkpoint-every, or ended before its first "
        "checkpoint; run the scene again",
        path);
  Resumption r{arguments.run, {}, store::read_checkpoint(path), {}};
  r.from.archive = Archive(r.checkpoint.values, path);
  check_version(r);
  r.from.archive("command", r.identity);
  compare_processors(r);
  const scene::Description description = scene_of(r);
  fmt::print("{} resumes at t = {} s\n", arguments.run, time_text(r.checkpoint.time_s));
  MissingOutputs missing;
  return missing.close(resume_run(r, description, missing));
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
