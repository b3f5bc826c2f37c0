#include "palpate/loop/replay.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "commands.h"
#include "palpate/compare/felt_difference.h"
#include "palpate/core/clock.h"
#include "palpate/core/error.h"
#include "palpate/loop/recorder.h"
#include "palpate/loop/summary.h"
#include "palpate/store/atomic_file.h"
#include "paths.h"
#include "progress.h"
#include "recorded_scene.h"
#include "scene_of.h"
#include "stop.h"

namespace palpate::cli {
namespace {

std::string text_of_file(const std::filesystem::path& path) {
  std::ifstream in(path);
  if (!in) fail("{}: no such file; a replay needs the folder of a finished run", path.string());
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

scene::Description scene_of(const ReplayArguments& arguments) {
  const std::filesystem::path folder(arguments.run);
  std::vector<std::string> overrides = arguments.overrides;
  if (!arguments.integrator.empty())
    overrides.push_back(fmt::format("integrator.name=\"{}\"", arguments.integrator));
  return recorded_scene(text_of_file(folder / "scene.toml"), folder, overrides);
}

/// Keeps the ticks of a run.
class Ticks : public loop::Observer {
 public:
  void tick(const loop::TickRecord& tick) override { all.push_back(tick); }
  std::vector<loop::TickRecord> all;
};

int repeat_ticks(const scene::Description& description, const loop::HapticRecord& record) {
  const compare::FeltDifference difference =
      compare::felt_difference(record.ticks, loop::retrace(description, record));
  fmt::print("{}", compare::text_of(difference));
  if (!difference.identical)
    fail("replay: the ticks differ from those recorded: the run was made by another version or machine");
  return 0;
}

}  // namespace

int replay(const ReplayArguments& arguments) {
  const loop::HapticRecord record =
      loop::read_haptic_record((std::filesystem::path(arguments.run) / "haptic.h5").string());
  const scene::Description description = scene_of(arguments);
  if (!arguments.changes()) return repeat_ticks(description, record);

  const double start = wall_seconds();
  const auto world = loop::assemble(description, loop::recorded_hand(record));
  const double assemble_s = wall_seconds() - start;
  const std::string folder =
      arguments.folder.empty() ? default_folder("replay-" + short_name(description)) : arguments.folder;
  make_folder(folder);
  Ticks ticks;
  loop::RunResult result;
  {
    loop::Recorder recorder(*world, folder);
    Progress progress(fmt::format("replaying {}", arguments.run));
    loop::RunOptions options;
    options.duration_s = record.ticks.back().time;
    options.observers = {&ticks, &recorder};
    options.progress = [&progress](double fraction) { progress(fraction); };
    options.stop = &stop_flag();
    result = loop::run(*world, options);
  }
  store::Summary summary = loop::summarise(*world, result, assemble_s);
  summary.command = fmt::format("palpate replay {}", arguments.run);
  summary.overrides = arguments.overrides;
  store::write_summary((std::filesystem::path(folder) / "summary.json").string(), summary);
  store::write_atomically((std::filesystem::path(folder) / "scene.toml").string(), description.source);
  fmt::print("{}: {:g} s simulated in {:.2f} s; in {}\n", short_name(description), result.time, result.wall_s,
             folder);
  if (!result.status.ok())
    fail("{} gave up at t = {:g} s: {}", description.integrator.name, result.status.t, result.status.message);
  fmt::print("what the hand felt in {}, against this:\n{}", arguments.run,
             compare::text_of(compare::felt_difference(ticks.all, record.ticks)));
  return result.stopped ? kExitStopped : 0;
}

}  // namespace palpate::cli
