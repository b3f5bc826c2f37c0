#include <algorithm>
#include <cmath>

#include "log_line.h"
#include "palpate/core/error.h"
#include "sections.h"

/// Section for the error due to the mesh: mesh.csv of `palpate compare --mesh`.
namespace palpate::report {
namespace {

/// Figures of mesh.csv: forces, or displacements without a tool.
struct Figures {
  std::string unit, peak, last;  ///< "N"; names of columns
  std::string last_name;         ///< "hold"
};

Figures mesh_figures(const Table& table) {
  if (table.has("peak_n")) return {"N", "peak_n", "hold_n", "hold"};
  return {"m", "peak_m", "end_m", "end"};
}

/// Returns the errors of the peak on all levels of one resolution, in percent of its value on the scene's.
Series mesh_errors(const Table& own, const Figures& f, const std::string& name, const std::string& x_column) {
  Series out{.name = name, .x = own.numbers(x_column), .y = own.numbers("error_" + f.peak)};
  out.mark = Mark::kLinePoints;
  const std::vector<double> peak = own.numbers(f.peak), divisions = own.numbers("divisions");
  double scene = kUnknown;
  for (std::size_t i = 0; i < peak.size(); ++i)
    if (divisions[i] == 0.0) scene = peak[i];
  for (double& y : out.y) y *= 100.0 / scene;
  return out;
}

void add_charts(Page& page, const Table& table, const Figures& f) {
  Plot size = log_log_plot("size of elements, triangles or point spacing, relative to the scene's",
                           "estimated error of the peak force [%]");
  Plot cost = log_log_plot("CPU time of the loop [s]", size.y_label);
  if (f.unit == "m") size.y_label = cost.y_label = "estimated error of the peak displacement [%]";
  for (const std::string& name : distinct(table, "resolution")) {
    const Table own = rows_where(table, "resolution", name);
    if (own.rows.size() < 2 || !own.exceeds("error_" + f.peak, 0.0)) continue;
    size.series.push_back(mesh_errors(own, f, name, "size"));
    cost.series.push_back(mesh_errors(own, f, name, "cpu_s"));
  }
  if (size.series.empty()) return;
  add_plot(page, size, "mesh.csv",
           "Estimated error of the peak against the size of the mesh: the difference from the value for "
           "elements of size zero, which is extrapolated from the levels.");
  add_plot(page, cost, "mesh.csv", "Estimated error of the peak against CPU time; lower left is better.");
}

std::string mesh_percent(double share) { return std::isfinite(share) ? short_number(100.0 * share) : "-"; }

void add_errors(Page& page, const Json& errors, const Figures& f) {
  const std::string key = f.unit == "N" ? "_n" : "_m";
  Rows rows;
  std::vector<RowMark> marks;
  for (const Json& one : errors) {
    const double time_share = number_at(one, "time_error_of_difference");
    const bool resolved = time_share <= 0.1;
    rows.push_back({text_at(one, "resolution"), text_at(one, "figure"),
                    short_number(number_at(one, ("value" + key).c_str()), 4),
                    short_number(number_at(one, ("estimate" + key).c_str()), 4),
                    mesh_percent(number_at(one, "uncertainty_of_value")),
                    mesh_percent(number_at(one, "error_of_value")), short_number(number_at(one, "order")),
                    short_number(time_share),
                    text_at(one, "convergence") + (resolved ? "" : "; steps too long")});
    marks.push_back(resolved ? RowMark::kNone : RowMark::kFaint);
  }
  if (rows.empty()) return;
  page.add_table(
      {"resolution", "figure", fmt::format("the scene's [{}]", f.unit), fmt::format("estimate [{}]", f.unit),
       "± [%]", "error of the scene [%]", "order", "time error / difference", ""},
      rows,
      "The estimate is the value for elements of size zero; ± is its grid convergence index (Roache "
      "1994). The time error must be below a tenth of the difference between levels.",
      marks);
}

void add_levels(Page& page, const Table& table, const Figures& f) {
  Rows rows;
  std::vector<RowMark> marks;
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    const auto text = [&](const char* column) { return short_cell(table.cell(r, column)); };
    const double divisions = to_number(table.cell(r, "divisions"));
    const bool ok = table.cell(r, "status") == "ok";
    rows.push_back({table.cell(r, "resolution"),
                    divisions == 0.0  ? "the scene's"
                    : divisions > 0.0 ? fmt::format("1/{:g}", std::exp2(divisions))
                                      : fmt::format("{:g}", std::exp2(-divisions)),
                    text("elements"), text("surface_vertices"), text("most_samples"), text(f.peak.c_str()),
                    text(f.last.c_str()), text(f.unit == "N" ? "rms_n" : "rms_m"), text("cpu_s"),
                    ok ? "ok" : table.cell(r, "reason")});
    marks.push_back(ok ? RowMark::kNone : RowMark::kBad);
  }
  page.add_table({"resolution", "size", "elements", "surface vertices", "contact samples",
                  fmt::format("peak [{}]", f.unit), fmt::format("{} [{}]", f.last_name, f.unit),
                  fmt::format("RMS [{}]", f.unit), "CPU [s]", "status"},
                 rows, "Each level divides elements, triangles of the skin, or the spacing of points by two.",
                 marks);
}

}  // namespace

void add_mesh(Page& page, const Table& table, const Json& summary) {
  if (table.rows.empty()) return;
  const Figures figures = mesh_figures(table);
  const Json about = section_of(summary, "mesh");
  page.add_heading("Error due to the mesh");
  add_errors(page, list_of(summary, "mesh_errors"), figures);
  add_charts(page, table, figures);
  add_levels(page, table, figures);
  for (const char* key : {"made_by", "rules"})
    if (const std::string text = text_at(about, key); !text.empty())
      page.add_paragraph(key == std::string_view("made_by") ? "All levels by " + text + "." : text);
}

}  // namespace palpate::report
