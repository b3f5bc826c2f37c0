#include "experiments/compare/plan.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "loop/registries.h"
#include "palpate/core/error.h"
#include "palpate/loop/load.h"

namespace palpate::compare {
namespace {

using dynamics::Stability;
using dynamics::StepControl;
using dynamics::StepperEntry;

/// Solvers tried by kBest: the direct solver and the iterative ones.
const std::vector<std::string> kTriedSolvers = {"cholmod", "pcg-single", "pcg-two-level"};
const std::string kOtherDirectSolver = "umfpack";

std::string label_of(const scene::LadderSpec& ladder) {
  return ladder.label.empty() ? ladder.integrator : ladder.label;
}

bool contains(const std::vector<std::string>& list, const std::string& name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

/// Whether the user's list contains a sequence: by its label, or by its integrator where no sequence has that
/// name as label.
bool is_named(const std::vector<std::string>& requested, const scene::LadderSpec& ladder,
              const std::vector<scene::LadderSpec>& all) {
  if (contains(requested, label_of(ladder))) return true;
  const auto has_that_label = [&](const scene::LadderSpec& other) {
    return label_of(other) == ladder.integrator;
  };
  return contains(requested, ladder.integrator) && std::none_of(all.begin(), all.end(), has_that_label);
}

constexpr double kLoosestRtol = 0.1;

/// Whether a setting is the coarsest meaningful one: an rtol of 0.1, or a step of a whole period.
bool is_coarsest(const scene::Description& d, const scene::LadderSpec& ladder, double value) {
  if (ladder.setting == "rtol") return value >= (1.0 - 1e-9) * kLoosestRtol;
  return ladder.setting == "step_s" && value >= (1.0 - 1e-9) * loop::period_of(d);
}

bool takes_rtol(const StepperEntry& entry, double rtol) {
  return std::all_of(entry.keys.begin(), entry.keys.end(),
                     [&](const PartKey& key) { return key.name != "rtol" || key.range.holds(rtol); });
}

/// Fills in default levels: from the coarsest meaningful setting down to rounding, in decades of rtol under
/// error control, else by halving the loop's period.  The actual end is set by the time limit, or by the
/// reference when it no longer resolves the errors.
void fill_by_default(const scene::Description& d, const StepperEntry& entry, scene::LadderSpec& ladder) {
  if (entry.traits.control != StepControl::kFixed) {
    ladder.setting = "rtol";
    for (int k = 1; k <= 12; ++k)
      if (const double rtol = std::stod(fmt::format("1e-{}", k)); takes_rtol(entry, rtol))
        ladder.values.push_back(rtol);
    return;
  }
  ladder.setting = "step_s";
  for (int k = 0; k < 20; ++k) ladder.values.push_back(std::ldexp(loop::period_of(d), -k));
}

scene::LadderSpec default_ladder(const scene::Description& d, const StepperEntry& entry) {
  scene::LadderSpec ladder;
  ladder.integrator = entry.name;
  fill_by_default(d, entry, ladder);
  return ladder;
}

/// Returns a sequence of ticks: integer fractions of the exchange period.
scene::LadderSpec tick_ladder(const scene::Description& d, const std::string& integrator) {
  scene::LadderSpec ladder;
  ladder.integrator = integrator;
  ladder.setting = "tick_s";
  for (int n = 5; n <= 160; n *= 2) ladder.values.push_back(d.exchange.exchange_period_s / n);
  return ladder;
}

void check_ladder(const scene::Description& d, const scene::LadderSpec& ladder) {
  const StepperEntry& entry = find(loop::steppers(), ladder.integrator,
                                   fmt::format("integrator in [[compare.ladder]] of {}:", d.path).c_str());
  if (ladder.values.empty()) return;
  const StepControl control = entry.traits.control;
  if (control == StepControl::kAdaptive && ladder.setting != "rtol")
    fail("{}: [[compare.ladder]] \"{}\": {} has error control; give rtol = [...] instead of {}", d.path,
         label_of(ladder), entry.name, ladder.setting);
  if (control == StepControl::kFixed && ladder.setting != "step_s")
    fail("{}: [[compare.ladder]] \"{}\": {} takes fixed steps; give step_s = [...] instead of {}", d.path,
         label_of(ladder), entry.name, ladder.setting);
}

/// Returns the requested sequences: the scene's first, in their order.
std::vector<scene::LadderSpec> ladders_of(const scene::Description& d, const CompareOptions& options) {
  const std::vector<std::string>& requested = options.integrators;
  const bool everything = requested.empty() || options.all, tool_only = d.bodies.empty();
  std::vector<scene::LadderSpec> out;
  std::set<std::string> labels, integrators, met;
  if (!tool_only)
    for (scene::LadderSpec ladder : d.compare.ladders) {
      check_ladder(d, ladder);
      const bool named = is_named(requested, ladder, d.compare.ladders);
      if (named) met.insert({ladder.integrator, label_of(ladder)});
      if (!everything && !named) continue;
      if (!labels.insert(label_of(ladder)).second)
        fail("{}: two [[compare.ladder]] are called \"{}\"; give one of them a label", d.path,
             label_of(ladder));
      integrators.insert(ladder.integrator);
      if (ladder.values.empty()) fill_by_default(d, *find_stepper(ladder.integrator), ladder);
      out.push_back(ladder);
    }
  std::vector<std::string> known;
  const auto add = [&](const std::string& name, bool by_default, auto make) {
    known.push_back(name);
    const bool named = contains(requested, name);
    if (named) met.insert(name);
    if (integrators.contains(name) || !(named || (everything && by_default))) return;
    out.push_back(make());
  };
  if (tool_only) {
    for (const loop::Choice& one : loop::tool_steppers())
      add(one.name, true, [&] { return tick_ladder(d, one.name); });
  } else {
    for (const StepperEntry& entry : loop::steppers())
      add(entry.name, entry.traits.stability != Stability::kStatic, [&] { return default_ladder(d, entry); });
    for (const scene::LadderSpec& ladder : d.compare.ladders) known.push_back(label_of(ladder));
  }
  for (const std::string& name : requested)
    if (!met.contains(name))
      fail("{}: no integrator and no [[compare.ladder]] is called \"{}\"{}", d.path, name,
           suggestion(name, known));
  return out;
}

bool uses(const StepperEntry* entry, const std::string& name) {
  return entry && std::any_of(entry->keys.begin(), entry->keys.end(),
                              [&](const PartKey& key) { return key.name == name; });
}

/// Returns the override that sets a sequence's linear solver; none where the scene's is kept.
std::vector<std::string> solver_of(const scene::LadderSpec& ladder, const SolverChoice& choice) {
  if (!uses(find_stepper(ladder.integrator), "linear_solver")) return {};
  const auto chosen = choice.by_label.find(label_of(ladder));
  const std::string& solver = chosen == choice.by_label.end() ? choice.of_all : chosen->second;
  if (solver.empty()) return {};
  return {"integrator.linear_solver=\"" + solver + "\""};
}

std::string solver_name(const scene::Description& d, const std::string& integrator) {
  const StepperEntry* entry = d.bodies.empty() ? nullptr : find_stepper(integrator);
  if (!uses(entry, "linear_solver")) return "";
  return d.integrator.linear_solver.empty() ? entry->traits.linear_solver : d.integrator.linear_solver;
}

ComparePoint point_of(const scene::Description& d, const scene::LadderSpec& ladder) {
  ComparePoint point;
  point.label = label_of(ladder);
  point.integrator = ladder.integrator;
  if (const StepperEntry* entry = d.bodies.empty() ? nullptr : find_stepper(ladder.integrator)) {
    point.family = entry->traits.family;
    point.stability = dynamics::to_string(entry->traits.stability);
    point.order = entry->traits.order;
    point.multistep = entry->traits.multistep;
    return point;
  }
  point.family = "tool";
  for (const loop::Choice& one : loop::tool_steppers())
    if (one.name == ladder.integrator) point.order = one.order;
  return point;
}

/// Whether a sequence has default levels instead of levels from the scene.
bool is_by_default(const scene::Description& d, const scene::LadderSpec& ladder) {
  return std::none_of(d.compare.ladders.begin(), d.compare.ladders.end(), [&](const auto& own) {
    return !own.values.empty() && label_of(own) == label_of(ladder);
  });
}

}  // namespace

std::string trial_label(const std::string& label, const std::string& solver) {
  return label + " by " + solver;
}

const StepperEntry* find_stepper(const std::string& name) {
  for (const StepperEntry& entry : loop::steppers())
    if (entry.name == name) return &entry;
  return nullptr;
}

std::string toml_number(double value) {
  std::string text = fmt::format("{}", value);
  return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
}

std::vector<std::string> overrides_of(const scene::LadderSpec& ladder, double value) {
  std::vector<std::string> out = ladder.set;
  if (ladder.setting == "tick_s") {
    out.push_back("tool.integrator=\"" + ladder.integrator + "\"");
    out.push_back("tool.tick_s=" + toml_number(value));
    return out;
  }
  out.push_back("integrator.name=\"" + ladder.integrator + "\"");
  const StepperEntry* entry = find_stepper(ladder.integrator);
  if (uses(entry, ladder.setting))
    out.push_back(fmt::format("integrator.{}={}", ladder.setting, toml_number(value)));
  if (uses(entry, "fixed_step"))
    out.push_back(fmt::format("integrator.fixed_step={}", ladder.setting == "step_s"));
  return out;
}

scene::Description with_overrides(const scene::Description& d, const std::vector<std::string>& overrides) {
  if (d.source.empty())
    fail("scene \"{}\": has no text; a comparison needs scenes from loop::load or loop::parse", d.name);
  return loop::parse(d.source, d.path, overrides);
}

std::vector<ComparePoint> plan_points(const scene::Description& d, const CompareOptions& options,
                                      const SolverChoice& choice) {
  std::vector<ComparePoint> points;
  for (scene::LadderSpec ladder : ladders_of(d, options)) {
    const bool by_default = is_by_default(d, ladder);
    for (const double value : ladder.values) {
      ComparePoint point = point_of(d, ladder);
      point.setting_name = ladder.setting;
      point.setting = value;
      point.coarsest = is_coarsest(d, ladder, value);
      point.open_ended = by_default;
      std::vector<std::string> overrides = overrides_of(ladder, value);
      for (std::string& solver : solver_of(ladder, choice)) overrides.push_back(std::move(solver));
      point.description = with_overrides(d, overrides);
      point.linear_solver = solver_name(point.description, ladder.integrator);
      if (const StepperEntry* entry = d.bodies.empty() ? nullptr : find_stepper(ladder.integrator);
          entry && entry->error_test_rtol && ladder.setting == "rtol")
        point.error_test_rtol = entry->error_test_rtol(point.description.integrator);
      points.push_back(std::move(point));
    }
  }
  if (points.empty()) fail("scene \"{}\": nothing to compare", d.name);
  return points;
}

std::vector<ComparePoint> plan_trials(const scene::Description& d, const CompareOptions& options) {
  std::vector<ComparePoint> out;
  for (const std::string& solver : kTriedSolvers)
    for (const scene::LadderSpec& ladder : ladders_of(d, options)) {
      if (d.bodies.empty() || !uses(find_stepper(ladder.integrator), "linear_solver")) continue;
      scene::LadderSpec middle = ladder;
      // A default sequence has no fixed end: the third level is used.
      middle.values = {
          ladder.values[is_by_default(d, ladder) ? std::min<std::size_t>(2, ladder.values.size() - 1)
                                                 : ladder.values.size() / 2]};
      ComparePoint point = point_of(d, middle);
      point.label = trial_label(point.label, solver);
      point.setting_name = ladder.setting;
      point.setting = middle.values[0];
      std::vector<std::string> overrides = overrides_of(middle, point.setting);
      overrides.push_back("integrator.linear_solver=\"" + solver + "\"");
      point.description = with_overrides(d, overrides);
      point.linear_solver = solver;
      out.push_back(std::move(point));
    }
  return out;
}

std::vector<ComparePoint> plan_restarts(const scene::Description& d, const CompareOptions& options,
                                        const SolverChoice& choice) {
  std::vector<ComparePoint> points;
  if (d.contacts.empty() || d.bodies.empty()) return points;
  CompareOptions own = options;
  for (const scene::LadderSpec& ladder : ladders_of(d, own)) {
    const bool chosen = contains(options.integrators, ladder.integrator) ||
                        contains(options.integrators, label_of(ladder)) ||
                        std::any_of(d.compare.ladders.begin(), d.compare.ladders.end(),
                                    [&](const auto& l) { return label_of(l) == label_of(ladder); });
    if (!chosen) continue;
    for (const double period : d.compare.refresh_periods_s) {
      std::vector<std::string> overrides =
          overrides_of(ladder, ladder.setting == "rtol" ? d.integrator.rtol : d.integrator.step_s);
      overrides.push_back("exchange.contact_refresh_s=" + toml_number(period));
      if (!d.tool) overrides.push_back("exchange.exchange_period_s=" + toml_number(period));
      for (std::string& solver : solver_of(ladder, choice)) overrides.push_back(std::move(solver));
      ComparePoint point = point_of(d, ladder);
      point.setting_name = "contact_refresh_s";
      point.setting = period;
      point.description = with_overrides(d, overrides);
      points.push_back(std::move(point));
    }
  }
  return points;
}

PlannedReference plan_reference(const scene::Description& d, const std::vector<ComparePoint>& points) {
  PlannedReference out;
  if (d.bodies.empty()) {
    double finest = d.tool->tick_s;
    for (const ComparePoint& point : points) finest = std::min(finest, point.setting);
    const auto made = [&](const std::string& integrator) {
      return with_overrides(
          d, {"tool.integrator=\"" + integrator + "\"", "tool.tick_s=" + toml_number(0.5 * finest)});
    };
    out.made_by = fmt::format("simbody-rkmerson at ticks of {:g} s", 0.5 * finest);
    out.checked_by = "simbody-cpodes at the same ticks";
    out.primary = made("simbody-rkmerson");
    out.check = made("simbody-cpodes");
    out.made_with = "simbody-rkmerson";
    out.checked_with = "simbody-cpodes";
    return out;
  }
  const scene::CompareSpec& c = d.compare;
  const auto made = [&](const std::string& integrator, double rtol, const std::string& solver) {
    const StepperEntry& entry = find(loop::steppers(), integrator, "reference integrator");
    if (entry.traits.control == StepControl::kFixed || entry.traits.stability == Stability::kStatic)
      fail("{}: compare: {} cannot be a reference: it has no error control", d.path, integrator);
    scene::LadderSpec ladder;
    ladder.integrator = integrator;
    std::vector<std::string> overrides = overrides_of(ladder, rtol);
    if (!solver.empty()) overrides.push_back("integrator.linear_solver=\"" + solver + "\"");
    return with_overrides(d, overrides);
  };
  out.primary = made(c.reference, c.reference_rtol, "");
  const std::string solver = solver_name(out.primary, c.reference);
  // An implicit check uses another factorisation: LU for Cholesky.
  const std::string other = !uses(find_stepper(c.reference_check), "linear_solver") ? ""
                            : solver == kOtherDirectSolver                          ? "cholmod"
                                                                                    : kOtherDirectSolver;
  out.check = made(c.reference_check, c.reference_check_rtol, other);
  const auto in_words = [](const std::string& integrator, double rtol, const std::string& by) {
    return fmt::format("{} at rtol {:g}{}", integrator, rtol, by.empty() ? "" : " by " + by);
  };
  out.made_by = in_words(c.reference, c.reference_rtol, solver);
  out.checked_by = in_words(c.reference_check, c.reference_check_rtol, other);
  out.made_with = c.reference;
  out.checked_with = c.reference_check;
  if (c.reference != c.reference_check &&
      find_stepper(c.reference)->traits.family == find_stepper(c.reference_check)->traits.family)
    out.checked_by += " (of the same family)";
  return out;
}

}  // namespace palpate::compare
