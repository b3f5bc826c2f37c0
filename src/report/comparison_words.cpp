#include "report/comparison_words.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "palpate/core/error.h"
#include "report/cost_envelope.h"

namespace palpate::report {
namespace {

std::string list_of(const std::vector<std::string>& names) {
  if (names.size() < 2) return names.empty() ? "" : names[0];
  return fmt::format("{} and {}", fmt::join(names.begin(), names.end() - 1, ", "), names.back());
}

std::string factor(double ratio) {
  return !std::isfinite(ratio) ? short_number(ratio)
         : ratio < 1.995       ? fmt::format("{:.2f}", ratio)
         : ratio < 9.95        ? fmt::format("{:.2g}", ratio)
                               : fmt::format("{:.0f}", ratio);
}

/// Returns a ratio in words, as "12 (11 to 14) times".
std::string times(const CostRatio& ratio) {
  if (ratio.low == ratio.high || !std::isfinite(ratio.low)) return factor(ratio.value) + " times";
  return fmt::format("{} ({} to {}) times", factor(ratio.value), factor(ratio.low),
                     std::isfinite(ratio.high) ? factor(ratio.high) : "?");
}

std::string winner_in_words(const Winner& win, const std::string& target) {
  if (std::isnan(win.cost.high))
    return fmt::format(
        "For {}, {} is the cheapest ({} s), but no run was repeated: a winner is not declared.", target,
        win.label, short_number(win.cost.value));
  if (!win.declared()) {
    std::vector<std::string> alike = {win.label};
    for (const std::string& rival : win.rivals)
      if (alike.size() < 4) alike.push_back(rival);
    const std::size_t more = win.rivals.size() + 1 - alike.size();
    if (more > 0) alike.push_back(fmt::format("{} more", more));
    return fmt::format(
        "For {} there is no winner: {} cost the same within their spread ({} s for the first).", target,
        list_of(alike), short_number(win.cost.value));
  }
  std::string out = fmt::format("For {}, {} is the cheapest ({}{} s)", target, win.label,
                                win.cost.at_most ? "at most " : "", short_number(win.cost.value));
  if (!win.runner_up.empty())
    out += fmt::format("; the next, {}, takes {} as long", win.runner_up, times(win.runner_up_ratio));
  if (win.label != kBaseline && win.runner_up != kBaseline && std::isfinite(win.baseline_ratio.value))
    out += fmt::format(", {} {}", kBaseline, times(win.baseline_ratio));
  return out + ".";
}

/// Returns sentences on the cheapest method at each target.
/// @param what   name of the quantity
/// @param scale  size that the relative targets refer to
std::vector<std::string> winners_in_words(const Table& compare, const std::string& column,
                                          const std::string& what, double scale, double reference_error) {
  std::vector<std::string> out;
  std::vector<std::string> unreached, unresolved;
  const std::vector<Winner> all =
      winners(compare, column, "cpu_s_median", targets_of(scale), reference_error);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::string target = fmt::format("{:g}", kTargets[i]);
    if (!all[i].resolved)
      unresolved.push_back(target);
    else if (!all[i].found)
      unreached.push_back(target);
    else
      out.push_back(winner_in_words(all[i], what + target));
  }
  if (!unreached.empty()) out.push_back(fmt::format("No point reaches {}.", list_of(unreached)));
  if (!unresolved.empty() && std::isfinite(reference_error))
    out.push_back(fmt::format("The reference does not resolve {}.", list_of(unresolved)));
  return out;
}

std::string baseline_in_words(const std::vector<Ladder>& all) {
  for (const Ladder& ladder : all) {
    if (ladder.integrator != kBaseline || ladder.points.empty()) continue;
    const auto best = std::min_element(
        ladder.points.begin(), ladder.points.end(), [](const LadderPoint& a, const LadderPoint& b) {
          return a.unresolved == b.unresolved ? a.error < b.error : b.unresolved;
        });
    if (best->unresolved) continue;
    return fmt::format("The best of {} is {} in {} s. ", ladder.label, short_number(best->error),
                       short_number(best->cost));
  }
  return "";
}

std::string families_in_words(const std::vector<Ladder>& all, double target, double reference_error) {
  std::vector<std::string> families;
  for (const Ladder& ladder : all)
    if (!std::isnan(cost_at(ladder, target, reference_error).value) &&
        std::find(families.begin(), families.end(), ladder.family) == families.end())
      families.push_back(ladder.family);
  if (families.empty()) return "";
  return fmt::format("{:g} is reached by {} {}: {}. ", target, families.size(),
                     families.size() == 1 ? "family" : "families", list_of(families));
}

/// Returns the kind of failure, which many methods may share: "Newton did not converge" for the reason
/// "Newton did not converge: ark-mri-2: ...".
std::string kind_of(const std::pair<std::string, std::string>& failure) {
  if (failure.first == "out of time" || failure.first == "not tried") return "out of time";
  if (failure.second.empty()) return failure.first;
  const std::string start =
      failure.second.substr(0, std::min(failure.second.find_first_of("\n(:"), std::size_t{90}));
  return start.substr(0, start.find_last_not_of(" ,;:") + 1);
}

std::string failures_in_words(const std::vector<Ladder>& all) {
  std::map<std::string, std::vector<std::string>> nothing, some;
  for (const Ladder& ladder : all) {
    if (ladder.failures.empty()) continue;
    auto& group = ladder.points.empty() ? nothing : some;
    group[kind_of(ladder.failures[0])].push_back(ladder.label);
  }
  std::string out;
  for (const auto& [why, labels] : nothing) out += fmt::format("No point of {}: {}. ", list_of(labels), why);
  for (const auto& [why, labels] : some)
    out += fmt::format("Some levels of {} failed: {}. ", list_of(labels), why);
  return out;
}

/// Returns sentences on explicit methods that stability, not accuracy, limits: a tolerance ten times tighter
/// costs hardly more force evaluations, or a longer fixed step fails or diverges.
std::string explicit_in_words(const Table& compare) {
  std::vector<std::string> by_tolerance, by_step;
  for (const Ladder& ladder : ladders(compare, kPosition, "force_evaluations")) {
    if (ladder.stability.find("explicit") == std::string::npos) continue;
    double longest = kUnknown;
    bool unstable = ladder.setting_name != "rtol" && !ladder.failures.empty(), flat = false;
    for (std::size_t i = 0; i < ladder.points.size(); ++i) {
      const LadderPoint& p = ladder.points[i];
      if (ladder.setting_name == "rtol")
        flat |= i > 0 && p.setting <= 0.11 * ladder.points[i - 1].setting &&
                p.cost < 1.25 * ladder.points[i - 1].cost;
      else if (p.error > 1.0)
        unstable = true;
      else if (!(p.setting <= longest))
        longest = p.setting;
    }
    if (flat) by_tolerance.push_back(ladder.label);
    if (unstable && std::isfinite(longest))
      by_step.push_back(fmt::format("{} (usable at {} and finer)", ladder.label,
                                    setting_text(ladder.setting_name, longest)));
  }
  std::string out;
  if (!by_tolerance.empty())
    out += fmt::format("Explicit and limited by stability, so that a looser tolerance saves nothing: {}. ",
                       list_of(by_tolerance));
  if (!by_step.empty()) out += fmt::format("Explicit and unstable at longer steps: {}. ", list_of(by_step));
  return out;
}

std::string reference_in_words(const std::vector<Ladder>& all, double reference_error) {
  double best = kUnknown;
  int unresolved = 0;
  for (const Ladder& ladder : all)
    for (const LadderPoint& p : ladder.points) {
      unresolved += p.unresolved;
      if (!p.unresolved && !(p.error >= best)) best = p.error;
    }
  if (std::isnan(best)) return "No point has an error that can be distinguished from the reference's.";
  if (std::isnan(reference_error))
    return "The reference error is not known: no winner is declared, and small errors may be errors of the "
           "reference.";
  if (best < kResolved * reference_error)
    return fmt::format(
        "The reference error is {}: errors below {} are not resolved by it (the best point has {}).",
        short_number(reference_error), short_number(kResolved * reference_error), short_number(best));
  std::string out = fmt::format(
      "The reference error is {}, {} below the best point that it resolves ({}): all figures{} are resolved "
      "by the reference.",
      short_number(reference_error),
      reference_error > 0.0 ? factor(best / reference_error) + " times" : "to rounding", short_number(best),
      unresolved ? " except those marked" : "");
  if (unresolved)
    out += fmt::format(" {} within {:g} times that error, {}: errors below {} are not resolved.",
                       unresolved == 1 ? "1 point is" : fmt::format("{} points are", unresolved), kResolved,
                       unresolved == 1 ? "is marked and not counted" : "are marked and not counted",
                       short_number(kResolved * reference_error));
  return out;
}

}  // namespace

