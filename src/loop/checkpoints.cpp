#include "loop/checkpoints.h"

#include <cmath>
#include <filesystem>
#include <map>
#include <optional>

#include "core/clock.h"
#include "core/counters.h"
#include "palpate/core/error.h"
#include "palpate/device/device.h"
#include "palpate/loop/stepped_run.h"
#include "palpate/scene/hands.h"
#include "store/content_hash.h"
#include "tool_instance.h"

namespace palpate::loop {
namespace {

/// Tolerance for equal times: times of checkpoints and periods are multiples of different decimal numbers.
constexpr double kSamePeriod = 1e-9;

bool is_due(const SteppedRun& run, double every_s) {
  const auto before = [&](int periods) { return std::floor(periods * run.period() / every_s + kSamePeriod); };
  const int done = run.periods_done();
  return done < run.periods() && before(done) > before(done - 1);
}

/// Counters of the process so far.
using Counts = std::map<std::string, long>;
void archive_process(Archive& a, Counts& counts) {
  const Archive::Group group(a, "process");
  std::string names;
  for (const auto& [name, count] : counts) names += name + "\n";
  a("names", names);
  for (std::size_t from = 0, to; (to = names.find('\n', from)) != std::string::npos; from = to + 1) {
    const std::string name = names.substr(from, to - from);
    a(name, counts[name]);
  }
}

void count_on(Resumed& from) {
  Counts counts;
  archive_process(from.archive, counts);
  for (const auto& [name, count] : from.counted)
    if (const bool of_process = name.starts_with("gl."); !of_process || !counts.contains(name))
      counts[name] += count;
  counters::reset();
  for (const auto& [name, count] : counts) counters::counter(name) = count;
}

void archive_observers(Archive& a, const RunOptions& options) {
  a.each("observer", options.observers, [&](Observer* observer) { observer->archive(a); });
}

}  // namespace

void CheckpointCost::archive(Archive& a) {
  a("written", written);
  a("keep_s", keep_s);
  a("assemble_s", assemble_s);
}

std::string fingerprint(const World& world) {
  store::ContentHash hash;
  const auto add = [&](const void* data, std::size_t size) {
    hash.add({static_cast<const char*>(data), size});
  };
  add(world.state.q().data(), sizeof(double) * static_cast<std::size_t>(world.state.q().size()));
  for (const Body& body : world.bodies) {
    add(body.rest.nodes.data(), sizeof(double) * static_cast<std::size_t>(body.rest.nodes.size()));
    add(body.rest.tets.data(), sizeof(int) * static_cast<std::size_t>(body.rest.tets.size()));
    add(body.masses.data(), sizeof(double) * static_cast<std::size_t>(body.masses.size()));
    add(body.material_of_element.data(), sizeof(int) * body.material_of_element.size());
    if (body.skin)
      add(body.skin->rest.vertices.data(),
          sizeof(double) * static_cast<std::size_t>(body.skin->rest.vertices.size()));
  }
  for (const scene::Hand& hand : scene::hands_of(world.description))
    if (!hand.device->file.empty())
      hash.add_file((std::filesystem::path(world.folder) / hand.device->file).string());
  return hash.hex();
}

std::string why_no_checkpoints(const World& world, const RunOptions& options) {
  if (options.real_time) return "a run in real time follows the clock and the hand, which cannot be restored";
  for (const ToolInstance& tool : world.tools)
    if (!tool.device->can_be_archived())
      return fmt::format(
          "the device \"{}\" is moved from outside this program, and its motion cannot be restored",
          tool.device_spec.type);
  return {};
}

void check_checkpoints(const scene::Description& description, double every_s, double duration_s) {
  const double period = period_of(description),
               duration = duration_s > 0.0 ? duration_s : description.duration_s;
  if (every_s < period * (1.0 - kSamePeriod))
    fail(
        "a checkpoint every {} s: checkpoints are written at the end of a period of the loop, which is {} s "
        "in this scene; choose {} s or longer{}",
        every_s, period, period,
        description.tool || !description.contacts.empty() ? "" : ", or a shorter record.state_period_s");
  if (!(every_s < duration * (1.0 - kSamePeriod)))
    fail("a checkpoint every {} s: the run ends at {} s, before the first checkpoint; choose a shorter time",
         every_s, duration);
}

RunResult run_with_checkpoints(std::unique_ptr<World>& world, const RunOptions& options,
                               const CheckpointPlan& plan, CheckpointCost& cost, Resumed* from) {
  if (const std::string why = why_no_checkpoints(*world, options); !why.empty()) fail("checkpoints: {}", why);
  std::optional<SteppedRun> run;
  if (from) {
    archive_observers(from->archive, options);
    from->archive("cost", cost);
    count_on(*from);
    run.emplace(*world, options, from->archive);
    from->archive.check_all_restored();
  } else {
    run.emplace(*world, options);
  }
  while (run->next()) {
    if (!is_due(*run, plan.every_s)) continue;
    Archive kept;
    ++cost.written;
    {
      const ScopedTimer timer(cost.keep_s);
      run->archive(kept);
      archive_observers(kept, options);
      kept("cost", cost);
      Counts counts = counters::snapshot();
      archive_process(kept, counts);
      plan.keep(run->result().time, kept);
    }
    const ScopedTimer timer(cost.assemble_s);
    run.reset();
    world.reset();  // frees its memory before the next one is assembled
    world = plan.assemble();
    Archive again(kept.values(), "checkpoint");
    run.emplace(*world, options, again);
  }
  RunResult result = run->result();
  run.reset();
  return result;
}

}  // namespace palpate::loop
