#include "session/run_summary.h"

#include <filesystem>

#include "experiments/compare/summary.h"
#include "loop/summary.h"
#include "palpate/core/log.h"
#include "session/command_line.h"
#include "session/reference_remarks.h"
#include "session/shade.h"
#include "store/atomic_file.h"

namespace palpate::session {
namespace {

/// Adds what pictures and movies made later share with those of the run: the view, the free bodies, and the
/// range of colours.
void add_pictures(store::Summary& summary, const scene::Description& d, const RunOutput& ran,
                  const Options& options) {
  const auto list = [](const Vec3& v) { return std::vector<double>{v.x(), v.y(), v.z()}; };
  store::SummaryFields fields;
  if (const auto free = free_bodies(d); !free.empty()) fields.emplace_back("free_bodies", free);
  if (d.view.direction) fields.emplace_back("view_direction", list(*d.view.direction));
  if (d.view.target_m) fields.emplace_back("view_target_m", list(*d.view.target_m));
  if (d.view.zoom != 1.0) fields.emplace_back("view_zoom", d.view.zoom);
  if (d.view.up != Vec3::UnitZ()) fields.emplace_back("view_up", list(d.view.up));
  if (ran.largest_value) {
    fields.emplace_back("shade", options.shade);
    fields.emplace_back("largest_value", *ran.largest_value);
  }
  if (!fields.empty()) summary.section("pictures").values = fields;
}

}  // namespace

store::Summary summary_of(const loop::World& world, const RunOutput& ran, const Options& options,
                          const std::optional<Outcome>& outcome) {
  store::Summary summary = loop::summarise(world, ran.result, ran.assemble_s, ran.figures);
  if (outcome) summary.outcome = outcome->word, summary.message = outcome->message;
  if (ran.against) compare::add_to_summary(summary, world.description, *ran.against, "monolithic");
  if (ran.against_every_tick)
    compare::add_to_summary(summary, world.description, *ran.against_every_tick, "virtual_time");
  if (const double every_s = options.checkpoint_every_s; every_s > 0.0)
    loop::add_checkpoints(summary, ran.checkpoints, every_s);
  add_pictures(summary, world.description, ran, options);
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