bool has_force(const Table& compare, const ReferenceError& reference) {
  return compare.has(kForce) && reference.peak_force_n > kLeastPeak &&
         std::isfinite(reference.force_error_rms_n);
}

std::vector<Answer> cheapest_in_words(const Table& compare, const ReferenceError& reference) {
  const double reference_error = reference.position_error_rel_l2;
  const std::vector<Ladder> all = ladders(compare, kPosition, "cpu_s_median");
  Answer positions{"Position error relative to the deformation.",
                   winners_in_words(compare, kPosition, "an error of ", 1.0, reference_error), true};
  std::string reach = baseline_in_words(all) + families_in_words(all, kTargets.back(), reference_error);
  reach.erase(reach.find_last_not_of(' ') + 1);
  if (!reach.empty()) positions.points.push_back(std::move(reach));
  std::vector<Answer> out;
  if (!positions.points.empty()) out.push_back(std::move(positions));
  if (!has_force(compare, reference)) return out;
  Answer force{fmt::format("Error of the force on the hand relative to the peak of {} N.",
                           short_number(reference.peak_force_n)),
               winners_in_words(compare, kForce, "", reference.peak_force_n, reference.force_error_rms_n),
               true};
  if (!force.points.empty()) out.push_back(std::move(force));
  return out;
}

std::vector<std::string> remarks_in_words(const Table& compare, const ReferenceError& reference) {
  const std::vector<Ladder> all = ladders(compare, kPosition, "cpu_s_median");
  std::vector<std::string> out;
  for (std::string remark : {explicit_in_words(compare) + failures_in_words(all),
                             reference_in_words(all, reference.position_error_rel_l2)}) {
    remark.erase(remark.find_last_not_of(' ') + 1);
    if (!remark.empty()) out.push_back(std::move(remark));
  }
  return out;
}

std::string in_words(const Table& compare, const ReferenceError& reference) {
  std::string out;
  const auto add = [&](const std::string& paragraph) { out += (out.empty() ? "" : "\n") + paragraph; };
  for (const Answer& answer : cheapest_in_words(compare, reference))
    add(fmt::format("{} {}", answer.lead, fmt::join(answer.points, " ")));
  for (const std::string& remark : remarks_in_words(compare, reference)) add(remark);
  return out;
}

}  // namespace palpate::report
