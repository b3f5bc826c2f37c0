#include "loop/replay.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "cli/paths.h"
#include "cli/program.h"
#include "cli/progress.h"
#include "cli/scene_of.h"
#include "cli/stop.h"
#include "commands.h"
#include "core/clock.h"
#include "core/time_text.h"
#include "experiments/compare/perceptible_difference.h"
#include "loop/summary.h"
#include "palpate/core/error.h"
#include "palpate/loop/recorder.h"
#include "palpate/scene/hands.h"
#include "recorded_scene.h"
#include "session/run_files.h"
#include "store/atomic_file.h"
#include "store/folder_lock.h"

namespace palpate::cli {
namespace {

struct ReplayArguments {
  std::string run;                     ///< Folder of a run
  std::vector<std::string> overrides;  ///< Changes of keys of its scene
  std::string integrator;              ///< Integrator that replaces the one of the run; empty: unchanged
  std::string folder;                  ///< Output folder; empty: out/replay-NAME
  bool changes() const { return !overrides.empty() || !integrator.empty(); }
};

std::string text_of_file(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path))
    fail("{}: no such file; a replay needs the folder of a finished run", path.string());
  return read_text(path.string());
}

scene::Description scene_of(const std::string& run, const std::vector<std::string>& overrides) {
  const std::filesystem::path folder(run);
  return recorded_scene(text_of_file(folder / "scene.toml"), folder, overrides);
}

/// Observer that keeps the ticks of the hands of a run.
class Ticks : public loop::Observer {
 public:
  explicit Ticks(std::size_t hands) : of(hands) {}
  void tick_of(std::size_t hand, const loop::TickRecord& tick) override { of[hand].push_back(tick); }
  std::vector<std::vector<loop::TickRecord>> of;
};

/// Prints the differences between two tick records of a hand; with several hands, its name first.
compare::PerceptibleDifference print_difference(const scene::Description& description, std::size_t hand,
                                                const std::vector<loop::TickRecord>& reference,
                                                const std::vector<loop::TickRecord>& other) {
  if (!description.hands.empty()) fmt::print("{}:\n", scene::hands_of(description)[hand].name);
  const compare::PerceptibleDifference difference = compare::perceptible_difference(reference, other);
  fmt::print("{}", compare::text_of(difference));
  return difference;
}

int repeat_ticks(const scene::Description& description, const std::vector<loop::HapticRecord>& records) {
  bool identical = true;
  for (std::size_t i = 0; i < records.size(); ++i)
    identical &=
        print_difference(description, i, records[i].ticks, loop::retrace(description, records, i)).identical;
  if (!identical)
    fail(
        "replay: the ticks differ from those recorded; the run was made by another version or on another "
        "machine");
  return 0;
}

int replay(const ReplayArguments& arguments) {
  const scene::Description recorded = scene_of(arguments.run, {});
  if (!recorded.tool)
    fail("replay: the scene of {} has no [tool], so there are no ticks to replay", arguments.run);
  const std::vector<loop::HapticRecord> records = loop::read_haptic_records(arguments.run, recorded);
  if (!arguments.changes()) return repeat_ticks(recorded, records);

  std::vector<std::string> overrides = arguments.overrides;
  if (!arguments.integrator.empty())
    overrides.push_back(fmt::format("integrator.name=\"{}\"", arguments.integrator));
  const scene::Description description = scene_of(arguments.run, overrides);
  if (description.hands.size() + 1 != records.size())
    fail("replay: the scene now has {} hands, but {} were recorded", description.hands.size() + 1,
         records.size());
  if (records.front().ticks.empty()) fail("replay: the record has no ticks");
  const double start = wall_seconds();
  const auto world = loop::assemble(description, loop::recorded_hands(records));
  const double assemble_s = wall_seconds() - start;
  const std::string folder =
      arguments.folder.empty() ? default_folder("replay-" + short_name(description)) : arguments.folder;
  std::error_code none;
  if (std::filesystem::equivalent(folder, arguments.run, none))
    fail("{}: the replay would overwrite the run that it replays; choose another folder with -o DIR", folder);
  const store::FolderLock mine(folder);
  session::remove_run_files(description, folder);
  Ticks ticks(records.size());
  loop::RunFigures figures;
  loop::RunResult result;
  {
    loop::Recorder recorder(*world, folder);
    Progress progress(fmt::format("replaying {}", arguments.run));
    loop::RunOptions options;
    options.duration_s = records.front().ticks.back().time;
    options.observers = {&ticks, &figures, &recorder};
    options.progress = [&progress](double fraction) { progress(fraction); };
    options.stop = &stop_flag();
    result = loop::run(*world, options);
  }
  store::Summary summary = loop::summarise(*world, result, assemble_s, figures);
  summary.command = fmt::format("palpate replay {}", arguments.run);
  summary.overrides = arguments.overrides;
  store::write_summary((std::filesystem::path(folder) / "summary.json").string(), summary);
  store::write_atomically((std::filesystem::path(folder) / "scene.toml").string(), description.source);
  fmt::print("{}: {} s simulated in {:.2f} s; in {}\n", short_name(description), time_text(result.time),
             result.wall_s, folder);
  if (!result.status.ok())
    fail("{} failed at t = {} s: {}", description.integrator.name, time_text(result.status.t),
         result.status.message);
  fmt::print("force on the hand in {}, compared with this replay:\n", arguments.run);
  for (std::size_t i = 0; i < records.size(); ++i)
    print_difference(description, i, ticks.of[i], records[i].ticks);
  return result.stopped ? kExitStopped : 0;
}

}  // namespace

void add_replay(CLI::App& app, Invocation& invocation) {
  CLI::App* command =
      app.add_subcommand("replay", "repeat the ticks of a run, or rerun it under the recorded hand");
  auto arguments = std::make_shared<ReplayArguments>();
  command->add_option("run", arguments->run, "folder of a run, which contains haptic.h5")
      ->required()
      ->type_name("DIR");
  command->add_option("--set", arguments->overrides, "change a key of its scene (KEY=VALUE, repeatable)")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  command->add_option("--integrator", arguments->integrator, "replace the integrator of the run")
      ->type_name("NAME");
  command->add_option("-o,--output", arguments->folder, "folder for the results; default out/replay-SCENE")
      ->type_name("DIR");
  command->footer(R"(Examples:
  palpate replay out/press-ball                  each tick from its recorded input and exchange, bitwise
  palpate replay out/press-ball --integrator cvode-bdf --set exchange.scheme=monolithic
  palpate replay out/press-ball --set exchange.exchange_period_s=0.02

Without changes only the ticks are computed again (in a single-rate scene with the bodies); they must equal
the recorded ticks, also for a run in real time, else the exit status is 1. With changes the scene runs
again in virtual time under the recorded hand, and the perceptible difference is printed.)");
  command->callback([arguments, &invocation] {
    invocation.factorises = true;
    invocation.action = [arguments] { return replay(*arguments); };
  });
}

}  // namespace palpate::cli
