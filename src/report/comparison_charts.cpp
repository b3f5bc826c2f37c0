#include <cmath>

#include "comparison_cells.h"
#include "palpate/core/error.h"
#include "sections.h"

/// Charts of a comparison beside its ladders: restarts, exchange periods, methods to find the contact.
namespace palpate::report {

void add_restarts(Page& page, const Table& restarts) {
  page.add_heading("What a restart costs");
  page.add_paragraph(
      "A contact query that changes the set of contacts makes a multistep method forget its history and "
      "begin again with low order and short steps; a one-step method "
      "pays nothing. Here every integrator runs at the scene's own tolerance or step, with more and more "
      "frequent queries.");
  for (const std::string& scene : distinct(restarts, "scene")) {
    const Table own = rows_where(restarts, "scene", scene);
    add_plot(page, restart_plot(own, "steps", "steps per simulated second"),
             scene + ": steps. A line that climbs pays for its restarts; a level one does not.");
    page.begin_details("Force evaluations");
    add_plot(page, restart_plot(own, "force_evaluations", "force evaluations per simulated second"),
             scene + ": force evaluations.");
    page.end_details();
    std::vector<std::vector<std::string>> rows;
    std::vector<RowMark> marks;
    for (std::size_t r = 0; r < own.rows.size(); ++r) {
      const auto rate = [&](const char* column) {
        const double value = own.numbers(column)[r] / own.numbers("simulated_s")[r];
        return std::isfinite(value) ? fmt::format("{:.0f}", value) : std::string("-");
      };
      const bool ok = own.rows[r][own.column("status")] == "ok";
      rows.push_back({own.rows[r][own.column("label")], own.rows[r][own.column("multistep")],
                      cell_text(own, r, "contact_refresh_s"), cell_text(own, r, "reinitialisations"),
                      rate("steps"), rate("force_evaluations"), rate("factorisations"),
                      ok ? "ok" : own.rows[r][own.column("reason")]});
      marks.push_back(ok ? RowMark::kNone : RowMark::kBad);
    }
    page.add_table({"integrator", "multistep", "contact refresh [s]", "restarts", "steps per s",
                    "force evaluations per s", "factorisations per s", "status"},
                   rows, "", marks);
  }
}

void add_exchange(Page& page, const Table& exchange) {
  page.add_heading("Error of the exchange period");
  page.add_paragraph(
      "How often tool and bodies exchange forces belongs to the scene, not to the integrator. This is what "
      "the choice costs by itself: the distance of the partitioned scheme at each period from tool and "
      "bodies stepped as one system, both by the same tight integrator.");
  const std::vector<std::string> scenes =
      exchange.has("scene") ? distinct(exchange, "scene") : std::vector<std::string>{""};
  for (const std::string& scene : scenes) {
    const Table own = rows_where(exchange, "scene", scene);
    const std::string where = scenes.size() > 1 ? scene + ": " : "";
    for (const Quantity& q : quantities_of(own, {}))
      add_plot(page, exchange_plot(own, q.column, q.label),
               where + (where.empty() ? capitalised(q.label) : q.label) + " against the exchange period.");
    std::vector<std::vector<std::string>> rows;
    for (std::size_t r = 0; r < own.rows.size(); ++r) {
      rows.emplace_back();
      for (const std::string& column : exchange_columns()) rows.back().push_back(cell_text(own, r, column));
    }
    page.add_table({"exchange period [s]", "position error, rel. L2", "force error, RMS [N]",
                    "torque error, RMS [N m]", "CPU [s]"},
                   rows);
  }
}

void add_methods(Page& page, const Table& methods) {
  page.add_heading("Ways to find the contact");
  page.add_paragraph(
      "The same touch at the same integrator settings, its contact found in different ways; each against the "
      "first. The difference holds what each makes of the "
      "tool (an exact shape or facets) and of the overlap (one sample a vertex, or one a pixel).");
  const std::vector<std::string> columns = {"scene",
                                            "method",
                                            "position_difference_rel_l2",
                                            "position_difference_max_m",
                                            "force_difference_rms_n",
                                            "force_difference_max_n",
                                            "peak_force_n",
                                            "most_samples",
                                            "query_s",
                                            "cpu_s"};
  std::vector<std::vector<std::string>> rows;
  for (std::size_t r = 0; r < methods.rows.size(); ++r) {
    rows.emplace_back();
    for (const std::string& column : columns) rows.back().push_back(cell_text(methods, r, column));
  }
  page.add_table(
      {"scene", "method", "position difference, rel. L2", "largest [m]", "force difference, RMS [N]",
       "largest [N]", "peak force [N]", "samples at most", "queries [s]", "CPU [s]"},
      rows);
}

}  // namespace palpate::report
