#include "experiments/study/plan.h"

#include <algorithm>
#include <filesystem>

#include "loop/registries.h"
#include "loop/result_key.h"
#include "palpate/core/error.h"
#include "palpate/loop/load.h"
#include "store/atomic_file.h"
#include "store/content_hash.h"

namespace palpate::study {
namespace {

namespace fs = std::filesystem;
using dynamics::StepControl;
using dynamics::StepperEntry;

constexpr std::size_t kMostTasks = 1000000;

using Varied = std::vector<std::pair<std::string, std::string>>;

/// Choice of one setting: its overrides, and the columns that record it.
struct Choice {
  std::vector<std::string> overrides;
  Varied varied;
};
using Choices = std::vector<Choice>;

bool uses(const StepperEntry& entry, const std::string& name) {
  return std::any_of(entry.keys.begin(), entry.keys.end(),
                     [&](const PartKey& key) { return key.name == name; });
}

/// Whether an integrator uses error control by rtol with this scene.
bool by_error_control(const StepperEntry& entry, const IntegratorSpec& spec) {
  return entry.traits.control == StepControl::kAdaptive ||
         (entry.traits.control == StepControl::kEither && !spec.fixed_step);
}

Choice set_to(const std::string& key, const std::string& value) {
  return {{key + "=" + value}, {{key, value}}};
}

/// Returns the tolerances or the steps of a method: the list that applies to it, or the tolerances where both
/// do.  Without a list it keeps the scene's setting.
Choices settings_of(const scene::StudySpec& spec, const StepperEntry& entry) {
  const StepControl control = entry.traits.control;
  Choices out;
  const bool by_rtol = control != StepControl::kFixed && !spec.rtol.empty() && uses(entry, "rtol");
  const bool by_step = !by_rtol && control != StepControl::kAdaptive && uses(entry, "step_s");
  for (const double value : by_rtol ? spec.rtol : by_step ? spec.step_s : std::vector<double>{}) {
    Choice choice{{fmt::format("integrator.{}={}", by_rtol ? "rtol" : "step_s", to_toml(value))}, {}};
    if (uses(entry, "fixed_step"))
      choice.overrides.push_back(fmt::format("integrator.fixed_step={}", !by_rtol));
    out.push_back(std::move(choice));
  }
  if (out.empty()) out.emplace_back();
  return out;
}

/// Returns the sweeps; sweeps that vary together form one list of choices.
std::vector<Choices> sweeps_of(const scene::StudySpec& spec) {
  std::vector<Choices> out;
  for (const scene::SweepSpec& sweep : spec.sweeps) {
    if (!sweep.together) out.emplace_back(sweep.values.size());
    for (std::size_t i = 0; i < sweep.values.size(); ++i) {
      out.back()[i].overrides.push_back(sweep.key + "=" + sweep.values[i]);
      out.back()[i].varied.emplace_back(sweep.key, sweep.values[i]);
    }
  }
  return out;
}

Choices seeds_of(const scene::StudySpec& spec) {
  Choices out;
  for (const int seed : spec.seeds) {
    Choice choice{{}, {{"seed", fmt::format("{}", seed)}}};
    for (const scene::RandomSpec& random : spec.randoms) {
      const Choice one = set_to(random.key, scene::drawn_value(random, seed));
      choice.overrides.push_back(one.overrides[0]);
      choice.varied.push_back(one.varied[0]);
    }
    out.push_back(std::move(choice));
  }
  return out;
}

std::string scene_path(const scene::StudySpec& spec, const std::string& name, const PlanHelp& help) {
  const fs::path beside = fs::path(spec.path).parent_path() / name;
  const bool is_file = fs::is_regular_file(beside) || name.ends_with(".toml");
  if (!is_file && !help.find_scene) fail("{}: there is no scene file {}", spec.path, beside.string());
  return fs::absolute(is_file ? beside.string() : help.find_scene(name)).lexically_normal().string();
}

/// Appends the Cartesian product of all lists to the plan; the last list varies fastest.
void add_product(Plan& plan, const Task& base, const std::vector<Choices>& lists) {
  std::size_t count = 1;
  for (const Choices& list : lists) {
    if (list.size() > kMostTasks / count || plan.tasks.size() + count * list.size() > kMostTasks)
      fail("{}: the study has more than {} tasks; sweep fewer values, or split it into several studies",
           plan.spec.path, kMostTasks);
    count *= list.size();
  }
  for (std::size_t i = 0; i < count; ++i) {
    Task task = base;
    task.index = plan.tasks.size();
    std::size_t rest = i, of_each = count;
    for (const Choices& list : lists) {
      of_each /= list.size();
      const Choice& choice = list[rest / of_each];
      rest %= of_each;
      task.overrides.insert(task.overrides.end(), choice.overrides.begin(), choice.overrides.end());
      task.varied.insert(task.varied.end(), choice.varied.begin(), choice.varied.end());
    }
    plan.tasks.push_back(std::move(task));
  }
}

void add_scene(Plan& plan, std::size_t index, const std::vector<Choices>& sweeps, const Choices& seeds) {
  const scene::StudySpec& spec = plan.spec;
  const StudyScene& own = plan.scenes[index];
  const scene::Description description = loop::parse(own.text, own.path);
  const bool bodies = !description.bodies.empty();
  if (!bodies && !spec.integrators.empty())
    fail(
        "{}: integrators: scene {} has no bodies to integrate; a [[sweep]] of \"tool.integrator\" varies the "
        "integrator of its tool",
        spec.path, own.name);
  std::vector<std::string> integrators = spec.integrators;
  if (integrators.empty())
    integrators.push_back(bodies             ? description.integrator.name
                          : description.tool ? description.tool->integrator
                                             : "none");
  for (const std::string& integrator : integrators) {
    Task base;
    base.scene = index;
    base.integrator = integrator;
    base.overrides = spec.set;
    if (spec.duration_s > 0.0) base.overrides.push_back("scene.duration_s=" + to_toml(spec.duration_s));
    Choices settings(1);
    if (bodies) {
      const StepperEntry& entry =
          find(loop::steppers(), integrator, fmt::format("{}: integrator", spec.path).c_str());
      if (!spec.integrators.empty()) base.overrides.push_back("integrator.name=\"" + integrator + "\"");
      settings = settings_of(spec, entry);
    }
    std::vector<Choices> lists = {settings};
    lists.insert(lists.end(), sweeps.begin(), sweeps.end());
    if (!seeds.empty()) lists.push_back(seeds);
    add_product(plan, base, lists);
  }
}

}  // namespace

Plan list_tasks(const scene::StudySpec& spec, const PlanHelp& help) {
  Plan plan;
  plan.spec = spec;
  plan.spec.path = fs::absolute(spec.path).lexically_normal().string();
  for (const std::string& name : spec.scenes) {
    const std::string path = scene_path(plan.spec, name, help);
    loop::load(path);  // Throws its message where it is no scene.
    plan.scenes.push_back({name, path, store::read_file(path)});
  }
  const std::vector<Choices> sweeps = sweeps_of(plan.spec);
  const Choices seeds = seeds_of(plan.spec);
  for (std::size_t s = 0; s < plan.scenes.size(); ++s) add_scene(plan, s, sweeps, seeds);
  store::ContentHash hash;
  hash.add(loop::made_by()).add(plan.spec.text);
  for (const StudyScene& one : plan.scenes) hash.add(one.path).add(one.text);
  plan.key = hash.hex();
  return plan;
}

void settle(const Plan& plan, Task& task, const PlanHelp& help) {
  if (task.settled) return;
  task.settled = true;
  const StudyScene& own = plan.scenes[task.scene];
  try {
    const scene::Description d = loop::parse(own.text, own.path, task.overrides);
    if (help.prepare) help.prepare(d);
    task.key = loop::result_key(d, fmt::format("study, repeats {}", plan.spec.repeats));
    task.threads = std::max(1, d.integrator.threads);
    if (d.bodies.empty()) return;
    const StepperEntry& entry = find(loop::steppers(), d.integrator.name, "integrator");
    const bool adaptive = by_error_control(entry, d.integrator);
    if (adaptive && uses(entry, "rtol")) task.rtol = fmt::format("{}", d.integrator.rtol);
    if (!adaptive && uses(entry, "step_s")) task.step_s = fmt::format("{}", d.integrator.step_s);
  } catch (const Error& refusal) { task.refused = refusal.what(); }
}

void settle_all(Plan& plan, const PlanHelp& help) {
  for (Task& task : plan.tasks) settle(plan, task, help);
  for (std::size_t s = 0; s < plan.scenes.size(); ++s) {
    const auto runs = [&](const Task& task) { return task.scene == s && task.refused.empty(); };
    if (std::any_of(plan.tasks.begin(), plan.tasks.end(), runs)) continue;
    const auto first =
        std::find_if(plan.tasks.begin(), plan.tasks.end(), [&](const Task& task) { return task.scene == s; });
    fail("{}: every task of scene {} is rejected; the first: {}", plan.spec.path, plan.scenes[s].name,
         first->refused);
  }
}

}  // namespace palpate::study
