#include <algorithm>
#include <cmath>

#include "comparison_tables.h"
#include "palpate/core/error.h"
#include "report/comparison_words.h"
#include "sections.h"
#include "work_precision_plots.h"

namespace palpate::report {
namespace {

constexpr const char* kCosts[][2] = {{"force_evaluations", "force evaluations"},
                                     {"factorisations", "factorisations"}};

void add_work_precision(Page& page, const Table& compare, const Quantity& q) {
  const bool many = ladders(compare, q.column, "cpu_s_median").size() > 3;
  std::string left_out;
  if (const int count = points_not_drawn(compare, q.column, q.scale); count > 0)
    left_out = fmt::format(
        " Not drawn: {} point{} with an error above {:g}{}.", count, count == 1 ? "" : "s", kLargestDrawn,
        q.unit.empty() ? "" : fmt::format(" times the peak of {} {}", short_number(q.scale), q.unit));
  add_plot(page, work_precision_plot(compare, q.column, q.label, q.reference, q.scale), "compare.csv",
           capitalised(q.label) + " against CPU time; lower left is better. " +
               (many ? "One line per refinement sequence, coloured by family; the dark line is the Pareto "
                       "front, labelled where the best integrator changes. "
                     : "Each point is labelled with its relative tolerance or step. ") +
               "Rings mark points within 10 times the reference error" +
               (std::isfinite(q.reference) ? fmt::format(" of {}.", short_number(q.reference)) : ".") +
               left_out);
}

/// Adds the charts of error against counts of work, each quantity folded away separately.
void add_counts_of_work(Page& page, const Table& compare, const Quantity& q) {
  std::vector<std::pair<std::string, std::string>> counted;
  for (const auto& [column, label] : kCosts)
    if (compare.exceeds(column, 0.0)) counted.emplace_back(column, label);
  const bool families = q.column == kPosition && ladders(compare, q.column, "cpu_s_median").size() > 3;
  if (counted.empty() && !families) return;
  const std::string name = q.label.substr(0, q.label.find(','));
  std::string against;
  for (const auto& [column, label] : counted) against += (against.empty() ? "" : " and ") + label;
  page.begin_details(capitalised(name) + (families ? " family by family" : "") +
                     (families && !against.empty() ? ", and" : "") +
                     (against.empty() ? "" : " against " + against));
  if (families) {
    page.begin_multiples();
    for (const Plot& plot : family_plots(compare, q.column, q.label, q.reference, q.scale))
      add_plot(page, plot, "compare.csv", "");
    page.end_multiples();
  }
  for (const auto& [column, label] : counted)
    add_plot(page, work_precision_plot(compare, q.column, q.label, q.reference, q.scale, column, label),
             "compare.csv",
             fmt::format("{} against {}, independent of timing noise.{}", capitalised(q.label), label,
                         column == "factorisations" ? " Methods that factor no matrix are not shown." : ""));
  page.end_details();
}

void add_reference(Page& page, const ReferenceError& reference) {
  if (!reference.description.empty())
    page.add_paragraph("Reference: " + reference.description +
                       (std::isfinite(reference.position_error_rel_l2)
                            ? fmt::format("; the two differ by {}, which is taken as the reference error.",
                                          short_number(reference.position_error_rel_l2))
                            : "."));
  if (!reference.trouble.empty()) page.add_paragraph("Note: " + reference.trouble + ".");
}

void add_winners(Page& page, const Table& compare, const std::vector<Quantity>& quantities,
                 const std::string& cost_column, const std::string& cost_label) {
  bool explained = true;
  for (const Quantity& q : quantities)
    if (std::isfinite(q.scale) && q.column != "torque_error_rms_n_m") {
      add_winners_table(page, compare, q, q.scale, cost_column, cost_label, explained);
      explained = false;
    }
}

void add_points(Page& page, const Table& compare) {
  page.begin_details(fmt::format("{} points, with their counts and largest errors", compare.rows.size()));
  add_points_table(page, compare);
  add_counts_and_maxima(page, compare);
  page.end_details();
}

/// Adds all results of one scene: the cheapest methods, their charts, then the supporting tables.
void add_scene_comparison(Page& page, const Table& compare, const ReferenceError& reference) {
  const std::vector<Quantity> quantities = quantities_of(compare, reference);
  const bool judged = std::isfinite(reference.position_error_rel_l2);
  if (judged) {
    page.add_heading("Cheapest integrator for a target error", 3);
    add_winners(page, compare, quantities, "cpu_s_median", "CPU [s]");
  }
  page.add_heading("Error against run time", 3);
  for (const Quantity& q : quantities) add_work_precision(page, compare, q);
  if (const std::vector<double> torque = compare.has("torque_error_max_n_m")
                                             ? compare.numbers("torque_error_max_n_m")
                                             : std::vector<double>{};
      !torque.empty() && *std::max_element(torque.begin(), torque.end()) <= kRounding)
    page.add_paragraph("No torque: the scene produces none, and the largest error is rounding.");
  if (quantities.empty()) page.add_paragraph("No point of the comparison has a measured error.");
  for (const Quantity& q : quantities) add_counts_of_work(page, compare, q);
  page.add_heading("Reliability of these figures", 3);
  for (const std::string& remark : remarks_in_words(compare, reference)) page.add_paragraph(remark);
  add_reference(page, reference);
  for (const std::string& note : reference.notes) page.add_paragraph("Note: " + note + ".");
  if (judged) {
    page.add_heading("Cost of a target error", 3);
    add_costs_table(page, compare, reference.position_error_rel_l2);
    page.begin_details("Cheapest by force evaluations");
    add_winners(page, compare, quantities, "force_evaluations", "force evaluations");
    page.end_details();
  }
  if (!quantities.empty()) add_orders_table(page, compare, quantities);
  page.add_heading("All points", 3);
  add_points(page, compare);
}

}  // namespace

void add_comparison(Page& page, const Table& compare, const std::map<std::string, ReferenceError>& references,
                    const std::string& rules) {
  const std::vector<std::string> scenes = distinct(compare, "scene");
  for (const std::string& scene : scenes) {
    if (scenes.size() > 1) page.add_heading("Scene: " + scene);
    const auto reference = references.find(scene);
    add_scene_comparison(page, rows_where(compare, "scene", scene),
                         reference == references.end() ? ReferenceError{} : reference->second);
  }
  if (!rules.empty()) page.add_paragraph(rules);
}

}  // namespace palpate::report
