#include <algorithm>
#include <cmath>

#include "comparison_cells.h"
#include "palpate/core/error.h"
#include "sections.h"
#include "work_precision_plots.h"

/// Further charts of a comparison: restarts, exchange periods, methods of contact search.
namespace palpate::report {

namespace {

/// Returns the lower bound of any method, one step per query: steps end at queries.
Series one_step_per_query(const Table& restarts) {
  const std::vector<double> refresh = restarts.numbers("contact_refresh_s");
  Series out{.name = "one step per query", .x = {}, .y = {}, .mark = Mark::kDashed, .colour = "ink"};
  const auto [shortest, longest] = std::minmax_element(refresh.begin(), refresh.end());
  for (const double period : {*longest, *shortest}) out.x.push_back(1.0 / period);
  out.y = out.x;
  return out;
}

}  // namespace

void add_restarts(Page& page, const Table& restarts) {
  page.add_heading("Cost of restarts");
  page.add_paragraph(
      "A contact query that changes the set of contacts makes a multistep method discard its history and "
      "restart with low order and short steps. A one-step method has no history to discard. No step of "
      "either kind extends past a query: where queries are more frequent than steps, each query costs a "
      "step. Here every integrator runs at the tolerance or step of the scene, with increasingly frequent "
      "queries.");
  for (const std::string& scene : distinct(restarts, "scene")) {
    const Table own = rows_where(restarts, "scene", scene);
    Plot steps = restart_plot(own, "steps", "steps per simulated second");
    steps.series.push_back(one_step_per_query(own));
    add_plot(page, steps, "restarts.csv",
             scene +
                 ": steps. No method can stay below the dashed line, one step per query; the steps that a "
                 "multistep method takes in excess of a one-step method are the cost of its restarts.");
    page.begin_details("Force evaluations");
    add_plot(page, restart_plot(own, "force_evaluations", "force evaluations per simulated second"),
             "restarts.csv", scene + ": force evaluations.");
    page.end_details();
    Rows rows;
    std::vector<RowMark> marks;
    for (std::size_t r = 0; r < own.rows.size(); ++r) {
      const auto rate = [&](const char* column) {
        const double value = own.numbers(column)[r] / own.numbers("simulated_s")[r];
        return std::isfinite(value) ? fmt::format("{:.0f}", value) : std::string("-");
      };
      const bool ok = own.cell(r, "status") == "ok";
      rows.push_back({own.cell(r, "label"), own.cell(r, "multistep"), cell_text(own, r, "contact_refresh_s"),
                      cell_text(own, r, "reinitialisations"), rate("steps"), rate("force_evaluations"),
                      rate("factorisations"), ok ? "ok" : own.cell(r, "reason")});
      marks.push_back(ok ? RowMark::kNone : RowMark::kBad);
    }
    page.add_table({"integrator", "multistep", "contact refresh [s]", "restarts", "steps per s",
                    "force evaluations per s", "factorisations per s", "status"},
                   rows, "", marks);
  }
}

void add_exchange(Page& page, const Table& exchange) {
  page.add_heading("Error due to the exchange period");
  page.add_paragraph(
      "The period at which tool and bodies exchange forces is a setting of the scene, not of the integrator. "
      "This is the error that it causes: the partitioned scheme at each period against the monolithic "
      "solution, both by the same integrator at a tight tolerance.");
  const std::vector<std::string> scenes =
      exchange.has("scene") ? distinct(exchange, "scene") : std::vector<std::string>{""};
  for (const std::string& scene : scenes) {
    const Table own = rows_where(exchange, "scene", scene);
    const std::string where = scenes.size() > 1 ? scene + ": " : "";
    for (const Quantity& q : quantities_of(own, {}))
      add_plot(page, exchange_plot(own, q.column, q.label), "exchange.csv",
               where + (where.empty() ? capitalised(q.label) : q.label) + " against the exchange period.");
    page.add_table({"exchange period [s]", "position error, rel. L2", "force error, RMS [N]",
                    "torque error, RMS [N m]", "CPU [s]"},
                   cells_of(own, exchange_columns()));
  }
}

void add_methods(Page& page, const Table& methods) {
  page.add_heading("Contact methods");
  page.add_paragraph(
      "The same scene at the same integrator settings, with different contact methods. Differences are "
      "relative to the first method, which all other errors on this page use: those are errors of the time "
      "integration, these are differences of the contact discretisation, and no integrator removes them. "
      "Each method discretises the same law on the same mesh (an exact tool or facets, samples at vertices "
      "or at points between them), so none of them is exact. All converge to the same solution as elements "
      "become smaller: run the scene with half the element size to estimate the discretisation error of this "
      "mesh.");
  page.add_table(
      {"scene", "method", "position difference, rel. L2", "largest [m]", "force difference, RMS [N]",
       "largest [N]", "peak force [N]", "samples at most", "queries [s]", "CPU [s]"},
      cells_of(methods, {"scene", "method", "position_difference_rel_l2", "position_difference_max_m",
                         "force_difference_rms_n", "force_difference_max_n", "peak_force_n", "most_samples",
                         "query_s", "cpu_s"}));
}

}  // namespace palpate::report
