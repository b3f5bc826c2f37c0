#include "answers.h"

#include <algorithm>
#include <cmath>

#include "core/time_text.h"
#include "palpate/core/error.h"
#include "report/comparison_words.h"
#include "report/cost_envelope.h"

namespace palpate::report {
namespace {

/// Largest magnitude of a vector in force.csv, and its time.
struct Peak {
  double value = 0.0, time_s = 0.0;
};
Peak peak_of(const Table& force, const std::string& prefix, const std::string& unit) {
  Peak peak;
  const auto column = [&](const char* axis) { return fmt::format("{}_{}_{}", prefix, axis, unit); };
  for (const char* axis : {"x", "y", "z"})
    if (!force.has(column(axis))) return peak;
  const std::vector<double> time = force.numbers("time_s"), x = force.numbers(column("x")),
                            y = force.numbers(column("y")), z = force.numbers(column("z"));
  for (std::size_t i = 0; i < time.size(); ++i)
    if (const double value = std::hypot(x[i], y[i], z[i]); value > peak.value) peak = {value, time[i]};
  return peak;
}

std::string of_limit(double limit, const char* unit) {
  return limit > 0.0 ? fmt::format(" (device limit {:g} {})", limit, unit) : "";
}

std::string at_time(double time_s) {
  return std::isfinite(time_s) ? fmt::format(" at {} s", time_text(time_s)) : "";
}

/// Returns the label of the method that is cheapest at every target that any method reaches; empty if there
/// is none.
std::string always_cheapest(const Table& compare, const std::string& column, double scale, double own_error) {
  std::string label;
  for (const Winner& win : winners(compare, column, "cpu_s_median", targets_of(scale), own_error)) {
    if (!win.found) continue;
    if (!win.declared() || !std::isfinite(win.cost.high) || (!label.empty() && label != win.label)) return "";
    label = win.label;
  }
  return label;
}

/// Returns the question of a comparison, or its answer in one sentence if one method is cheapest at all
/// errors.
Answer headline(const Table& compare, const ReferenceError& reference) {
  const std::string positions = always_cheapest(compare, kPosition, 1.0, reference.position_error_rel_l2);
  const bool felt = has_force(compare, reference);
  const std::string force =
      felt ? always_cheapest(compare, kForce, reference.peak_force_n, reference.force_error_rms_n)
           : positions;
  if (positions.empty() || force != positions)
    return {"Which integrator is the cheapest for a target error?", {}, true};
  return {fmt::format("{} is the cheapest at every target error that is reached and resolved{}.", positions,
                      felt ? ", for positions and for the force on the hand" : "")};
}

}  // namespace

Answer remarks_answer(const Json& summary) {
  Answer out;
  if (!summary.is_object() || !summary.contains("remarks") || !summary["remarks"].is_array()) return out;
  for (const Json& remark : summary["remarks"])
    if (remark.is_string()) out.points.push_back(remark.get<std::string>());
  return out;
}

Answer run_answer(const Json& summary, const std::optional<Table>& force) {
  Answer out;
  const Json options = section_of(summary, "options"), sizes = section_of(summary, "sizes"),
             timings = section_of(summary, "timings"), counts = section_of(summary, "counts");
  const double simulated = number_at(timings, "simulated_s"), cpu = number_at(timings, "loop_cpu_s"),
               steps = number_at(counts, "steps"), nodes = number_at(sizes, "nodes");
  const std::string outcome = text_at(summary, "outcome"), by = text_at(options, "integrator");
  if (!outcome.empty())
    out.lead = fmt::format("The run {}", outcome == "finished" ? outcome : "was " + outcome);
  if (outcome == "failed") out.lead = "The run failed";
  if (!out.lead.empty() && std::isfinite(simulated) && std::isfinite(cpu))
    out.lead += fmt::format(": {} s simulated in {} s of CPU time{}{}", time_text(simulated),
                            short_number(cpu), by.empty() ? "" : " by " + by,
                            std::isfinite(steps) ? fmt::format(" in {:.0f} steps", steps) : "");
  if (!out.lead.empty() && nodes > 0.0) out.lead += fmt::format(", with {:.0f} nodes", nodes);
  if (!out.lead.empty()) out.lead += ".";
  if (const std::string message = text_at(summary, "message"); !message.empty())
    out.points.push_back(message);
  const Json hands = list_of(summary, "hands"), hand = hands.empty() ? Json::object() : hands[0];
  Peak f, t;
  if (force && !force->rows.empty()) {
    f = peak_of(*force, "force", "n");
    t = peak_of(*force, "torque", "n_m");
  } else if (hand.is_object() && hand.contains("peak_force_n")) {
    f = {number_at(hand, "peak_force_n"), number_at(hand, "peak_force_at_s")};
    t = {number_at(hand, "peak_torque_n_m"), number_at(hand, "peak_torque_at_s")};
  } else {
    return out;
  }
  if (f.value > kLeastPeak)
    out.points.push_back(fmt::format("The peak force on the hand is {} N{}{}.", short_number(f.value),
                                     at_time(f.time_s), of_limit(number_at(hand, "max_force_n"), "N")));
  else
    out.points.push_back("The force on the hand is zero.");
  if (t.value > kLeastPeak)
    out.points.push_back(fmt::format("The peak torque on the hand is {} N m{}{}.", short_number(t.value),
                                     at_time(t.time_s), of_limit(number_at(hand, "max_torque_n_m"), "N m")));
  return out;
}

double time_of_peak_force(const Table& force) {
  const Peak peak = peak_of(force, "force", "n");
  return peak.value > kLeastPeak ? peak.time_s : kUnknown;
}

std::vector<Answer> comparison_answers(const Table& compare,
                                       const std::map<std::string, ReferenceError>& references) {
  std::vector<Answer> out;
  const std::vector<std::string> scenes = distinct(compare, "scene");
  for (const std::string& scene : scenes) {
    const auto found = references.find(scene);
    const ReferenceError reference = found == references.end() ? ReferenceError{} : found->second;
    const Table own = rows_where(compare, "scene", scene);
    out.push_back(headline(own, reference));
    if (scenes.size() > 1) out.back().lead = scene + ": " + out.back().lead;
    for (Answer& answer : cheapest_in_words(own, reference)) out.push_back(std::move(answer));
  }
  return out;
}

Answer haptic_answer(const Table& haptic, const Json& summary) {
  Answer out;
  const Json errors_of_hands = list_of(summary, "against_monolithic"),
             own = errors_of_hands.empty() ? Json::object() : errors_of_hands[0];
  const double force = number_at(own, "force_error_rms_of_peak"),
               torque = number_at(own, "torque_error_rms_of_peak");
  if (!std::isfinite(force)) return out;
  out.lead = fmt::format(
      "At the settings of the scene, the RMS error of the force on the hand against the monolithic solution "
      "is {} % of the peak{}.",
      short_number(100.0 * force),
      std::isfinite(torque) && torque > 0.0 ? fmt::format(" (torque: {} %)", short_number(100.0 * torque))
                                            : "");
  const std::vector<double> errors = haptic.numbers("force_error_rms_of_peak"),
                            costs = haptic.numbers("cpu_s_median");
  std::size_t best = errors.size();
  for (std::size_t i = 0; i < errors.size(); ++i)
    if (haptic.cell(i, "variable") != "exchange alone" && std::isfinite(errors[i]) &&
        (best == errors.size() || errors[i] < errors[best]))
      best = i;
  if (best < errors.size() && errors[best] < force)
    out.points.push_back(fmt::format("The most accurate variant is {} = {}: error {} %, {} s of CPU time.",
                                     haptic.cell(best, "variable"), haptic.cell(best, "value"),
                                     short_number(100.0 * errors[best]), short_number(costs[best])));
  return out;
}

}  // namespace palpate::report
