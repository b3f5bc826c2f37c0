#include "heat_map.h"

#include "palpate/core/error.h"
#include "report/page.h"

namespace palpate::report {

std::string heat_map_html(const std::vector<std::string>& columns, const std::vector<HeatGroup>& groups) {
  std::string html =
      "<div class=\"scroll wide\" tabindex=\"0\" role=\"region\" "
      "aria-label=\"heat map\"><table class=\"heat\">\n<thead><tr><th></th>";
  for (const std::string& column : columns)
    html += "<th class=\"up\"><span>" + escape_html(column) + "</span></th>";
  html += "</tr></thead>\n";
  for (const HeatGroup& group : groups) {
    PALPATE_CHECK(group.rows.size() == group.cells.size(), "{} names for {} rows", group.rows.size(),
                  group.cells.size());
    html +=
        fmt::format("<tbody>\n<tr class=\"group\"><th colspan=\"{}\"><span><b>{}</b> {}</span></th></tr>\n",
                    columns.size() + 1, escape_html(group.name), escape_html(group.summary));
    for (std::size_t r = 0; r < group.rows.size(); ++r) {
      PALPATE_CHECK(group.cells[r].size() == columns.size(), "{} cells under {} columns",
                    group.cells[r].size(), columns.size());
      html += "<tr><th>" + escape_html(group.rows[r]) + "</th>";
      for (const HeatCell& cell : group.cells[r])
        html += cell.css.empty() ? "<td class=\"none\"></td>"
                                 : fmt::format("<td class=\"{}{}\" title=\"{}\">{}</td>", cell.css,
                                               cell.outlined ? " odd" : "", escape_html(cell.title),
                                               escape_html(cell.letter));
      html += "</tr>\n";
    }
    html += "</tbody>\n";
  }
  return html + "</table></div>\n";
}

std::string heat_key_html(const std::vector<HeatCell>& cells) {
  std::string html = "<ul class=\"heatkey\">\n";
  for (const HeatCell& cell : cells)
    html += fmt::format("<li><span class=\"{}{}\">{}</span> {}</li>\n", cell.css, cell.outlined ? " odd" : "",
                        escape_html(cell.letter), escape_html(cell.title));
  return html + "</ul>\n";
}

}  // namespace palpate::report
