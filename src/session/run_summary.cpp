#include "session/run_summary.h"

#include <filesystem>

#include "experiments/compare/summary.h"
#include "loop/summary.h"
#include "palpate/core/log.h"
#include "session/command_line.h"
#include "session/reference_remarks.h"
#include "store/atomic_file.h"

namespace palpate::session {

store::Summary summary_of(const loop::World& world, const RunOutput& ran, const Options& options,
                          const std::optional<Outcome>& outcome) {
  store::Summary summary = loop::summarise(world, ran.result, ran.assemble_s, ran.figures);
  if (outcome) summary.outcome = outcome->word, summary.message = outcome->message;
  if (ran.against) compare::add_to_summary(summary, world.description, *ran.against, "monolithic");
  if (ran.against_every_tick)
    compare::add_to_summary(summary, world.description, *ran.against_every_tick, "virtual_time");
  if (const double every_s = options.checkpoint_every_s; every_s > 0.0)
    loop::add_checkpoints(summary, ran.checkpoints, every_s);
  summary.command = command_of(options);
  summary.overrides = options.scene.overrides;
  summary.remarks = log::warnings();
  summary.remarks.insert(summary.remarks.end(), ran.remarks.begin(), ran.remarks.end());
  for (const auto& against : {ran.against, ran.against_every_tick})
    if (against)
      for (std::string& line : reference_remarks(world.description, *against))
        summary.remarks.push_back(std::move(line));
  return summary;
}

void write_summary(const loop::World& world, const RunOutput& ran, const Options& options,
                   const std::optional<Outcome>& outcome) {
  const std::filesystem::path folder(ran.folder);
  store::write_summary((folder / "summary.json").string(), summary_of(world, ran, options, outcome));
  store::write_atomically((folder / "scene.toml").string(), world.description.source);
}

}  // namespace palpate::session
